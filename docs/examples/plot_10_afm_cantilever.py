"""
A probe on a cantilever: snap-in and pull-off
=============================================

A colloidal probe on a soft cantilever jumps into contact with a gel, is pressed to 10 nN and pulled off. Which of the
recorded numbers depend on the stiffness of the cantilever, and which do not?
"""

import numpy as np
import pandas as pd
from matplotlib import pyplot as plt

import roughmdr as rm

# %%
# One asperity is the probe. ``preload`` presses it to 10 nN through the spring ``machine_stiffness`` and, with
# ``unload``, pulls it off again. The sweep repeats that for three cantilevers. The file
# ``pipelines/scenes/afm_tip_on_gel.toml`` is such a scene on a softer gel.

SCENE = {
    "title": "Probe on a gel",
    "material": {"modulus": "100 kPa", "poisson": 0.49},
    "adhesion": {"model": "jkr", "work": "1 mJ/m^2"},
    "asperities": {
        "source": "random",
        "shape": "paraboloid",
        "count": 1,
        "patch": "100 um",
        "height": 0,
        "radius": "5 um",
    },
    "path": {"preload": "10 nN", "machine_stiffness": "0.05 N/m", "steps": 400, "unload": True},
    "output": {"variables": ["force", "dissipated_energy", "machine_dissipated_energy"]},
    "sweep": {"path.machine_stiffness": ["0.02 N/m", "0.05 N/m", "0.5 N/m"]},
}
result = rm.run(SCENE).isel(realization=0)

# %%
# ``remote`` is the position of the base of the cantilever, counted as a separation. An instrument records the force
# over it. The separation of the probe differs: the spring bears ``machine_stiffness * (separation - remote)``.

figure, (left, right) = plt.subplots(1, 2, figsize=(8, 4), sharey=True, layout="constrained")
for colour, stiffness in zip(("C0", "C1", "C2"), result.path_machine_stiffness.values, strict=True):
    curve = result.sel(path_machine_stiffness=stiffness)
    for branch, style in (("loading", "--"), ("unloading", "-")):
        leg = curve.where(curve.branch == branch, drop=True)
        label = f"{stiffness:g} N/m" if branch == "unloading" else None
        left.plot(1e6 * leg.remote, 1e9 * leg.force, style, color=colour, label=label)
        right.plot(1e6 * leg.separation, 1e9 * leg.force, style, color=colour)
left.set(xlabel="base of the cantilever, remote [um]", ylabel="force [nN]")
right.set(xlabel="separation [um]")
text = left.legend(title="loading dashed")

# %%
# An independent solution needs the JKR equations alone. A contact of radius :math:`a` has
#
# .. math::
#
#    F = \frac{4 E^* a^3}{3 R} - \sqrt{8 \pi w E^* a^3}, \qquad
#    \delta = \frac{a^2}{R} - \sqrt{\frac{2 \pi a w}{E^*}},
#
# and the base stands at :math:`\delta + F/k_m` past first touch. The probe detaches where that is least. It snaps in
# where the base reaches 0: the probe touches, and jumps to the equilibrium on the spring.

modulus, work, radius = rm.effective_modulus(100e3, 0.49), 1e-3, 5e-6
a = np.linspace(1e-9, 1.5e-6, 1_000_000)
force = 4 * modulus * a**3 / (3 * radius) - np.sqrt(8 * np.pi * work * modulus * a**3)
indentation = a**2 / radius - np.sqrt(2 * np.pi * a * work / modulus)
tip = rm.Paraboloid(radius=radius)
rows = {}
for stiffness in result.path_machine_stiffness.values:
    base = indentation + force / stiffness
    fold = base.argmin()
    given = {"effective_modulus": modulus, "work": work, "machine_stiffness": stiffness}
    off = rm.pull_off(tip, control="remote", **given)
    snap = rm.indent(tip, remote=0.0, approach=True, **given)
    curve = result.sel(path_machine_stiffness=stiffness)
    rows[f"{stiffness:g} N/m"] = {
        "snap-in [nN]": 1e9 * float(snap.force),
        "JKR snap-in [nN]": 1e9 * np.interp(0.0, base[fold:], force[fold:]),
        "detachment [nN]": 1e9 * float(off.force),
        "JKR detachment [nN]": 1e9 * force[fold],
        "pull-off force [nN]": 1e9 * float(curve.pull_off_force),
        "lost in the cycle [fJ]": 1e15 * float(curve.dissipated_energy[-1]),
        "of that in the cantilever [fJ]": 1e15 * float(curve.machine_dissipated_energy[-1]),
    }
pd.DataFrame(rows).round(4)

# %%
# - The independent solution agrees in all digits shown.
# - The pull-off force, the largest tension, is :math:`-3/2\,\pi w R` for every cantilever. You can find the work of
#   adhesion from it without knowing the stiffness.
# - The force at the jumps does depend on it. A soft cantilever loses the contact at nearly the largest tension, a stiff
#   one holds it further, down to 5/9 of that for rigid grips.
# - So does the energy lost in a cycle: a soft cantilever loses more, and most of it in itself. Do not take the area of
#   the loop for a property of the gel.

f"-3/2 pi w R = {-1.5e9 * np.pi * work * radius:.4f} nN"

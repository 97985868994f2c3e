r"""
Fuller and Tabor: how roughness destroys adhesion
=================================================

How much of the adhesion of a smooth surface is left when its summits differ in height? This page computes the pull-off
force of rough patches at one work of adhesion and compares it with the theory of Fuller and Tabor.
"""

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
from scipy.optimize import minimize_scalar

import roughmdr as rm

R, E, w, density = 100e-6, 4e6, 0.05, 1e8
scene = {
    "title": "Pull-off over roughness",
    "seed": 2026,
    "material": {"effective_modulus": E},
    "adhesion": {"model": "jkr", "work": w},
    "asperities": {
        "source": "random",
        "shape": "paraboloid",
        "count": 900,
        "patch": "3 mm",
        "radius": R,
        "height": {"distribution": "normal"},
    },
    "path": {"separation": {"stop": "0 sigma", "steps": 40}, "unload": True},
    "output": {"variables": ["force"]},
    "batch": {"realizations": 12},
    "sweep": {"asperities.height.std": {"linspace": ["0.05 um", "1.2 um"], "num": 9}},
}
patches = rm.run(scene)
expected = rm.run(scene, set={"batch.estimator": "expected", "batch.realizations": 1})
figure = rm.plot(patches, kind="sweep")

# %%
# The theory
# ----------
# Fuller and Tabor load equal summits with normal heights down to a separation, here the mean height of the summits. On
# the way back each contact holds until it is stretched by :math:`|\delta_c|`, where a JKR contact detaches under fixed
# grips. High summits still push when low ones pull, so the tension is less than the sum of what each contact can bear,
# :math:`N \cdot \tfrac{3}{2} \pi w R`. The result depends on :math:`\sigma / |\delta_c|` alone. Only the summits above
# their mean height come into contact, so a nearly smooth surface keeps one half. A preload that brings all of them into
# contact has its turning point far below, at :math:`-6\sigma`, and the nearly smooth surface then keeps all.
#
# ``rm.theory.fuller_tabor`` gives the pressure at given separations. Its largest tension is found by a minimiser.

stretch = -float(rm.pull_off(rm.Paraboloid(radius=R), effective_modulus=E, work=w, control="displacement").indentation)
summits = {"radius": R, "density": density, "work": w, "effective_modulus": E}
full = 1.5 * np.pi * w * R * density  # [Pa], if all summits bore their largest tension together


def largest_tension(sigma: float) -> float:
    """Find the pull-off pressure [Pa] after loading to the mean height of the summits."""
    search = {"bounds": (0, 4 * sigma + 2 * stretch), "method": "bounded", "options": {"xatol": 1e-6 * stretch}}
    return -minimize_scalar(
        lambda h: float(rm.theory.fuller_tabor(separation=h, turning=0.0, std=sigma, **summits)), **search
    ).fun


sigma = np.linspace(0.05e-6, 1.2e-6, 60)
theory = [largest_tension(value) / full for value in sigma]

# %%
# Compare
# -------
# Each point is the mean over 12 patches with its standard error. The expected law belongs to infinitely many
# asperities, as the theory does.

share = -patches.pull_off_force / (full * patches.nominal_area)
mean, sem = share.mean("realization"), share.std("realization", ddof=1) / np.sqrt(share.sizes["realization"])
swept = patches.asperities_height_std.values
law = (-expected.pull_off_force / (full * expected.nominal_area)).isel(realization=0)

comparison, axes = plt.subplots(figsize=(7, 4), layout="constrained")
axes.semilogy(sigma / stretch, theory, "k-", lw=1, label="Fuller and Tabor")
axes.semilogy(swept / stretch, law, "s", mfc="none", ms=9, label="expected law")
axes.errorbar(swept / stretch, mean, 2 * sem, fmt="o", ms=4, label="12 patches, ± 2 standard errors")
axes.set(xlabel="roughness σ / |δc|", ylabel="pull-off force / (N · 3/2 π w R)")
axes.set_yticks([0.03, 0.1, 0.3, 0.5], ["0.03", "0.1", "0.3", "0.5"])
axes.minorticks_off()
_ = axes.legend()

# %%
at_swept = np.array([largest_tension(value) / full for value in swept])
columns = {"sigma / |delta_c|": swept / stretch, "theory": at_swept, "patches": mean, "standard error": sem}
columns["mean curve"] = -patches.pull_off_force_of_mean / (full * patches.nominal_area)
columns["contacts at pull-off"] = patches.pull_off_contacts.mean("realization")
print(f"largest relative difference of expected law and theory: {float(abs(law / at_swept - 1).max()):.0e}")
pd.DataFrame(columns).round(4)

# %%
# The expected law is the theory of Fuller and Tabor. The pull-off force of single patches is larger on average, most of
# all on rough patches: each patch has its largest tension at a separation of its own. The pull-off force of the mean
# curve (``pull_off_force_of_mean``) is the quantity to compare with the theory.

"""
An interface law for finite elements
====================================

The rough layer of a joint is far thinner than an element. This page computes its law, pressure over overclosure, writes
it as a table for Abaqus, CalculiX and CSV, and checks that lines between the points of the table keep the error asked.
"""

import tempfile
from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib import pyplot as plt

import roughmdr as rm

# %%
# The scene is a joint of two ground steel faces, as in ``pipelines/scenes/rough_joint.toml``. The roughness of both
# faces is put into one: add the variances of their heights, slopes and curvatures. The expected law has no noise.

SCENE = {
    "title": "Ground faces of a steel joint",
    "material": {"modulus": "210 GPa", "poisson": 0.3},
    "counter": {"modulus": "210 GPa", "poisson": 0.3},
    "asperities": {
        "source": "random",
        "shape": "paraboloid",
        "count": 20_000,
        "patch": "2 mm",
        "height": {"distribution": "normal", "std": "0.5 um"},
        "radius": {"distribution": "lognormal", "mean": "150 um", "std": "30 um"},
    },
    "path": {"separation": {"start": "clear", "stop": {"contact_fraction": 0.02}, "steps": 200}},
    "batch": {"estimator": "expected"},
}
law = rm.run(SCENE)

# %%
# Write the tables. ``units`` names length, force and stress of your finite-element model. The header of each says what
# the table is, how far it is right, and how the code reads it. This is the one for CalculiX; ``to="abaqus"`` differs in
# that line alone.

folder = Path(tempfile.mkdtemp())
rm.export(law, folder / "layer_abaqus.inp", to="abaqus", units="mm,N,MPa")
rm.export(law, folder / "layer.inp", to="calculix", units="mm,N,MPa")
lines = (folder / "layer.inp").read_text().splitlines()
end = next(number for number, line in enumerate(lines) if line.startswith("*SURFACE"))
print("\n".join(lines[: end + 4]))

# %%
# ``error`` is that of straight lines between the points. The export leaves out every step that it does not need for
# this error. Check it against a law of 1000 steps. The error counts over the pressure itself down to a tenth of the
# largest, and over that tenth below.

fine = rm.run(SCENE, set={"path.separation.steps": 1000})
pressure = 1e-6 * (fine.force / fine.nominal_area).values[0]
overclosure = 1e3 * (fine.separation.values[0] - fine.separation.values)
figure, (left, right) = plt.subplots(1, 2, figsize=(8, 4), layout="constrained")
left.plot(1e3 * overclosure, pressure, "0.8", linewidth=4, label="law, 1000 steps")
rows = {}
for colour, error in (("C3", 0.1), ("C0", 0.01), ("C2", 0.001)):
    rm.export(law, folder / "layer.csv", to="csv", units="mm,N,MPa", error=error)
    table = pd.read_csv(folder / "layer.csv", comment="#")
    knots = table["overclosure [mm]"], table["pressure [MPa]"]
    off = np.abs(np.interp(overclosure, *knots) - pressure) / np.maximum(pressure, 0.1 * pressure.max())
    right.semilogy(1e3 * overclosure, 100 * off, color=colour, label=f"error {error:g}")
    right.axhline(100 * error, color=colour, linestyle=":")
    rows[f"{error:g}"] = {"points": str(len(table)), "largest error found": f"{off.max():.5f}"}
    if error > 0.001:
        left.plot(1e3 * knots[0], knots[1], "o-", color=colour, markersize=4, linewidth=1, label=f"error {error:g}")
left.set(xlabel="overclosure [um]", ylabel="pressure [MPa]", xlim=(1.2, None))
right.set(xlabel="overclosure [um]", ylabel="error of the lines [%]", xlim=(1.2, None), ylim=(1e-4, 100))
text = left.legend(), right.legend(loc="lower left", fontsize=8)

# %%
# The points lie where the pressure bends most. Lines never leave the error that was asked (dotted), and with 62 of the
# 200 steps they keep a tenth of a per cent:

pd.DataFrame(rows).rename_axis(columns="error asked")

# %%
# - The error of the lines is not that of the model. The header tells that one too: asperities are independent here, and
#   ``interaction.model = "pairwise"`` mends most of it (:doc:`plot_09_interaction`).
# - ``pipelines/scenes/rough_joint.inp`` is a CalculiX model of two steel blocks that includes such a table.
# - ``quantity="area"``, ``"conductance"`` and ``"tangential"`` write other tables, and ``to="moose"``, ``"ansys"``,
#   ``"c"`` and ``"json"`` other formats.

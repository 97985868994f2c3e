r"""
A sweep: work of adhesion and roughness
=======================================

How does the pull-off force depend on two quantities at once? This page sweeps the work of adhesion and the roughness,
draws the colour map, selects cells by their values, and finds the one number on which the share of adhesion depends.
"""

import matplotlib.pyplot as plt
import numpy as np

import roughmdr as rm

scene = {
    "title": "Pull-off force of 400 asperities",
    "seed": 2026,
    "material": {"effective_modulus": "4 MPa"},
    "adhesion": {"model": "jkr"},
    "asperities": {
        "source": "random",
        "shape": "paraboloid",
        "count": 400,
        "patch": "2 mm",
        "radius": "100 um",
        "height": {"distribution": "normal"},
    },
    "path": {"separation": {"stop": "0 sigma", "steps": 80}, "unload": True},
    "output": {"variables": ["force", "contact_count"]},
    "batch": {"realizations": 8},
    "sweep": {
        "adhesion.work": ["10 mJ/m^2", "20 mJ/m^2", "40 mJ/m^2", "80 mJ/m^2"],
        "asperities.height.std": {"logspace": ["0.1 um", "1.6 um"], "num": 7},
    },
}
ds = rm.run(scene)
figure = rm.plot(ds, kind="sweep")

# %%
# Each field is one cell of the sweep, with the mean over eight realisations and its standard error. Every cell sees the
# same random draws, so the differences between cells are not noise.
#
# Select cells by their values
# ----------------------------
# The result is an ``xarray.Dataset`` with one dimension for each swept key; the dots become underscores and the
# coordinates are in SI. ``separation`` depends on the cell, too: each path goes from where nothing touches down to the
# mean height of the summits, and back. The lower branch is the unloading.

cells = ds.sel(adhesion_work=0.04).sel(asperities_height_std=[0.16e-6, 0.25e-6, 0.4e-6, 0.64e-6], method="nearest")

curves, axes = plt.subplots(figsize=(7, 4), layout="constrained")
for std in cells.asperities_height_std.values:
    cell = cells.sel(asperities_height_std=std)
    axes.plot(cell.separation * 1e6, cell.force.mean("realization") * 1e3, label=f"σ = {std * 1e6:.2f} µm")
axes.axhline(0, color="k", lw=0.5)
axes.set(xlabel="separation [µm]", ylabel="mean force [mN]", xlim=(-0.1, 2.2), ylim=(-4, 3), title="40 mJ/m²")
_ = axes.legend()

# %%
# One number
# ----------
# A JKR contact of radius :math:`R` bears the tension :math:`\tfrac{3}{2} \pi w R` at most, and detaches when it is
# stretched by :math:`|\delta_c| = \tfrac{3}{4} (\pi^2 w^2 R / E^{*2})^{1/3}`. In these units the pull-off force depends
# on :math:`\sigma / |\delta_c|` alone.

N, R, E = 400, 100e-6, 4e6
work, std = ds.adhesion_work, ds.asperities_height_std
share = -ds.pull_off_force.mean("realization") / (N * 1.5 * np.pi * work * R)
stretch = 0.75 * (np.pi**2 * work**2 * R / E**2) ** (1 / 3)

collapse, axes = plt.subplots(figsize=(7, 4), layout="constrained")
for size, w in zip((11, 8, 5, 2), work.values, strict=True):
    x, y = std / stretch.sel(adhesion_work=w), share.sel(adhesion_work=w)
    axes.loglog(x, y, "o", ms=size, mfc="none" if size > 2 else None, label=f"{w * 1e3:.0f} mJ/m²")
axes.set(xlabel="σ / |δc|", ylabel="pull-off force / (N · 3/2 π w R)")
_ = axes.legend()

# %%
# Twice the work stretches a contact by :math:`2^{2/3}`, which is also the ratio of neighbouring roughnesses here. So a
# cell and the next one along both axes have the same share. The same draws make that exact:

lower, upper = share.values[:-1, :-1], share.values[1:, 1:]
print(f"largest relative difference along the diagonals: {np.max(abs(upper / lower - 1)):.0e}")

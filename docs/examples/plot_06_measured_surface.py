"""
A measured surface: which law to believe
========================================

You have a height map from a microscope. Is it good enough, and which of three laws of its contact do you believe:
independent summits, hills that feel each other, or boundary elements on the map itself?
"""

import tempfile
import warnings
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd

import roughmdr as rm

# %%
# The map
# -------
# A synthetic map stands in for a measured one: 256 x 256 points, 100 µm wide, waves from 50 to 6 µm, Hurst exponent
# 0.8, r.m.s. height 0.3 µm. ``.npz`` is one of the formats that ``source = "surface"`` reads; ``size`` is the size in m.

side, points = 100e-6, 256
q = 2 * np.pi * np.fft.fftfreq(points, side / points)
q = np.hypot(q[:, None], q)
waves = (q > 2 * np.pi / 50.1e-6) & (q < 2 * np.pi / 6e-6)
amplitude = np.where(waves, np.maximum(q, 1.0) ** -1.8, 0.0)
noise = np.random.default_rng(3).standard_normal((points, points))
height = np.fft.ifft2(np.fft.fft2(noise) * amplitude).real
height *= 0.3e-6 / height.std()

folder = tempfile.TemporaryDirectory()
file = Path(folder.name) / "map.npz"
np.savez(file, height=height, size=[side, side])

section = {"source": "surface", "file": str(file), "periodic": True}
summits = rm.generate(section, seed=0)

map_figure, axes = plt.subplots(figsize=(6, 4.5), layout="constrained")
image = axes.pcolormesh(*2 * [np.linspace(0, 100, points)], height.T * 1e6, cmap="cividis", rasterized=True)
axes.plot(summits.x * 1e6, summits.y * 1e6, "r.", ms=4)
axes.set(xlabel="x [µm]", ylabel="y [µm]", aspect="equal", title=f"{summits.sizes['asperity']} summits")
_ = map_figure.colorbar(image, label="height [µm]")

# %%
# Is the map good enough?
# -----------------------
# ``radius_uncertainty`` estimates the relative error of the radii of the summits. Above 15 % there is a warning. Look at
# the same map on coarser grids, and with white noise of 3 nm, 1 % of its r.m.s. height.

rng = np.random.default_rng(4)
maps = {
    "256 points a side": height,
    "64 points a side": height[::4, ::4],
    "37 points a side": height[::7, ::7],
    "256 points, noise of 3 nm": height + 3e-9 * rng.standard_normal(height.shape),
}
rows = {}
for name, values in maps.items():
    np.savez(Path(folder.name) / "other.npz", height=values, size=[side, side])
    with warnings.catch_warnings(action="ignore"):  # the table shows what the warnings say
        found = rm.generate({"source": "surface", "file": str(Path(folder.name) / "other.npz")}, seed=0)
    rows[name] = [found.sizes["asperity"], float(found.radius.median()) * 1e6, found.attrs["radius_uncertainty"]]
pd.DataFrame(rows, ["summits", "median radius [µm]", "radius_uncertainty"]).T.round(3)

"""The study of coupled asperities: its picture and its words."""

from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from studies.coupling.measure import crossover
from studies.study import table

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def draw(result: xr.Dataset) -> "Figure":
    """Draw the error of each method over its run time, and run times over the number of asperities."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(12, 5.2), layout="constrained")
    left, right = figure.subplots(1, 2)
    names = result["method"].to_numpy()
    for name in dict.fromkeys(names.tolist()):
        own = result.isel(point=np.flatnonzero(names == name))
        left.loglog(1e3 * own["seconds"], own["error"], "o-", ms=5, lw=1.2, label=name)
    left.set(xlabel="run time of a load [ms]", ylabel="relative error of the force")
    left.set_title("100 separated paraboloids, up to 5 % contact")
    left.legend(fontsize=8)
    for name, label in (("seconds_dense", "pairs one by one"), ("seconds_mesh", "on a mesh")):
        right.loglog(result["asperities"], result[name], "o-", ms=5, lw=1.2, label=label)
    right.set(xlabel="asperities", ylabel="run time of a load [s]", title="Second order, 1 to 3 % contact, one core")
    right.legend(fontsize=9)
    for panel in (left, right):
        panel.grid(color="0.92")
        panel.set_axisbelow(True)
    return figure


def report(result: xr.Dataset) -> str:
    """Return both tables, and from where on a mesh is the faster."""
    rows = [
        [str(point["method"].item()), str(point["setting"].item()), f"{100.0 * float(point['error']):.2g} %",
         f"{1e3 * float(point['seconds']):.3g} ms"]
        for point in (result.isel(point=i) for i in range(result.sizes["point"]))
    ]  # fmt: skip
    costs = [
        [f"{float(one['asperities']):,.0f}", _milliseconds(one["seconds_dense"]), _milliseconds(one["seconds_mesh"]),
         "" if one["difference"].isnull() else f"{float(one['difference']):.1g}",
         f"{float(one['memory']) / 1e6:.0f} MB"]
        for one in (result.isel(asperities=i) for i in range(result.sizes["asperities"]))
    ]  # fmt: skip
    return f"""The largest error of the force of 100 separated paraboloids of lognormal radii, up to 5 % contact:

{table(["method", "setting", "error of the force", "a load"], rows)}

A load to second order on one core, at 1 to 3 % contact:

{table(["asperities", "pairs one by one", "on a mesh", "difference of the forces", "memory"], costs)}

From {crossover(result):.0f} asperities on a mesh is the faster.
"""


def _milliseconds(seconds: xr.DataArray) -> str:
    return "" if seconds.isnull() else f"{1e3 * float(seconds):.3g} ms"

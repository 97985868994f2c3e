"""The picture of the study of adhesive hills."""

from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from studies.adhesive_hills.judge import judge
from studies.adhesive_hills.measure import METHODS
from studies.adhesive_hills.report import name_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_COLOURS = dict(zip(METHODS, ("0.6", "#e69f00", "#56b4e9", "#0072b2", "#d55e00"), strict=True))
_MARKERS = dict(zip(METHODS, "vDosX", strict=True))
_SHOWN = 1


def _curves(panel: "Axes", case: xr.Dataset, way: slice, title: str) -> None:
    """Draw the force of one way over the separation, over the largest tension of boundary elements."""
    separation = 1e9 * case["separation"].to_numpy()[way]
    force = case["force"] / -case["force"].sel(source="elements").min()
    panel.axhline(0.0, color="k", lw=0.8)
    panel.plot(separation, force.sel(source="elements").to_numpy()[way], "k.-", lw=2.0, ms=8, label="elements")
    for name in METHODS:
        panel.plot(separation, force.sel(source=name).to_numpy()[way], color=_COLOURS[name], lw=1.5, label=name)
    panel.set(xlabel="separation [nm]", ylabel="force over pull-off force of elements", title=title)


def _pull_off(panel: "Axes", result: xr.Dataset) -> None:
    """Draw the pull-off force of each method over that of boundary elements."""
    cases = [result.isel(case=i) for i in range(result.sizes["case"])]
    for k, name in enumerate(METHODS):
        ratio = [judge(case, name).pull_off for case in cases]
        place = np.arange(len(cases)) + 0.12 * (k - 2)
        panel.plot(place, ratio, _MARKERS[name], color=_COLOURS[name], ms=7, label=name)
    panel.plot(np.arange(len(cases)), [judge(case, "coarse grid").pull_off for case in cases], "k_", ms=28, mew=1.5,
               label="elements, coarse grid")  # fmt: skip
    panel.axhline(1.0, color="k", lw=0.8)
    panel.set_ylim(bottom=0.0)
    panel.set_xticks(range(len(cases)), [name_of(case) for case in cases], rotation=40, ha="right", fontsize=8)
    panel.set(ylabel="pull-off force over that of elements", title="Map and jump-on radius over wavelength")


def draw(result: xr.Dataset) -> "Figure":
    """Draw the force of one map over the separation both ways, and the pull-off forces of all."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(16, 6.0), layout="constrained")
    left, middle, right = figure.subplots(1, 3)
    case = result.isel(case=_SHOWN)
    turn = case.sizes["step"] // 2
    _curves(left, case, slice(None, turn + 1), f"Loading: {name_of(case)}")
    _curves(middle, case, slice(turn, None), "Unloading of the same map")
    _pull_off(right, result)
    for panel in (left, middle, right):
        panel.grid(color="0.92")
        panel.set_axisbelow(True)
    handles = {label: handle for panel in (left, right) for handle, label in zip(*panel.get_legend_handles_labels(),
               strict=True)}  # fmt: skip
    figure.legend(handles.values(), handles.keys(), loc="outside lower center", ncols=len(handles), fontsize=9)
    return figure

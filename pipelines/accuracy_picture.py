"""The picture of ``accuracy.py``, drawn from its numbers."""

from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_COLOURS = ("#1b6ca8", "#c8553d", "#2e8b57")
_CLAIM, _ENOUGH = 0.95, 1.3
_APART = 0.22  # between the scenes, of the distance between two errors


def draw(result: xr.Dataset) -> "Figure":
    """How many runs reach the error asked for, and how many realisations they take, by the fewest that it takes."""
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D

    figure = Figure(figsize=(13, 5.6), layout="constrained")
    left, right = figure.subplots(1, 2)
    for number, colour in enumerate(_COLOURS[: result.sizes["scene"]]):
        place = np.arange(result.sizes["fewest"]) + _APART * (number - 0.5 * (result.sizes["scene"] - 1))
        own = result.isel(scene=number)
        left.plot(place, 100.0 * own.reached[0], "o", color=colour, ms=8)
        left.plot(place, 100.0 * own.reached[1], "D", color=colour, ms=6, mfc="w")
        _spread(right, place, own.taken / own.fewest, colour)
    left.axhline(100.0 * _CLAIM, color="0.4", lw=1.0, ls="--")
    left.text(-0.45, 100.0 * _CLAIM - 1.0, "95 of 100", color="0.4", va="top")
    left.set(ylim=(0.0, 103.0), ylabel="runs whose true standard error is what was asked for [%]")
    left.set_title("Is the error met?")
    right.axhline(1.0, color="k", lw=1.0)
    right.axhline(_ENOUGH, color="0.4", lw=1.0, ls="--")
    right.set(ylim=(0.0, 2.6), ylabel="realisations taken, over the fewest that meet the error")
    right.set_title("At what cost?")
    for panel in (left, right):
        panel.set_xticks(range(result.sizes["fewest"]), [f"{fewest}" for fewest in result.fewest.to_numpy()])
        panel.set(xlim=(-0.5, result.sizes["fewest"] - 0.5), xlabel="fewest realisations that meet the error asked for")
        panel.grid(axis="y", color="0.92")
        panel.set_axisbelow(True)
    names = zip(result.scene.to_numpy(), result.kurtosis.to_numpy(), _COLOURS, strict=False)
    scenes = [Line2D([], [], color=colour, lw=5, label=f"{name} (kurtosis {k:.1f})") for name, k, colour in names]
    rules = [
        Line2D([], [], color="0.3", marker="o", ms=8, ls="", label="the rule of a batch"),
        Line2D([], [], color="0.3", marker="D", ms=6, ls="", mfc="w", label="stop once the estimate is small enough"),
    ]
    left.legend(handles=[*rules, *scenes], loc="lower right", fontsize=9)
    bars = [
        Line2D(
            [], [], color="0.3", marker="o", ms=8, lw=1.5, label="the rule of a batch: median, 5 to 95 % of the runs"
        ),
        Line2D([], [], color="0.3", marker="D", ms=6, lw=1.0, mfc="w", label="stop once the estimate is small enough"),
    ]
    right.legend(handles=bars, loc="upper right", fontsize=9)
    return figure


def _spread(panel: "Axes", place: np.ndarray, taken: xr.DataArray, colour: str) -> None:
    """Of what runs take: the median, the middle half, and all but the outermost twentieths."""
    low, first, middle, last, high = taken.quantile([0.05, 0.25, 0.5, 0.75, 0.95], "seed").to_numpy()
    panel.vlines(place, low[0], high[0], color=colour, lw=1.5)
    panel.vlines(place, first[0], last[0], color=colour, lw=5)
    panel.plot(place, middle[0], "o", color=colour, ms=8, mec="w")
    aside = place + 0.25 * _APART
    panel.vlines(aside, low[1], high[1], color=colour, lw=1.0, alpha=0.6)
    panel.plot(aside, middle[1], "D", color=colour, ms=5, mfc="w")

"""The study of errors that are asked for: its picture and its words."""

from typing import TYPE_CHECKING

import numpy as np
import xarray as xr
from studies.accuracy.measure import TOLERATED
from studies.study import table

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_COLOURS = ("#1b6ca8", "#c8553d", "#2e8b57")
_PROMISED = 95.0  # [%] of the runs
_SHIFT = 0.22  # between the scenes, of the distance between two errors


def draw(result: xr.Dataset) -> "Figure":
    """Draw how many runs meet the error, and how many realisations they take over the minimal number."""
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D

    figure = Figure(figsize=(13, 5.6), layout="constrained")
    left, right = figure.subplots(1, 2)
    scenes, minimal = result.scene.to_numpy(), result.minimal.to_numpy()
    for number, colour in enumerate(_COLOURS[: scenes.size]):
        x = np.arange(minimal.size) + _SHIFT * (number - 0.5 * (scenes.size - 1))
        own = result.isel(scene=number)
        left.plot(x, 100.0 * own.reached[0], "o", color=colour, ms=8)
        left.plot(x, 100.0 * own.reached[1], "D", color=colour, ms=6, mfc="w")
        low, first, middle, last, high = (
            (own.taken / own.minimal).quantile([0.05, 0.25, 0.5, 0.75, 0.95], "seed").to_numpy()
        )
        right.vlines(x, low[0], high[0], color=colour, lw=1.5)
        right.vlines(x, first[0], last[0], color=colour, lw=5)
        right.plot(x, middle[0], "o", color=colour, ms=8, mec="w")
        right.vlines(x + 0.25 * _SHIFT, low[1], high[1], color=colour, lw=1.0, alpha=0.6)
        right.plot(x + 0.25 * _SHIFT, middle[1], "D", color=colour, ms=5, mfc="w")
    left.axhline(_PROMISED, color="0.4", lw=1.0, ls="--")
    left.text(-0.45, _PROMISED - 1.0, "95 of 100", color="0.4", va="top")
    left.set(ylim=(0.0, 103.0), ylabel="runs whose true standard error is what was asked for [%]")
    left.set_title("Is the error met?")
    right.axhline(1.0, color="k", lw=1.0)
    right.axhline(TOLERATED, color="0.4", lw=1.0, ls="--")
    right.set(ylim=(0.0, 2.6), ylabel="realisations taken, over the fewest that meet the error")
    right.set_title("At what cost?")
    for panel in (left, right):
        panel.set_xticks(range(minimal.size), [f"{count}" for count in minimal])
        panel.set(xlim=(-0.5, minimal.size - 0.5), xlabel="fewest realisations that meet the error asked for")
        panel.grid(axis="y", color="0.92")
        panel.set_axisbelow(True)
    names = zip(scenes, result.kurtosis.to_numpy(), _COLOURS, strict=False)
    lines = [Line2D([], [], color=colour, lw=5, label=f"{name} (kurtosis {k:.1f})") for name, k, colour in names]
    circle = Line2D([], [], color="0.3", marker="o", ms=8, lw=0, label="the rule of a batch")
    diamond = Line2D([], [], color="0.3", marker="D", ms=6, lw=0, mfc="w", label="stop once the estimate is low enough")
    left.legend(handles=[circle, diamond, *lines], loc="lower right", fontsize=9)
    right.legend(handles=[circle, diamond], title="median, 5 to 95 % of the runs", loc="upper right", fontsize=9)
    return figure


def report(result: xr.Dataset) -> str:
    """Return a table of all scenes and errors."""
    rows = []
    for name in result.scene.to_numpy():
        for minimal in result.minimal.to_numpy():
            rule, naive = (result.sel(scene=name, minimal=minimal, rule=rule) for rule in result.rule)
            times = [f"{value:.2f}" for value in (rule.taken / minimal).quantile([0.5, 0.05, 0.95]).to_numpy()]
            met = [f"{100.0 * float(own.reached):.1f} %" for own in (rule, naive)]
            rows.append(
                [
                    f"{name} (kurtosis {float(rule.kurtosis):.1f})",
                    f"{float(rule.asked):.2g}",
                    f"{minimal}",
                    *met,
                    *times,
                ]
            )
    head = ["scene", "error", "fewest", "met", "met by the estimate alone", "taken over fewest: median", "5 %", "95 %"]
    return table(head, rows)

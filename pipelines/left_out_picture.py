"""The picture of ``left_out.py``, drawn from its numbers."""

from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_LEFT_OUT, _FORCED_ON = "#1b6ca8", "#c8553d"


def figures(value: float) -> str:
    """A number in three figures, or as many as it has before the point."""
    return f"{value:,.0f}" if value >= 1000.0 else f"{value:.3g}"


def draw(result: xr.Dataset) -> "Figure":
    """Time, memory and work of each case, with the part left out and forced on."""
    from matplotlib.figure import Figure

    parts = result["part"].to_numpy()
    begins = np.array([True, *(parts[1:] != parts[:-1])])
    places = np.arange(len(parts)) + 1.2 * np.cumsum(begins)  # room for a heading before each part
    figure = Figure(figsize=(15, 0.25 * places[-1] + 1.6), layout="constrained")
    figure.suptitle(result.attrs["comment"])
    time, memory, work = figure.subplots(1, 3, sharey=True, width_ratios=[1.0, 0.8, 1.0])
    seconds, counted = result["seconds"].to_numpy(), result["counted"].to_numpy()
    _times(time, places, seconds, [f"{figures(1e3 * left)} to {figures(1e3 * on)} ms" for left, on in seconds])
    time.set(title="Processor time", xlabel="times as long with the part forced on")
    units = zip(counted, result["unit"].to_numpy(), strict=True)
    _times(work, places, counted, [f"{figures(left)} to {figures(on)} {unit}" for (left, on), unit in units])
    work.set(title="Work", xlabel="times as much with the part forced on")
    size = result["memory"].to_numpy() / 1e6
    memory.hlines(places, *size.T, color="0.7", zorder=0)
    memory.plot(size[:, 0], places, "o", color=_LEFT_OUT, label="left out")
    memory.plot(size[:, 1], places, "D", color=_FORCED_ON, ms=5, label="forced on")
    memory.set_xscale("symlog", linthresh=1.0)
    memory.set(title="Memory", xlabel="MB", xlim=(-0.1, 2.0 * size.max()))
    memory.set_xticks([0, 1, 10, 100], ["0", "1", "10", "100"])
    memory.legend(loc="upper right")
    time.set_yticks(places, result["scene"].to_numpy())
    time.set_ylim(places[-1] + 0.8, places[0] - 1.8)
    for place, part in zip(places[begins], parts[begins], strict=True):
        time.text(-0.02, place - 1.05, part, transform=time.get_yaxis_transform(), ha="right", va="center", weight=700)
    for panel in (time, memory, work):
        panel.grid(axis="x", color="0.92")
        panel.set_axisbelow(True)
        panel.tick_params(axis="y", length=0)
    return figure


def _times(panel: "Axes", places: np.ndarray, both: np.ndarray, texts: list[str]) -> None:
    """How many times the first the second is; where the first is nothing, an arrow."""
    ratio = both[:, 1] / np.where(both[:, 0] > 0.0, both[:, 0], np.nan)
    panel.axvline(1.0, color="0.3", lw=1.0)
    panel.barh(places, ratio - 1.0, left=1.0, color=_FORCED_ON, height=0.7)
    for place, own, text in zip(places, ratio, texts, strict=True):
        if np.isnan(own):
            panel.plot(1.08, place, ">", color=_FORCED_ON)
        end, aside = (1.0, 14.0) if np.isnan(own) else (max(own, 1.0), 4.0)
        panel.annotate(text, (end, place), (aside, 0.0), textcoords="offset points", va="center", fontsize=8)
    panel.set_xscale("log")
    panel.set_xlim(0.8, 300.0 * float(np.nanmax(ratio)))
    panel.set_xticks([1, 10, 100], ["1", "10", "100"])

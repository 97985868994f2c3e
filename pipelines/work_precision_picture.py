"""The picture of ``work_precision.py``, drawn from its numbers."""

from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_LEAST = 1e-16  # what is less is drawn here
_COLOURS = [f"C{number}" for number in range(10)] + ["#1b1b1b", "#b8860b", "#3cb371", "#c71585", "#4169e1"]


def draw(result: xr.Dataset) -> "Figure":
    """For each scene the error of the force, and of the pull-off force or area, against run time, a curve a method."""
    from matplotlib.figure import Figure

    scenes = _unique(result.scene)
    figure = Figure(figsize=(4.0 * len(scenes), 8.6), layout="constrained")
    panels = figure.subplots(2, len(scenes), squeeze=False)
    colours = dict(zip(_unique(result.method), _COLOURS, strict=False))
    handles: dict[str, Any] = {}
    for column, scene in enumerate(scenes):
        own = result.isel(point=np.flatnonzero(result.scene.to_numpy() == scene))
        second = "contact area" if np.isnan(own.error.sel(quantity="pull-off force")).all() else "pull-off force"
        for panel, quantity in zip(panels[:, column], ("force", second), strict=True):
            for name in _unique(own.method):
                _curve(panel, own.isel(point=np.flatnonzero(own.method.to_numpy() == name)), quantity, colours[name])
            panel.set(xscale="log", yscale="log", ylim=(_LEAST / 3.0, 3.0), ylabel=f"relative error of the {quantity}")
            panel.grid(color="0.92")
        panels[0, column].set_title(scene)
        panels[1, column].set_xlabel("run time of a curve [ms]")
        lines, names = panels[0, column].get_legend_handles_labels()
        handles |= dict(zip(names, lines, strict=True))
    figure.legend(handles.values(), handles, loc="outside lower center", ncols=7, frameon=False)
    return figure


def _unique(values: xr.DataArray) -> list[str]:
    return list(dict.fromkeys(values.to_numpy().tolist()))


def _curve(panel: "Axes", own: xr.Dataset, quantity: str, colour: str) -> None:
    error = np.maximum(own.error.sel(quantity=quantity).to_numpy(), _LEAST)
    marker, size = ("*", 12.0) if own.sizes["point"] == 1 else ("o", 3.5)
    line = "-" if own.competes.all() else ":"
    name = str(own.method.to_numpy()[0])
    panel.plot(1e3 * own.seconds, error, line, marker=marker, ms=size, color=colour, lw=1.2, label=name)

"""The picture of error against run time."""

from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr
from studies.work_precision.measure import points_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_MIN_ERROR = 1e-16  # lower errors are drawn here
_COLOURS = [f"C{number}" for number in range(10)] + ["#1b1b1b", "#b8860b", "#3cb371", "#c71585", "#4169e1"]


def draw(result: xr.Dataset) -> "Figure":
    """Draw for each scene the errors of the force, and of the pull-off force or area, a curve for each method."""
    from matplotlib.figure import Figure

    scenes = _unique(result.scene)
    figure = Figure(figsize=(4.0 * len(scenes), 8.6), layout="constrained")
    panels = figure.subplots(2, len(scenes), squeeze=False)
    colours = dict(zip(_unique(result.method), _COLOURS, strict=False))
    handles: dict[str, Any] = {}
    for column, scene in enumerate(scenes):
        own = points_of(result, scene=scene)
        second = "contact area" if np.isnan(own.error.sel(quantity="pull-off force")).all() else "pull-off force"
        for panel, quantity in zip(panels[:, column], ("force", second), strict=True):
            for name in _unique(own.method):
                curve = points_of(own, method=name)
                error = np.maximum(curve.error.sel(quantity=quantity).to_numpy(), _MIN_ERROR)
                marker, size = ("*", 12.0) if curve.sizes["point"] == 1 else ("o", 3.5)
                line = f"{marker}{'-' if curve.competes.all() else ':'}"
                panel.plot(1e3 * curve.seconds, error, line, ms=size, color=colours[name], lw=1.2, label=name)
            limits = (_MIN_ERROR / 3.0, 3.0)
            panel.set(xscale="log", yscale="log", ylim=limits, ylabel=f"relative error of the {quantity}")
            panel.grid(color="0.92")
        panels[0, column].set_title(scene)
        panels[1, column].set_xlabel("run time of a curve [ms]")
        lines, names = panels[0, column].get_legend_handles_labels()
        handles |= dict(zip(names, lines, strict=True))
    figure.legend(handles.values(), handles, loc="outside lower center", ncols=7, frameon=False)
    return figure


def _unique(values: xr.DataArray) -> list[str]:
    return list(dict.fromkeys(values.to_numpy().tolist()))

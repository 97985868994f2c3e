"""Error against run time, in tables and as a picture."""

from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr
from studies.study import table
from studies.work_precision.measure import cheapest, points_of
from studies.work_precision.points import QUANTITIES

if TYPE_CHECKING:
    from matplotlib.figure import Figure

TARGETS = (0.1, 0.01, 1e-3, 1e-4)
_MIN_ERROR = 1e-16  # lower errors are drawn here
_COLOURS = [f"C{number}" for number in range(10)] + ["#1b1b1b", "#b8860b", "#3cb371", "#c71585", "#4169e1"]


def report(result: xr.Dataset) -> str:
    """Return tables of the cheapest method for each error, and of runs to an error that is asked for."""
    lines = ["The cheapest method for an error: run time of a curve, in brackets the evaluations counted in it.\n"]
    for quantity in QUANTITIES:
        rows = [
            [scene, *(_in_words(cheapest(result, scene, quantity, error)) for error in TARGETS)]
            for scene in _unique(result.scene)
            if not np.isnan(points_of(result, scene=scene).error.sel(quantity=quantity)).all()
        ]
        lines += [table([f"error of the {quantity}", *(f"{100 * error:g} %" for error in TARGETS)], rows), ""]
    rows = []
    asked_for = points_of(result, method="auto, error asked for")
    for point in (asked_for.isel(point=number) for number in range(asked_for.sizes["point"])):
        scene, error, found = point.scene.item(), float(point.setting), float(point.error.sel(quantity="force"))
        best = _in_words(cheapest(result, scene, "force", error))
        rows.append([scene, f"{100 * error:g} %", f"{100 * found:.1g} %", _cost(point), best])
    head = ['[accuracy] method = "auto"', "asked", "came to", "cost", "cheapest, had one known"]
    return "\n".join([*lines, table(head, rows)])


def _in_words(point: xr.Dataset | None) -> str:
    """Return the method of a point, its setting and its cost."""
    if point is None:
        return "none"
    value, setting = float(point.setting), str(point.setting_of.item())
    what = "" if setting == "-" else f", {value:g} {setting.removesuffix('s') if value == 1.0 else setting}"
    return f"{point.method.item()}{what}: {_cost(point)}"


def _cost(point: xr.Dataset) -> str:
    return f"{1e3 * float(point.seconds):.2g} ms ({float(point.evaluations):,.0f})"


def _unique(values: xr.DataArray) -> list[str]:
    return list(dict.fromkeys(values.to_numpy().tolist()))


def draw(result: xr.Dataset) -> "Figure":
    """Draw for each scene the errors of the force, and of the pull-off force or area, a curve for each method."""
    from matplotlib.figure import Figure

    scenes, handles = _unique(result.scene), dict[str, Any]()
    figure = Figure(figsize=(4.0 * len(scenes), 8.6), layout="constrained")
    panels = figure.subplots(2, len(scenes), squeeze=False)
    colours = dict(zip(_unique(result.method), _COLOURS, strict=False))
    for column, scene in zip(panels.T, scenes, strict=True):
        own = points_of(result, scene=scene)
        second = "contact area" if np.isnan(own.error.sel(quantity="pull-off force")).all() else "pull-off force"
        for panel, quantity in zip(column, ("force", second), strict=True):
            for name in _unique(own.method):
                curve = points_of(own, method=name)
                error = np.maximum(curve.error.sel(quantity=quantity).to_numpy(), _MIN_ERROR)
                marker, size = ("*", 12.0) if curve.sizes["point"] == 1 else ("o", 3.5)
                line = f"{marker}{'-' if curve.competes.all() else ':'}"
                (handles[name],) = panel.plot(1e3 * curve.seconds, error, line, ms=size, color=colours[name], lw=1.2)
            panel.set(xscale="log", yscale="log", ylim=(_MIN_ERROR / 3.0, 3.0))
            panel.set_ylabel(f"relative error of the {quantity}")
            panel.grid(color="0.92")
        column[0].set_title(scene)
        column[1].set_xlabel("run time of a curve [ms]")
    figure.legend(
        handles.values(), handles, loc="outside lower center", ncols=min(7, 5 * len(scenes) // 3), frameon=False
    )
    return figure

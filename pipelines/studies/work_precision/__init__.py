"""Error against run time, a curve for each method: of one asperity, and of the mean curve of a rough surface.

Errors are those against many digits, of the force at given separations, the contact area and the pull-off force; run
times are those of a curve of 50 to 200 states. A method joins by a line in ``METHODS`` of tip.py or surface.py.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from studies.comparison import groups_of, of_rows
from studies.study import Figure, Study, blank, named, table, without_limits
from studies.work_precision import surface, tip
from studies.work_precision.points import QUANTITIES, Errors, Method, Reference


class Part(NamedTuple):
    """Some scenes, the methods for their curves, and their exact results."""

    scenes: dict[str, Any]
    methods: tuple[Method, ...]
    reference: Callable[..., Reference]


PARTS = (Part(tip.TIPS, tip.METHODS, tip.reference), Part(surface.SURFACES, surface.METHODS, surface.reference))
_POINT = {
    "setting": ("what the error is set by", "1"),
    "seconds": ("run time of a curve", "s"),
    "evaluations": ("evaluations of a state, a profile, an integrand or a spring for a curve", "1"),
}
TARGETS = (0.1, 0.01, 1e-3, 1e-4)
_MIN_ERROR = 1e-16  # lower errors are drawn here
_COLOURS = [f"C{number}" for number in range(10)] + ["#1b1b1b", "#b8860b", "#3cb371", "#c71585", "#4169e1"]


def measure(quick: bool) -> xr.Dataset:
    """Return the points of all methods on all scenes; quick without the last scene of each part."""
    rows, errors = list[dict[str, Any]](), list[Errors]()
    with without_limits():  # all methods suppose the same
        for part in PARTS:
            for title, scene in list(part.scenes.items())[: -1 if quick else None]:
                exact = part.reference(scene, quick=quick)
                for method in part.methods:
                    labels = {"setting_of": method.setting, "competes": int(method.competes)}
                    for point in method.points(scene, exact, quick):
                        numbers = {name: getattr(point, name) for name in _POINT}
                        rows.append({"scene": title, "method": method.name, **labels, **numbers})
                        errors.append(point.errors)
    error = ("point", "quantity"), errors, named("relative error of a quantity")
    return of_rows(_POINT, rows, "point").assign(error=error).assign_coords(quantity=list(QUANTITIES))


def cheapest(result: xr.Dataset, scene: str, quantity: str, error: float) -> xr.Dataset | None:
    """Return the point of least run time that comes to an error in a quantity; None where none does."""
    competes = (result.scene == scene) & (result.competes == 1)
    good_enough = np.flatnonzero(competes & (result.error.sel(quantity=quantity) <= error))
    if good_enough.size == 0:
        return None
    return result.isel(point=good_enough[np.argmin(result.seconds.to_numpy()[good_enough])])


def report(result: xr.Dataset) -> str:
    """Return tables of the cheapest method for each error."""
    lines = ["The cheapest method for an error: run time of a curve, in brackets the evaluations counted in it.\n"]
    for quantity in QUANTITIES:
        rows = [
            [scene, *(_in_words(cheapest(result, scene, quantity, error)) for error in TARGETS)]
            for (scene,), own in groups_of(result, "scene")
            if not np.isnan(own.error.sel(quantity=quantity)).all()
        ]
        lines += [table([f"error of the {quantity}", *(f"{100 * error:g} %" for error in TARGETS)], rows), ""]
    return "\n".join(lines)


def _in_words(point: xr.Dataset | None) -> str:
    """Return the method of a point, its setting and its cost."""
    if point is None:
        return "none"
    value, setting = float(point.setting), str(point.setting_of.item())
    what = "" if setting == "-" else f", {value:g} {setting.removesuffix('s') if value == 1.0 else setting}"
    return f"{point.method.item()}{what}: {1e3 * float(point.seconds):.2g} ms ({float(point.evaluations):,.0f})"


def draw(result: xr.Dataset) -> Figure:
    """Draw for each scene the errors of the force, and of the pull-off force or area, a curve for each method."""
    scenes, handles = list(groups_of(result, "scene")), dict[str, Any]()
    figure = blank(4.0 * len(scenes), 8.6)
    panels = figure.subplots(2, len(scenes), squeeze=False)
    colours = dict(zip(dict.fromkeys(result.method.values.tolist()), _COLOURS, strict=False))
    for column, ((scene,), own) in zip(panels.T, scenes, strict=True):
        second = "contact area" if np.isnan(own.error.sel(quantity="pull-off force")).all() else "pull-off force"
        for panel, quantity in zip(column, ("force", second), strict=True):
            for (name,), curve in groups_of(own, "method"):
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


STUDY = Study(
    "work_precision", "Error against run time", measure, draw, report,
    "every other setting, timed once, fewer draws and runs; without the last scene of each part",
)  # fmt: skip

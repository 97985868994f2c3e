"""The study of error against run time, in words."""

import numpy as np
import xarray as xr
from studies.study import table
from studies.work_precision.measure import cheapest, points_of
from studies.work_precision.points import QUANTITIES

TARGETS = (0.1, 0.01, 1e-3, 1e-4)


def report(result: xr.Dataset) -> str:
    """Return tables of the cheapest method for each error, and of runs to an error that is asked for."""
    lines = ["The cheapest method for an error: run time of a curve, in brackets the evaluations counted in it.\n"]
    scenes = list(dict.fromkeys(result.scene.to_numpy().tolist()))
    for quantity in QUANTITIES:
        rows = [
            [scene, *(_in_words(cheapest(result, scene, quantity, error)) for error in TARGETS)]
            for scene in scenes
            if not np.isnan(points_of(result, scene=scene).error.sel(quantity=quantity)).all()
        ]
        lines += [table([f"error of the {quantity}", *(f"{100 * error:g} %" for error in TARGETS)], rows), ""]
    rows = []
    for scene in scenes:
        own = points_of(result, scene=scene, method="auto, error asked for")
        for point in (own.isel(point=number) for number in range(own.sizes["point"])):
            error, found = float(point.setting), float(point.error.sel(quantity="force"))
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

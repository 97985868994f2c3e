"""Plans and results in words, for the command line."""

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from roughmdr.analysis import PullOff, pull_off_force
from roughmdr.curves import held_variables, swept_dimensions
from roughmdr.labelled import Labelled

if TYPE_CHECKING:
    from roughmdr.estimate import Estimate
    from roughmdr.plan import Plan

_MOST_CELLS = 20


def describe_plan(plan: "Plan", estimate: "Estimate", workers: int) -> str:
    """What a run will do, how long it will take and how much memory."""
    steps = plan.cells[0].route.separation.size
    lines = [
        ("scene", plan.scene.title),
        ("runs", f"{_sizes(plan.sizes, plan.scene.batch.realizations, steps)} ({plan.runs} runs)"),
        ("output", f"{', '.join(plan.scene.output.variables)}; {plan.scene.output.keep}; {_bytes(estimate.file)}"),
        ("tasks", f"{len(plan.tasks)} on {workers} worker{'s' * (workers > 1)}"),
        ("time", f"about {_seconds(estimate.seconds)}, of them {_seconds(estimate.start_up)} to start"),
        ("memory", f"about {_bytes(estimate.memory)}, of them {_bytes(estimate.resident)} for Python and its packages"),
    ]
    return _table([*lines, *_several("left out", plan.left_out)])


def describe_result(result: Labelled, elapsed: float | None = None) -> str:
    """What a result holds; ``elapsed`` [s] is the time that it took in all."""
    attrs = result.attrs
    realizations, steps = realizations_of(result), result.sizes["step"]
    swept = {name: result.sizes[name] for name in swept_dimensions(result)}
    lines = [
        ("computed", f"{attrs['title']}: {_sizes(swept, realizations, steps)}"),
        ("variables", ", ".join(held_variables(result))),
        *_pull_off(result, realizations),
        ("run time", _run_time(result, elapsed)),
        ("error", f"numerical error at most {_array(result, 'numerical_error').max():.1e} of the largest force"),
    ]
    return _table([*lines, *_several("left out", tuple(attrs["left_out"].splitlines()))])


def describe_origin(result: Labelled, size: float) -> str:
    """Which scene made a result, of ``size`` bytes, with which seed and versions, and when."""
    attrs = result.attrs
    failed = int((_array(result, "status") != 0).sum())
    lines = [
        ("size", _bytes(size)),
        ("seed", str(attrs["seed"])),
        ("made by", f"{attrs['source']}; {attrs['packages']}"),
        ("history", attrs["history"]),
    ]
    if failed:
        lines.append(("status", f"{failed} not computed"))
    return _table([*lines, *_several("scene", tuple(attrs["scene"].strip().splitlines()))])


def realizations_of(result: Labelled) -> int:
    """How many realisations a result is made from."""
    if "realization_count" in result.variables:
        return int(_array(result, "realization_count").max())
    return result.sizes["realization"]


def _array(result: Labelled, name: str) -> np.ndarray:
    return result.variables[name].values


def _sizes(swept: dict[str, int], realizations: int, steps: int) -> str:
    parts = [f"{size} {name}" for name, size in swept.items()]
    return " x ".join([*parts, f"{realizations} realisation{'s' * (realizations > 1)}", f"{steps} steps"])


def _run_time(result: Labelled, elapsed: float | None) -> str:
    inside = f"{_seconds(float(_array(result, 'run_time').sum()))} in the realisations"
    return inside if elapsed is None else f"{_seconds(elapsed)}, of them {inside}"


def _pull_off(result: Labelled, realizations: int) -> Iterator[tuple[str, str]]:
    if "force" not in held_variables(result):
        return
    pull_off = pull_off_force(result)
    what = "at the lowest point of the mean curve" if pull_off.of_the_mean else "mean"
    note = f"{what}, and its standard error over {realizations} realisations"
    if realizations == 1:
        note = "one realisation: no standard error"
    cells = cells_of(result)
    if len(cells) == 1:
        yield "pull-off", f"{_force(pull_off, cells[0])} ({note})"
        return
    yield "pull-off", note
    forces = [_force(pull_off, cell) for cell in cells[:_MOST_CELLS]]
    width = max(map(len, forces))
    for force, cell in zip(forces, cells, strict=False):
        yield "", f"{force:<{width}}  {cell_label(result, cell)}"
    if len(cells) > _MOST_CELLS:
        yield "", f"... and {len(cells) - _MOST_CELLS} cells more"


def _force(pull_off: PullOff, cell: tuple[int, ...]) -> str:
    mean, error = float(pull_off.mean[cell]), float(pull_off.standard_error[cell])
    if mean == 0.0:
        return "none: the force is never tensile"
    return f"{mean:.4g} N" if math.isnan(error) else f"{mean:.4g} N ± {error:.2g} N"


def cells_of(result: Labelled) -> list[tuple[int, ...]]:
    """The indices of each cell, the last swept dimension fastest; one, empty, without a sweep."""
    return list(np.ndindex(*(result.sizes[name] for name in swept_dimensions(result))))


def cell_label(result: Labelled, cell: tuple[int, ...]) -> str:
    """The swept values of a cell."""
    names = swept_dimensions(result)
    parts = []
    for name, array in result.coordinates.items():
        if name not in ("separation", "branch"):
            value = array.values[tuple(cell[names.index(dim)] for dim in array.dims)]
            unit = array.attrs.get("units", "1")
            shown = value if isinstance(value, str) else f"{value:.4g}"
            parts.append(f"{name} = {shown}{'' if unit == '1' else f' {unit}'}")
    return ", ".join(parts)


def _several(name: str, lines: tuple[str, ...]) -> list[tuple[str, str]]:
    return [(name if i == 0 else "", line) for i, line in enumerate(lines)]


def _table(lines: list[tuple[str, str]]) -> str:
    return "\n".join(f"{name:<12} {text}".rstrip() for name, text in lines)


def _seconds(seconds: float) -> str:
    if seconds < 100.0:
        return f"{seconds:.2g} s"
    return f"{seconds / 60.0:.3g} min" if seconds < 6000.0 else f"{seconds / 3600.0:.3g} h"


def _bytes(size: float) -> str:
    for unit, factor in (("GB", 1e9), ("MB", 1e6), ("kB", 1e3)):
        if size >= factor:
            return f"{size / factor:.3g} {unit}"
    return f"{size:.0f} B"

"""Validation of a result file when it is read, so that no other code has to check what a result holds.

Anyone may have changed the file. A result may hold more than is listed here; what is listed must be of its kind.
"""

from collections.abc import Iterator

import numpy as np

from roughmdr.schema.toml_text import parse_toml
from roughmdr.storage.labelled import Array, Labelled
from roughmdr.variables import (
    AUXILIARY_COORDINATES,
    DONE,
    FAILED,
    LAW_VARIABLES,
    NOT_RUN,
    OUTPUT_VARIABLES,
    PULL_OFF_NUMBERS,
    RUN_DIAGNOSTICS,
    STEP_COORDINATES,
    TIME,
)

_REQUIRED_TEXTS = ("title", "source", "history", "scene", "packages", "left_out")
_OPTIONAL_TEXTS = ("accuracy", "warnings", "versions", "checksum")
_REQUIRED_VARIABLES = ("status", "run_time", "numerical_error")
_KINDS = {"f": "floating-point numbers", "i": "whole numbers", "text": "texts"}
_KIND_OF = {float: "f", int: "i", str: "text"}
_CELL_KINDS = {
    "realization_count": "f",
    "nominal_area": "f",
    "accuracy_reached": "f",
    "accuracy_method": "i",
    "cell_key": "text",
}
"""Kind of each variable over cells: NumPy's, or text."""
_STATISTICS = ("mean", "sem", "min", "max")
_BRANCHES = ("loading", "unloading")


def find_fault(data: Labelled) -> str:
    """Return why these arrays are no result; empty if they are one."""
    checks = (_missing, _attributes, _dimensions, _arrays, _curves, _pull_offs, _numbers)
    return next((fault for check in checks for fault in check(data)), "")


def _missing(data: Labelled) -> Iterator[str]:
    required = (
        (("branch",), data.coordinates),
        (_REQUIRED_VARIABLES, data.variables),
        ((*_REQUIRED_TEXTS, "seed"), data.attrs),
    )
    if missing := [name for names, present in required for name in names if name not in present]:
        yield f"it has no {', '.join(missing)}"
    if not any(name in data.coordinates for name in STEP_COORDINATES):
        yield f"it has none of {', '.join(STEP_COORDINATES)} as a coordinate"


def _attributes(data: Labelled) -> Iterator[str]:
    for name in (*_REQUIRED_TEXTS, *_OPTIONAL_TEXTS):
        if name in data.attrs and not _is_text(data.attrs[name]):
            yield f"the attribute {name} is no text"
    if not isinstance(data.attrs["seed"], int | np.integer):
        yield "the attribute seed is no whole number"
    try:
        scene = parse_toml(data.attrs["scene"])
    except ValueError as error:
        yield f"its scene cannot be read: not valid TOML: {error}"
        return
    for name in ("batch", "sweep"):
        if not isinstance(scene.get(name, {}), dict):
            yield f"{name} in its scene is no table"
    if not isinstance(scene.get("batch", {}).get("estimator", ""), str):
        yield "batch.estimator in its scene is no name"


def _dimensions(data: Labelled) -> Iterator[str]:
    if not all(data.sizes.values()):
        yield "a dimension has no length"
    runs = data.variables["status"].dims
    if "step" in runs or "realization" in runs[:-1] or len(set(runs)) < len(runs):
        yield f"status has the dimensions {', '.join(runs)}; it must have the swept keys, each once, and realization"
    if "realization" in data.sizes and "realization" not in runs:
        yield "status lacks the dimension realization"
    if "realization" not in data.sizes and "realization_count" not in data.variables:
        yield "it has neither a dimension realization nor a realization_count"


def _arrays(data: Labelled) -> Iterator[str]:
    """Find arrays of the wrong kind or over the wrong dimensions, and those that lack their counterpart."""
    runs = data.variables["status"].dims
    cells = tuple(dim for dim in runs if dim != "realization")
    declared = {name: (runs, _KIND_OF[each.dtype]) for name, each in RUN_DIAGNOSTICS.items()}
    declared |= {name: (cells, kind) for name, kind in _CELL_KINDS.items()} | {"branch": (("step",), "text")}
    for name, (dims, kind) in declared.items():
        holder = data.coordinates if kind == "text" else data.variables
        if name in holder:
            yield from _mismatches(name, holder[name], dims, kind)
    control = next(name for name in STEP_COORDINATES if name in data.coordinates)
    for name in (control, *([TIME.name] if TIME.name in data.coordinates else [])):
        values = data.coordinates[name]
        if [dim for dim in cells if dim in values.dims] != list(values.dims[:-1]):
            yield f"{name} has the dimensions {', '.join(values.dims)}; it must have swept keys and step"
        yield from _mismatches(name, values, (*values.dims[:-1], "step"), "f")
    for name, array in data.coordinates.items():
        if name not in AUXILIARY_COORDINATES and not _is_text(array.attrs.get("units", "")):
            yield f"the units of {name} are no text"
    if ("tabor_number" in data.variables) != ("adhesion_law" in data.variables):
        yield "it has one of tabor_number and adhesion_law without the other"
    if (data.variables["status"].values == FAILED).any() and "remark" not in data.coordinates:
        yield "runs failed, and no remark says why"


def _curves(data: Labelled) -> Iterator[str]:
    """Find curves of the wrong kind: at least one is needed, over runs and steps, with all statistics or none."""
    dims, found = (*data.variables["status"].dims, "step"), False
    for name in LAW_VARIABLES:
        statistics = [f"{name}_{statistic}" for statistic in _STATISTICS]
        missing = [part for part in statistics if part not in data.variables]
        if missing and statistics[0] not in missing:
            yield f"it has {statistics[0]} but no {', '.join(missing)}"
        for part in (name, *statistics):
            if part in data.variables:
                found = True
                yield from _mismatches(part, data.variables[part], dims, "f")
    if not found:
        yield f"it has none of {', '.join(OUTPUT_VARIABLES)}"


def _pull_offs(data: Labelled) -> Iterator[str]:
    """Find a pull-off that lacks a part, or one of the wrong kind; a result without any is older than they are."""
    runs = data.variables["status"].dims
    cells = tuple(dim for dim in runs if dim != "realization")
    suffixes = [""] if "realization" in runs else [f"_{statistic}" for statistic in _STATISTICS]
    needed = {name + suffix: runs for name in PULL_OFF_NUMBERS for suffix in suffixes}
    needed |= dict.fromkeys(("pull_off_count", "pull_off_force_of_mean"), cells)
    over_area = [f"pull_off_{name}{suffix}" for name in ("pressure", "contact_fraction") for suffix in suffixes]
    per_area = dict.fromkeys(over_area, runs) | {"pull_off_pressure_of_mean": cells}
    for group in (needed, per_area):
        present = [name for name in group if name in data.variables]
        if present and len(present) < len(group):
            yield f"it has {present[0]} but no {', '.join(name for name in group if name not in present)}"
        for name in present:
            yield from _mismatches(name, data.variables[name], group[name], "f")
    if "pull_off_count" in data.variables:
        count = data.variables["pull_off_count"].values
        if not ((count >= 0.0) & (count < np.inf)).all():
            yield "pull_off_count must be at least 0, and finite"


def _numbers(data: Labelled) -> Iterator[str]:
    """Find values that no run writes; arrays are known to have the right kinds and dimensions."""
    status = data.variables["status"].values
    if not np.isin(status, (DONE, FAILED, NOT_RUN)).all():
        yield f"status must be {DONE}, {FAILED} or {NOT_RUN}"
    if not np.isin(data.coordinates["branch"].values, _BRANCHES).all():
        yield f"branch must be {' or '.join(_BRANCHES)}"
    for name, array in data.coordinates.items():
        if array.values.dtype.kind == "f" and not np.isfinite(array.values).all():
            yield f"{name} is not finite"
    marked = data.variables["marked_steps"].values if "marked_steps" in data.variables else np.zeros_like(status)
    whole = (status == DONE) & (marked == 0.0)  # marked steps may have no value
    for name in ("run_time", "numerical_error", *OUTPUT_VARIABLES, *(f"{name}_mean" for name in OUTPUT_VARIABLES)):
        if name in data.variables and not np.isfinite(data.variables[name].values[whole]).all():
            yield f"{name} is not finite, and status says that it was computed"
    if "realization_count" in data.variables:
        count = data.variables["realization_count"].values
        if not ((count >= 0.0) & (count < np.inf)).all():
            yield "realization_count must be at least 0, and finite"
    for name in ("adhesion_law", "accuracy_method"):
        if name in data.variables:
            array = data.variables[name]
            meanings = array.attrs.get("flag_meanings")
            if not _is_text(meanings):
                yield f"{name} has no flag_meanings"
            elif not ((array.values >= 0) & (array.values < len(str(meanings).split()))).all():
                yield f"{name} has a value that is none of its flags"


def _mismatches(name: str, array: Array, dims: tuple[str, ...], kind: str) -> Iterator[str]:
    if array.dims != dims:
        actual, expected = (", ".join(each) or "none" for each in (array.dims, dims))
        yield f"{name} has the dimensions {actual}; it must have {expected}"
    found = array.values.dtype.kind
    if not (found in "OU" and all(map(_is_text, array.values.flat)) if kind == "text" else found == kind):
        yield f"{name} is of type {array.values.dtype}; it must be {_KINDS[kind]}"


def _is_text(value: object) -> bool:
    """Return whether a value is a text that can be written as UTF-8."""
    return isinstance(value, str) and value.encode(errors="replace").decode() == value

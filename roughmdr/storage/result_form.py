"""The arrays and attributes that make a file a result: checked once, where it is read, so that nothing else asks.

Anyone may have changed the file. A result may hold more than is listed here; nothing here may be of another kind.
"""

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from roughmdr.schema.toml_text import table_of
from roughmdr.storage.labelled import Array, Labelled
from roughmdr.variables import AUXILIARY_COORDINATES, CURVE_VARIABLES, DONE, FAILED, NOT_RUN, RUN_DIAGNOSTICS

_TEXTS = ("title", "source", "history", "scene", "packages", "left_out")
_MORE_TEXTS = ("accuracy", "warnings", "versions", "checksum")
_ALWAYS = ("status", "run_time", "numerical_error")
_OF_CELLS = {"realization_count": "f", "accuracy_reached": "f", "accuracy_method": "i"}
"""Kinds of numbers: f and i as NumPy has them."""
_STATISTICS = ("mean", "sem", "min", "max")
_BRANCHES = ("loading", "unloading")


def fault_in(data: Labelled) -> str:
    """Why arrays are no result; empty where they are one."""
    for faults in (_missing, _attributes, _dimensions, _arrays, _pairs, _curves, _numbers):
        if fault := next(faults(data), ""):
            return fault
    return ""


def _missing(data: Labelled) -> Iterator[str]:
    needed = (("separation", "branch"), data.coordinates), (_ALWAYS, data.variables), ((*_TEXTS, "seed"), data.attrs)
    if missing := [name for names, held in needed for name in names if name not in held]:
        yield f"it holds no {', '.join(missing)}"


def _attributes(data: Labelled) -> Iterator[str]:
    for name in (*_TEXTS, *_MORE_TEXTS):
        if name in data.attrs and not _is_text(data.attrs[name]):
            yield f"the attribute {name} is no text"
    if not isinstance(data.attrs["seed"], int | np.integer):
        yield "the attribute seed is no whole number"
    try:
        scene = table_of(data.attrs["scene"])
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
        yield f"status lies over {', '.join(runs)}; it must lie over swept keys, each once, and realization"
    if "realization" in data.sizes and "realization" not in runs:
        yield "status does not lie over realization"
    if "realization" not in data.sizes and "realization_count" not in data.variables:
        yield "it has neither a dimension realization nor a realization_count"


def _arrays(data: Labelled) -> Iterator[str]:
    runs, cells = data.variables["status"].dims, _cells(data)
    of_runs = {name: _KIND_OF[declared.dtype] for name, declared in RUN_DIAGNOSTICS.items()}
    for declared, dims in ((of_runs, runs), (_OF_CELLS, cells)):
        for name in declared.keys() & data.variables.keys():
            yield from _misfit(name, data.variables[name], dims, declared[name])
    texts = {"cell_key": cells, "branch": ("step",)} | {name: runs for name, kind in of_runs.items() if kind == "text"}
    for name, dims in texts.items():
        if name in data.coordinates:
            yield from _misfit(name, data.coordinates[name], dims, "text")
    separation = data.coordinates["separation"]
    if [dim for dim in cells if dim in separation.dims] != list(separation.dims[:-1]):
        yield f"separation lies over {', '.join(separation.dims)}; it must lie over swept keys and step"
    yield from _misfit("separation", separation, (*separation.dims[:-1], "step"), "f")
    for name, array in data.coordinates.items():
        if name not in AUXILIARY_COORDINATES and not _is_text(array.attrs.get("units", "")):
            yield f"the units of {name} are no text"


def _pairs(data: Labelled) -> Iterator[str]:
    """Find what lacks its counterpart."""
    if ("tabor_number" in data.variables) != ("adhesion_law" in data.variables):
        yield "it holds one of tabor_number and adhesion_law without the other"
    if (data.variables["status"].values == FAILED).any() and "remark" not in data.coordinates:
        yield "runs failed, and no remark says why"


def _curves(data: Labelled) -> Iterator[str]:
    """Of the variables: one at least, over all runs and steps, with all its statistics if with one."""
    over, found = (*data.variables["status"].dims, "step"), False
    for name in CURVE_VARIABLES:
        several = [f"{name}_{what}" for what in _STATISTICS]
        missing = [part for part in several if part not in data.variables]
        if missing and several[0] not in missing:
            yield f"it holds {several[0]} but no {', '.join(missing)}"
        for part in (name, *several):
            if part in data.variables:
                found = True
                yield from _misfit(part, data.variables[part], over, "f")
    if not found:
        yield f"it holds none of {', '.join(CURVE_VARIABLES)}"


def _numbers(data: Labelled) -> Iterator[str]:
    """Find numbers that no run writes, now that arrays are of the right kind and in the right place."""
    status = data.variables["status"].values
    if not np.isin(status, (DONE, FAILED, NOT_RUN)).all():
        yield f"status must be {DONE}, {FAILED} or {NOT_RUN}"
    if not np.isin(data.coordinates["branch"].values, _BRANCHES).all():
        yield f"branch must be {' or '.join(_BRANCHES)}"
    for name, array in data.coordinates.items():
        if array.values.dtype.kind == "f" and not np.isfinite(array.values).all():
            yield f"{name} is not finite"
    done = status == DONE
    for name in ("run_time", "numerical_error", *CURVE_VARIABLES, *(f"{name}_mean" for name in CURVE_VARIABLES)):
        if name in data.variables and not np.isfinite(data.variables[name].values[done]).all():
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
                yield f"{name} holds a number that is none of its flags"


def _cells(data: Labelled) -> tuple[str, ...]:
    return tuple(dim for dim in data.variables["status"].dims if dim != "realization")


def _misfit(name: str, array: Array, dims: tuple[str, ...], kind: str) -> Iterator[str]:
    if array.dims != dims:
        lies, must = (", ".join(each) or "nothing" for each in (array.dims, dims))
        yield f"{name} lies over {lies}; it must lie over {must}"
    if not (_is_texts(array.values) if kind == "text" else array.values.dtype.kind == kind):
        yield f"{name} is of type {array.values.dtype}; it must be {_KINDS[kind]}"


_KIND_OF = {float: "f", int: "i", str: "text"}
_KINDS = {"text": "texts", "f": "floating-point numbers", "i": "whole numbers"}


def _is_texts(values: NDArray[Any]) -> bool:
    return values.dtype.kind in "OU" and all(map(_is_text, values.flat))


def _is_text(value: object) -> bool:
    """Whether it is one that can be written again."""
    return isinstance(value, str) and value.encode(errors="replace").decode() == value

"""Many measured curves: taken apart, fitted one by one, and put together over the dimension ``curve``."""

import os
from collections import Counter
from collections.abc import Callable, Mapping
from contextlib import suppress
from functools import partial
from typing import Any

import numpy as np

from roughmdr.errors import OutOfRange, RoughmdrError, StoreError
from roughmdr.fitting.columns import read_columns
from roughmdr.fitting.formats import Columns, Rows
from roughmdr.fitting.joint import agree
from roughmdr.fitting.measured import MeasuredCurve, read_measured
from roughmdr.fitting.model import Model
from roughmdr.fitting.result import assembled
from roughmdr.fitting.search import Fitted, fitted
from roughmdr.fitting.uncertainty import uncertainty
from roughmdr.numerics.arguments import Floats
from roughmdr.runner.local import over_processes
from roughmdr.runner.progress import progress
from roughmdr.schema.wording import short_repr
from roughmdr.storage.labelled import Array, Labelled
from roughmdr.variables import MEASURED, plain_name

_EACH = 32  # least number of curves for which a process is started
_NAMELESS = "", "nan", "None", "<NA>", "NaT"  # an empty entry of a file or a DataFrame, in words
_OF_ALL = "parameter_name", "parameter_2_name"

Curves = dict[str, Any]
"""Measurements by the names of their curves, each as ``read_measured`` takes it."""


def taken_apart(measured: Any) -> Curves | Columns:
    """Return the curves of a measurement by their names, or the columns of one alone; StoreError where it has none."""
    if hasattr(measured, "data_vars") and "curve" in measured.dims:
        found = [(str(name), _unpadded(measured.isel(curve=i))) for i, name in enumerate(measured["curve"].values)]
    elif isinstance(measured, Mapping) and not hasattr(measured, "data_vars"):
        found = [(str(name), each) for name, each in measured.items()]
        given = [each for _, each in found if not isinstance(each, Columns)]
        if any(isinstance(each, list | tuple) or getattr(each, "ndim", 0) == 1 for each in given):
            raise StoreError(
                "measured is a dict of columns; give a DataFrame of them: a dict has curves by their names"
            )
    elif isinstance(measured, list | tuple):
        found = [(str(each if isinstance(each, str | os.PathLike) else i), each) for i, each in enumerate(measured)]
    else:
        columns = read_columns(measured)
        if "curve" not in columns.names:
            return columns
        found = _split(columns)
    twice = [short_repr(name) for name, count in Counter(name for name, _ in found).items() if count > 1]
    if twice or not found:
        told = f"curve {twice[0]} is given twice" if twice else "has no curve"
        raise StoreError(f"measured: {told}; it needs at least one, each with a name of its own")
    return dict(found)


def _split(columns: Columns) -> list[tuple[str, Columns]]:
    """Return the rows of each curve that the column ``curve`` names."""
    at, rows = columns.names.index("curve"), dict[str, Rows]()
    kept = [i for i in range(len(columns.names)) if i != at]
    rest = columns._replace(names=[columns.names[i] for i in kept], units=[columns.units[i] for i in kept])
    for place, row in columns.rows:
        if (name := str(row[at])).strip() in _NAMELESS:
            raise StoreError(f"{columns.origin}: {place}: curve = {short_repr(row[at])}: names no curve")
        rows.setdefault(name, []).append((place, [row[i] for i in kept]))
    return [(name, rest._replace(rows=each)) for name, each in rows.items()]


def _unpadded(dataset: Any) -> Any:
    """Return a curve of a Dataset without the points before and behind it that have no number."""
    arrays = [array for name, array in dataset.variables.items() if name in MEASURED and array.ndim == 1]
    if len({array.dims for array in arrays}) != 1:
        return dataset  # which is refused as it is read
    known = np.flatnonzero(np.all([np.isfinite(array.values) for array in arrays], axis=0))
    return dataset.isel({dim: slice(known[0], known[-1] + 1) for dim in arrays[0].dims}) if known.size else dataset


def first_of(curves: Curves, parameters: int) -> MeasuredCurve:
    """Return the first curve that can be read; the error of the first one where none can."""
    for measured in curves.values():
        with suppress(RoughmdrError):
            return read_measured(measured, parameters)
    return read_measured(next(iter(curves.values())), parameters)


def fit_each(curves: Curves, first: Model, command: str, *, shared: list[str], workers: int, quiet: bool) -> Labelled:
    """Return the fits of all curves, the same for any number of workers.

    A curve that fails is marked; OutOfRange where all fail.
    """
    failures = dict[int, str]()

    def over(function: Callable[[Any], Any], items: dict[int, Any]) -> dict[int, Any]:
        """Return what the function makes of the items, less those that fail."""
        places, done = list(items), dict[int, Any]()
        processes = min(workers, -(-len(items) // _EACH))
        for i, made in over_processes(partial(_tried, function), list(items.values()), processes):
            (failures if isinstance(made, str) else done)[places[i]] = made
            display.add(done=display.done < len(curves))
        return {i: done[i] for i in places if i in done}

    with progress("fit", quiet=quiet, kind="curves") as display:
        display.add(total=len(curves))
        measured = dict(enumerate(curves.values()))
        if shared:
            found = over(partial(_read_and_searched, first), measured)
            alone = over(_covariance, found)
            found = {i: found[i] for i in alone}
            found = agree(found, alone, shared, partial(over, fitted), list(curves)) if alone else {}
            fits = over(partial(assembled, command), found)
        else:
            fits = over(partial(_fitted_alone, first, command), measured)
    return _together(list(curves), fits, failures, shared, first.start.toml)


def _read_and_searched(first: Model, measured: Any) -> Fitted:
    """Return the parameters of a measurement that is like the first one; RoughmdrError where there are none."""
    curve = read_measured(measured, len(first.parameters))
    if (curve.control, curve.quantity) != (first.curve.control, first.curve.quantity):
        raise StoreError(f"{curve.origin}: must have {first.curve.control} and {first.curve.quantity}, as the first")
    return fitted(first.along(curve))


def _fitted_alone(first: Model, command: str, measured: Any) -> Labelled:
    """Return the result of a measurement that is like the first one; RoughmdrError where there is none."""
    return assembled(command, _read_and_searched(first, measured))


def _covariance(fit: Fitted) -> Floats:
    return uncertainty(fit.model, fit.found, fit.model.law(fit.found.x)).covariance


def _tried(function: Callable[[Any], Any], item: Any) -> Any:
    """Return what the function makes of an item, or why it fails."""
    try:
        return function(item)
    except RoughmdrError as error:
        return str(error)
    except Exception as error:  # whatever it is, the other curves go on
        return f"{type(error).__name__}: {error}"


def _together(
    names: list[str], done: dict[int, Labelled], failed: dict[int, str], shared: list[str], scene: str
) -> Labelled:
    """Return fits over the dimension ``curve``, padded with NaN; OutOfRange where there is none."""
    if not done:
        raise OutOfRange(f"no curve can be fitted; {names[0]}: {failed[0]}")
    failures = [failed.get(i, "") for i in range(len(names))]
    remarks = [done[i].attrs.get("warnings", "") if i in done else "" for i in range(len(names))]
    points = max(fit.sizes["point"] for fit in done.values())

    def stacked(name: str, like: Array) -> Array:
        text = like.values.dtype.kind in "OU"
        shape = (points if dim == "point" else like.values.shape[axis] for axis, dim in enumerate(like.dims))
        values = np.full((len(names), *shape), "" if text else np.nan, object if text else float)
        for i, fit in done.items():
            if array := (fit.variables | fit.coordinates).get(name):
                values[i, ...][tuple(map(slice, array.values.shape))] = array.values
        return Array(("curve", *like.dims), values, like.attrs)

    def texts(each: list[str], about: str) -> Array:
        return Array(("curve",), np.array(each, dtype=object), {"long_name": about})

    first, *_ = done.values()
    once = [f"{plain_name(key)}{end}" for key in shared for end in ("", "_standard_error", "_low", "_high")]
    variables = {name: array for fit in done.values() for name, array in fit.variables.items()}
    if shared:  # how errors of all laws together shift them is not found
        variables = {name: array for name, array in variables.items() if not name.endswith("_model_error")}
    coordinates = {name: like if name in _OF_ALL else stacked(name, like) for name, like in first.coordinates.items()}
    coordinates |= {
        "curve": texts(names, "curve that was measured"),
        "failure": texts(failures, "why a curve could not be fitted; empty where it was"),
        "remark": texts(remarks, "doubts about the fit of a curve"),
    }
    counts = (len(names) - len(done), "failed: failure says why"), (sum(map(bool, remarks)), "raise doubts: see remark")
    said = [f"{count} of {len(names)} curves {text}" for count, text in counts if count]
    usual = {name: _usual([fit.attrs[name] for fit in done.values()]) for name in ("measured", "intervals", "trust")}
    attrs = {**first.attrs, **usual, "scene": scene, "warnings": "\n".join(said)}
    over = {name: first.variables[name] if name in once else stacked(name, like) for name, like in variables.items()}
    result = Labelled(over, coordinates, attrs)
    return result._replace(attrs={**attrs, "checksum": result.checksum()})


def _usual(texts: list[str]) -> str:
    """Return the text of most curves, and of how many where it is not that of all."""
    ((text, count),) = Counter(texts).most_common(1)
    return text if count == len(texts) else f"{text} (in {count} of {len(texts)} curves)"

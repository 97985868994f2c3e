"""Reading the file of a fit, which anyone may have changed."""

import os
import warnings
from collections.abc import Iterator
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from roughmdr.errors import RoughmdrError, StoreError, level_outside
from roughmdr.fitting.words import COMPARED, curve_names, is_open, load_of
from roughmdr.storage.labelled import Array, Labelled, is_text
from roughmdr.storage.reading import read_arrays
from roughmdr.storage.result_file import FIT, is_fit
from roughmdr.storage.result_form import Form, attribute_faults, refuse, with_units
from roughmdr.storage.result_scene import scene_faults
from roughmdr.variables import BRANCHES, FIT_ATTRIBUTES, MEASURED, plain_name

if TYPE_CHECKING:
    import xarray as xr

_ENDS = ("", "_standard_error", "_low", "_high")
_CONTROLS = ("remote", "separation")
_OF_MANY = {name: Form(("curve",), "text", "") for name in ("curve", "failure", "remark")}
_OF_MANY |= {"branch": Form(("curve", "point"), "text", "")}


def read_fit(path: Path) -> Labelled:
    """Return the file of a fit; StoreError if it is none, or not as ``fit`` writes it."""
    try:
        data = read_arrays(path)
    except RoughmdrError as error:
        raise StoreError(f"{path}: {error}") from None
    if data.attrs.get("kind") != FIT:
        raise StoreError(f"{path}: holds no fit")
    return as_fit(data, path)


def given_fit(fit: "str | Path | xr.Dataset") -> Labelled | None:
    """Return a fit that is given by its file or as a Dataset; None where it is none, StoreError where it is broken.

    A UserWarning tells the caller of a public function where the numbers in a file cannot be trusted.
    """
    if isinstance(fit, str | os.PathLike):
        if not is_fit(Path(fit)):
            return None
        data = read_fit(Path(fit))
        if fault := data.integrity_fault():
            warnings.warn(f"{fit}: {fault}", UserWarning, stacklevel=level_outside())
        return data
    if getattr(fit, "attrs", {}).get("kind") != FIT:
        return None
    return as_fit(Labelled.of(fit))


def as_fit(data: Labelled, file: Path | None = None) -> Labelled:
    """Return arrays, of a file or not, as a fit, with the declared units where they have none; StoreError if they are
    none.
    """
    faults = (fault for each in _one_by_one(data) for check in (_arrays, _values) for fault in check(each))
    refuse(chain(_attributes(data), faults), "fit", "fit", file)
    return with_units(data, _forms(data))


def _attributes(data: Labelled) -> Iterator[str]:
    yield from attribute_faults(data.attrs, FIT_ATTRIBUTES)
    yield from scene_faults(data.attrs["scene"])
    if "curve" not in data.sizes:
        return
    for name, form in _OF_MANY.items():
        array = data.coordinates.get(name)
        yield from [f"it has no {name}"] if array is None else form.mismatches(name, array)
    if "" not in data.coordinates["failure"].values:
        yield "none of its curves could be fitted"


def _one_by_one(data: Labelled) -> Iterator[Labelled]:
    """Yield the fit of each curve that was fitted, without the padding of its points; a fit of one as it is."""
    if not curve_names(data):
        yield data
        return
    for i in np.flatnonzero(data.coordinates["failure"].values == ""):
        points = int(np.count_nonzero(data.coordinates["branch"].values[i] != ""))
        yield Labelled(_of_curve(data.variables, i, points), _of_curve(data.coordinates, i, points), data.attrs)


def _of_curve(arrays: dict[str, Array], curve: np.intp, points: int) -> dict[str, Array]:
    """Return arrays of one curve, whose points end where it does."""
    found = dict(arrays)
    for name, (dims, values, attrs) in arrays.items():
        if dims[:1] == ("curve",):
            one = np.asarray(values[curve])
            found[name] = Array(dims[1:], one[:points] if dims[1:] == ("point",) else one, attrs)
    return found


def _arrays(data: Labelled) -> Iterator[str]:
    """Find arrays that are missing, or of the wrong type, unit or dimensions."""
    required = _forms(data, required=True)
    for name, form in _forms(data).items():
        coordinate = form.kind == "text" or name in _CONTROLS
        holder = data.coordinates if coordinate else data.variables
        if name in holder:
            yield from form.mismatches(name, holder[name])
        elif name in required:
            yield f"it has no {name}"
    for key, (value, *_) in _parameters(data):
        if not is_text(data.variables[value].attrs.get("units")):
            yield f"the units of {key} are missing or no text"


def _values(data: Labelled) -> Iterator[str]:
    """Find values that no fit has: not finite, or outside their own interval."""
    ends = {name for _, names in _parameters(data) for name in names[1:]}  # infinite where nothing is determined
    ends |= {*COMPARED}  # infinite where there is no fit, and for JKR
    for name, form in _forms(data).items():
        array = (data.variables | data.coordinates).get(name)
        if array is not None and form.kind == "f" and name not in ends and not np.isfinite(array.values).all():
            yield f"{name} is not finite"
    if not np.isin(data.coordinates["branch"].values, BRANCHES).all():
        yield f"branch must be {' or '.join(BRANCHES)}"
    for key, names in _parameters(data):
        value, error, low, high = (float(data.variables[name].values) for name in names)
        if not low <= value <= high:
            yield f"{key} is {value:g}, outside its own interval, {low:g} to {high:g}"
        if not error >= 0.0:
            yield f"the standard error of {key} is {error:g}; it must be at least 0"
        if not (np.isfinite([low, high]).all() or is_open(data, names[0])):
            yield f"the interval of {key}, {low:g} to {high:g}, is not finite, and its standard error is {error:g}"


def _parameters(data: Labelled) -> Iterator[tuple[str, tuple[str, ...]]]:
    """Yield the key of each parameter and the names of its value, standard error and ends of its interval."""
    names = data.coordinates["parameter_name"].values if "parameter_name" in data.coordinates else ()
    for key in np.ravel(names):
        yield str(key), tuple(f"{plain_name(str(key))}{end}" for end in _ENDS)


def _forms(data: Labelled, *, required: bool = False) -> dict[str, Form]:
    """Return the forms of the arrays that a fit can have, or of those alone that it must have, by their names."""
    control = next((name for name in _CONTROLS if name in data.coordinates), "separation")
    load, point = load_of(data), ("point",)
    forms = {control: Form(point, "f", MEASURED[control]), "branch": Form(point, "text", "")}
    forms |= {name: Form(point, "f", MEASURED[load]) for name in (load, f"{load}_fitted", "residual")}
    forms |= {"parameter_name": Form(("parameter",), "text", ""), "parameter_scale": Form(("parameter",), "f", "")}
    forms |= {name: Form((), "f", "1") for name in ("residual_rms", "evaluation_count")}
    forms |= {name: Form((), "f", "") for _, names in _parameters(data) for name in names}
    forms |= {"run_time": Form((), "f", "s")}
    if required:
        return forms
    forms |= {f"{name}_model_error": Form((), "f", "") for _, (name, *_) in _parameters(data)}
    forms |= {f"{name}_posterior": Form(("chain", "draw"), "f", "") for _, (name, *_) in _parameters(data)}
    forms |= {name: Form(("model",), "f", "1") for name in COMPARED}
    forms |= {name: Form(("model",), "text", "") for name in ("model_name", "model_failure")}
    return forms | {"spring_constant": Form((), "f", "N m-1"), f"{load}_error": Form(point, "f", MEASURED[load])}

"""The error of the model in each variable of a result, in its own unit, where a quantity is given or along the path.

``model_error/at_given.py`` has the errors themselves.
"""

from collections.abc import Collection, Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from roughmdr.model_error.at_given import ALWAYS, FORCES, NUMBERS, STATED, errors_at, first_of, largest_at_force
from roughmdr.model_error.parts import PLASTIC, PLASTIC_AT_FORCE
from roughmdr.numerics.arguments import Floats
from roughmdr.result.curves import Read, apply
from roughmdr.result.view import Leg, ResultView, parts_of
from roughmdr.storage.labelled import Array
from roughmdr.variables import LATERAL, LAW_VARIABLES, MODEL_ERROR, ORIGINS, SEPARATION, WITH_MODEL_ERROR

if TYPE_CHECKING:
    import xarray as xr

_H = SEPARATION.name
LOADS = "lowest_so_far"
"""Name of ``lowest_so_far`` among curves that are read."""


def attributes(name: str, given: str) -> dict[str, str]:
    """Return the attributes of the error of a variable where a quantity is ``given``."""
    words, where = (each.replace("_", " ") for each in (name, given))
    about = f"estimated error of the {words} at given {where} by the assumptions of the model"
    return {"units": LAW_VARIABLES[name].units, "long_name": about}


def known_in(result: ResultView, curves: Collection[str], needed: Collection[str] = ALWAYS) -> list[str]:
    """Return the names of ``curves`` whose error is known: under a flat, with a force, not on a lateral path, and not
    where contacts yield and adhere.
    """
    told = PLASTIC not in result.variables or result.known(PLASTIC_AT_FORCE[0]).size > 0
    told = told and set(result.variables) >= {*needed} and result.flat and result.control != LATERAL.name
    bare = {_bare(name): name for name in curves if _bare(name) in WITH_MODEL_ERROR}
    return list(bare.values()) if told and not set(FORCES).isdisjoint(bare) and _H in bare else []


def errors_there(
    result: ResultView,
    given: str,
    curves: "Mapping[str, xr.DataArray]",
    read: Mapping[str, Read],
) -> "dict[str, xr.DataArray]":
    """Return the errors of curves that are ``read`` where a quantity is ``given``."""
    labels = known_in(result, curves)
    if not labels:
        return {}
    dataset, names = result.dataset, [_bare(label) for label in labels]
    unknown = np.nan * read[names[0]].value
    force = curves[labels[names.index(first_of(FORCES, names))]]
    largest, tension = abs(force).max("step"), (-force).max("step").clip(0.0)

    def number(name: str) -> "xr.DataArray":
        found = dataset.get(name, np.nan * dataset["interaction_error"])
        return found.where(read[LOADS].value == 1.0) if name in PLASTIC_AT_FORCE and LOADS in read else found

    numbers = [
        *(read[name].value if name in read else unknown for name in ("contact_fraction", STATED)),
        *(largest, tension),
        *(read[name].value for name in names),
        *(read[name].rise for name in names),
        *map(number, NUMBERS),
    ]
    errors = apply(errors_at, *numbers, core=[[]] * len(numbers), out=[[]] * len(labels), names=names, given=given)
    return {
        label: error.assign_attrs(attributes(name, given))
        for label, name, error in zip(labels, names, errors, strict=True)
        if name != given
    }


def errors_along(result: ResultView) -> dict[str, Array]:
    """Return the errors of variables along a path, by their names: of a machine or to a preload at given separation.

    None where errors are not known.
    """
    given, suffix = result.control, "_mean" if result.keeps_statistics else ""
    held = {**result.coordinates, **result.variables}
    needed = ("interaction_error",) if result.holds(STATED) and given not in FORCES else ALWAYS
    labels = known_in(result, [name for name in held if "step" in held[name].dims], needed)
    if not labels:
        return {}
    dims = (*result.variables["interaction_error"].dims, "step")

    def values(name: str) -> Floats:
        found = held.get(name, held.get(f"{name}{suffix}"))
        return np.full((1,) * len(dims), np.nan) if found is None else _spread(found, dims)

    names = [_bare(label) for label in labels]
    fraction = values("contact_fraction")
    if np.isnan(fraction).all():
        fraction = values("contact_area") / values("nominal_area")
    curves = [values(name) for name in names]
    force = curves[names.index(first_of(FORCES, names))]
    largest, tension = (np.fmax.reduce(each, axis=-1, keepdims=True, initial=0.0) for each in (np.abs(force), -force))
    known = np.where(np.isnan(curves[names.index(_H)]), np.nan, 1.0)  # both of a step, so that changes go together
    changes = [_changes(known * each, result.legs) for each in curves]
    h = curves[names.index(_H)]
    lower = np.where(_lowest_so_far(h), 1.0, np.nan)
    numbers = [values(name) * (lower if name in PLASTIC_AT_FORCE else 1.0) for name in NUMBERS]
    if "asperity_origin" not in held:  # in earlier versions the overlap of coupled hills alone is not known
        of_hills = np.isnan(values("overlap_fraction"))
        numbers[NUMBERS.index("asperity_origin")] = np.where(of_hills, ORIGINS.index("hills"), np.nan)
    errors = errors_at(
        fraction, values(STATED), largest, tension, *curves, *changes, *numbers, names=names, given=given
    )
    return {
        f"{label}{MODEL_ERROR}": Array(dims, np.array(error), attributes(name, given))
        for label, name, error in zip(labels, names, errors, strict=True)
        if name != given
    }


def lowest_so_far(separation: "xr.DataArray") -> "xr.DataArray":
    """Return 1 at the steps where the flat is lower than ever before, 0 at others."""
    return apply(_lowest_so_far, separation, core=[["step"]], out=[["step"]])[0]


def _lowest_so_far(separation: Floats) -> Floats:
    before = np.fmin.accumulate(np.insert(separation, 0, np.inf, axis=-1), axis=-1)[..., :-1]
    return (separation < before).astype(np.float64)


def largest_of_result(result: ResultView, cell: tuple[int, ...] = ()) -> dict[str, float]:
    """Return ``largest_at_force`` of all runs of a result, or of a cell; nothing under a body that is no flat."""
    names = [name for name in NUMBERS if name in result.variables] if result.flat else []
    return largest_at_force({name: result.variables[name].values[cell] for name in names})


def error_of_mean(result: ResultView, name: str) -> Floats:
    """Return the mean over the realisations of the errors of a variable along the path, as its mean; NaN where unknown.

    A load that some realisations do not bear, or an error that is not known, does not count.
    """
    suffix = "_mean" if result.keeps_statistics else ""
    total, count = np.zeros((2, *result.sweep.values(), result.sizes["step"]))
    for part in parts_of(result, 0.125):  # errors take some 8 times the curves
        error = errors_along(part).get(f"{name}{suffix}{MODEL_ERROR}")
        if error is not None:
            if "realization" not in error.dims:
                return error.values
            runs = np.moveaxis(error.values, error.dims.index("realization"), 0)
            known = np.isfinite(runs)
            numbers = np.where(known, runs, 0.0)
            numbers[0] += total
            total, count = numbers.sum(axis=0), count + known.sum(axis=0)
    return np.asarray(np.divide(total, count, out=np.full(total.shape, np.nan), where=count > 0))


def _bare(label: str) -> str:
    """Return the name of a variable without that of the statistic."""
    return label.removesuffix("_mean")


def _spread(array: Array, dims: Sequence[str]) -> Floats:
    """Return the values of an array over dimensions, of length 1 where it does not have them."""
    own = [dim for dim in dims if dim in array.dims]
    values = np.asarray(array.values, dtype=np.float64).transpose([array.dims.index(dim) for dim in own])
    sizes = dict(zip(own, values.shape, strict=True))
    return values.reshape([sizes.get(dim, 1) for dim in dims])


def _changes(curve: Floats, legs: Sequence[Leg]) -> Floats:
    """Return the change of a curve over the two steps around each of a leg, or over the one that is known: [..., step].

    NaN where neither is.
    """
    found = np.full(curve.shape, np.nan)
    for leg in legs:
        step = np.diff(curve[..., leg.steps], axis=-1)
        none = np.full((*curve.shape[:-1], 1), np.nan)
        before, after = (np.concatenate(parts, axis=-1) for parts in ((none, step), (step, none)))
        both = before + after
        found[..., leg.steps] = np.where(np.isnan(both), np.fmax(before, after), both)
    return found

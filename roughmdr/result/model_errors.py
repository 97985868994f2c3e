"""The error of the model in each variable of a result, in its own unit, where a quantity is given.

At given force each variable X has an error of its own, and the separation that of the force at given separation over
the slope of the law. Where another quantity C is given, X is off by its change with C times the error of C besides.
"""

from collections.abc import Collection, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from roughmdr.model_error.at_force import NAMES, QUANTITIES, interaction_along, relative_at_force
from roughmdr.model_error.parts import PARTS
from roughmdr.numerics.arguments import Floats
from roughmdr.result.curves import Read
from roughmdr.result.view import Leg, ResultView
from roughmdr.storage.labelled import Array
from roughmdr.variables import LATERAL, LAW_VARIABLES, MODEL_ERROR, ORIGINS, SEPARATION, WITH_MODEL_ERROR

if TYPE_CHECKING:
    import xarray as xr

FORCES = ("force", "pressure")
"""Variables that tell the force; the first one that a result has counts."""
_AREAS = ("contact_fraction", "contact_area")
_H = SEPARATION.name
_STATED, _BY_JKR = "model_error_curve", "adhesion_range_error"
_ALWAYS = (*PARTS, "largest_contact_fraction", "asperity_origin")
_NUMBERS = (*_ALWAYS, "grid_points", "avalanche_count")
"""Numbers of a run that its errors follow from; those beside ``_ALWAYS`` are known of coupled contacts alone."""
_MOST = 0.9
"""Largest relative error that a value is corrected for: of a value that is too small by more nothing is left."""


def errors_at(*arrays: Floats, names: Sequence[str], given: str) -> tuple[Floats, ...]:
    """Return the error of each of the ``names`` where a quantity is ``given``: arrays that go together, [...].

    Arrays are contact fraction and model_error_curve, NaN where they are not known, the largest magnitude and the
    largest tension of the force on the path, the variables and how much each changes over a step there, and the numbers
    of the run. The separation has none on a plateau of the force.
    """
    fraction, stated, largest, tension = arrays[:4]
    count = len(names)
    values = dict(zip(names, arrays[4 : 4 + count], strict=True))
    changes = dict(zip(names, arrays[4 + count : 4 + 2 * count], strict=True))
    numbers = dict(zip(_NUMBERS, arrays[4 + 2 * count :], strict=True))
    force = _first(FORCES, names)
    of_itself, over_largest, at_force = _relative_errors(values[force], fraction, stated, numbers)
    # Contacts that push and pull leave little of their errors in the sum: they are at least of the tension.
    of_force = np.maximum(np.abs(values[force]), tension) * _of_value(of_itself) + largest * over_largest
    by_stiffness = force == "force" and "stiffness" in values  # the slope of the law itself, also at a single load

    def at_given_force(name: str) -> Floats:
        if name == _H and by_stiffness:
            return _per_change(of_force, values["stiffness"])
        if name == _H:
            return _per_change(of_force, changes[force]) * np.abs(changes[_H])
        return np.abs(values[name]) * _of_value(at_force[QUANTITIES[name]])

    kept = next((_first(alike, names) for alike in (FORCES, _AREAS) if given in alike), _H)

    def error(name: str) -> Floats:
        if kept in FORCES:
            return 0.0 * of_force if name in FORCES else at_given_force(name)
        moved = np.abs(changes[name]) * _per_change(at_given_force(kept), changes[kept])
        if name not in FORCES:
            return at_given_force(name) + moved
        if kept != _H:
            return moved
        return of_force if name == force else of_force * _per_change(np.abs(values[name]), values[force])

    return tuple(np.broadcast_arrays(*(error(name) for name in names)))


def _relative_errors(
    force: Floats, fraction: Floats, stated: Floats, numbers: Mapping[str, Floats]
) -> tuple[Floats, Floats, list[Floats]]:
    """Return the error of the force at given separation, its part over the largest force, and errors [1] of quantities
    at given force.
    """
    touching, origin, grid = force != 0.0, numbers["asperity_origin"], numbers["grid_points"]
    interaction, by_jkr, most = (numbers[name] for name in ("interaction_error", _BY_JKR, "largest_contact_fraction"))
    others = np.add.reduce([numbers[name] for name in PARTS if name not in ("interaction_error", _BY_JKR)])
    fraction = np.where(np.isnan(fraction), np.where(touching, most, 0.0), fraction)
    foreseen = interaction_along(interaction, fraction, most, origin, grid)
    foreseen += np.where(touching, others + by_jkr, 0.0)
    whole = np.where(np.isnan(stated), np.minimum(foreseen, 1.0), stated)
    of_jkr = np.minimum(whole, by_jkr)
    own = np.maximum(whole - of_jkr - np.where(touching, others, 0.0), 0.0) * (interaction != 0.0)
    sticky_hills = (origin == ORIGINS.index("hills")) & np.isfinite(numbers["avalanche_count"])
    over_largest = np.where(sticky_hills, whole, of_jkr)  # which hills attraction with a range makes sooner
    return whole - over_largest, over_largest, relative_at_force(own, fraction, others + by_jkr, origin, grid)


def attributes(name: str, given: str) -> dict[str, str]:
    """Return the attributes of the error of a variable where a quantity is ``given``."""
    words, where = (each.replace("_", " ") for each in (name, given))
    about = f"estimated error of the {words} at given {where} by the assumptions of the model"
    return {"units": LAW_VARIABLES[name].units, "long_name": about}


def known_in(result: ResultView, curves: Collection[str], needed: Collection[str] = _ALWAYS) -> list[str]:
    """Return the names of ``curves`` whose error is known: none under a body, on a lateral path, without a force."""
    told = set(result.variables) >= {*needed} and result.flat and result.control != LATERAL.name
    bare = {_bare(name): name for name in curves if _bare(name) in WITH_MODEL_ERROR}
    return list(bare.values()) if told and not set(FORCES).isdisjoint(bare) and _H in bare else []


def errors_there(
    result: ResultView,
    given: str,
    curves: "Mapping[str, xr.DataArray]",
    read: Mapping[str, Read],
) -> "dict[str, xr.DataArray]":
    """Return the errors of curves that are ``read`` where a quantity is ``given``."""
    import xarray as xr

    labels = known_in(result, curves)
    if not labels:
        return {}
    dataset, names = result.dataset, [_bare(label) for label in labels]
    unknown = np.nan * read[names[0]].value
    force = curves[labels[names.index(_first(FORCES, names))]]
    largest, tension = abs(force).max("step"), (-force).max("step").clip(0.0)
    numbers = (dataset.get(name, np.nan * dataset["interaction_error"]) for name in _NUMBERS)
    errors = xr.apply_ufunc(
        errors_at,
        *(read[name].value if name in read else unknown for name in ("contact_fraction", _STATED)),
        largest,
        tension,
        *(read[name].value for name in names),
        *(read[name].rise for name in names),
        *numbers,
        kwargs={"names": names, "given": given},
        output_core_dims=[[]] * len(labels),
        keep_attrs=False,
        dask="parallelized",
        output_dtypes=[np.float64] * len(labels),
    )
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
    needed = ("interaction_error",) if result.holds(_STATED) and given not in FORCES else _ALWAYS
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
    force = curves[names.index(_first(FORCES, names))]
    largest, tension = (np.fmax.reduce(each, axis=-1, keepdims=True, initial=0.0) for each in (np.abs(force), -force))
    known = np.where(np.isnan(curves[names.index(_H)]), np.nan, 1.0)  # both of a step, so that changes go together
    changes = [_changes(known * each, result.legs) for each in curves]
    numbers = [values(name) for name in _NUMBERS]
    if "asperity_origin" not in held:  # in earlier versions the overlap of coupled hills alone is not known
        of_hills = np.isnan(values("overlap_fraction"))
        numbers[_NUMBERS.index("asperity_origin")] = np.where(of_hills, ORIGINS.index("hills"), np.nan)
    errors = errors_at(
        fraction, values(_STATED), largest, tension, *curves, *changes, *numbers, names=names, given=given
    )
    return {
        f"{label}{MODEL_ERROR}": Array(dims, np.array(error), attributes(name, given))
        for label, name, error in zip(labels, names, errors, strict=True)
        if name != given
    }


def largest_at_force(numbers: Mapping[str, Any]) -> dict[str, float]:
    """Return the largest relative errors of quantities at given force [1], by their names: NaN where not known.

    ``numbers`` are those of one run or arrays over runs, by name; nothing is told without all that errors follow from.
    """
    if not numbers.keys() >= {*_ALWAYS}:
        return {}
    of = {name: np.asarray(numbers.get(name, np.nan), dtype=np.float64)[..., None] for name in _NUMBERS}
    others = np.add.reduce([of[name] for name in PARTS if name != "interaction_error"])
    known = (of[name] for name in ("asperity_origin", "grid_points"))
    found = relative_at_force(of["interaction_error"], of["largest_contact_fraction"], others, *known)
    return {name: float(np.fmax.reduce(each, axis=None)) for name, each in zip(NAMES, found, strict=True)}


def largest_of_result(result: ResultView, cell: tuple[int, ...] = ()) -> dict[str, float]:
    """Return ``largest_at_force`` of all runs of a result, or of a cell; nothing under a body that is no flat."""
    names = [name for name in _NUMBERS if name in result.variables] if result.flat else []
    return largest_at_force({name: result.variables[name].values[cell] for name in names})


def error_of_mean(result: ResultView, name: str) -> Floats:
    """Return the mean over the realisations of the errors of a variable along the path, as its mean; NaN where unknown.

    A load that some realisations do not bear, or an error that is not known, does not count.
    """
    suffix = "_mean" if result.keeps_statistics else ""
    error = errors_along(result).get(f"{name}{suffix}{MODEL_ERROR}")
    if error is None:
        return np.full((*result.sweep.values(), result.sizes["step"]), np.nan)
    if "realization" not in error.dims:
        return error.values
    known = np.isfinite(error.values)
    axis, count = error.dims.index("realization"), known.sum(axis=error.dims.index("realization"))
    total = np.where(known, error.values, 0.0).sum(axis=axis)
    return np.asarray(np.divide(total, count, out=np.full(total.shape, np.nan), where=count > 0))


def _bare(label: str) -> str:
    """Return the name of a variable without that of the statistic."""
    return label.removesuffix("_mean")


def _first(names: Sequence[str], among: Collection[str]) -> str:
    return next(name for name in names if name in among)


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


def _of_value(error: Floats) -> Floats:
    """Return a relative error, which is over the true value, over a value that is too small by it."""
    return np.asarray(error / (1.0 - np.minimum(error, _MOST)))


def _per_change(error: Floats, change: Floats) -> Floats:
    """Return an error over the magnitude of a change; 0 where the error is, NaN on a plateau."""
    error, size = np.broadcast_arrays(error, np.abs(change))
    known = (size > 0.0) & (error != 0.0)
    return np.asarray(np.divide(error, size, out=np.where(error == 0.0, 0.0, np.nan), where=known))

"""The error of the model in each variable of a result, in its own unit, where a quantity is given.

At given force each variable X has an error of its own, and the separation that of the force at given separation over
the slope of the law. Where another quantity C is given, X is off by its change with C times the error of C besides.
"""

from collections.abc import Collection, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from roughmdr.model_error.at_force import QUANTITIES, interaction_along, relative_at_force
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
_NUMBERS = (*PARTS, "largest_contact_fraction", "asperity_origin", "grid_points")
_MOST = 0.9
"""Largest relative error that a value is corrected for: of a value that is too small by more nothing is left."""


def errors_at(*arrays: Floats, names: Sequence[str], given: str, adheres: bool) -> tuple[Floats, ...]:
    """Return the error of each of the ``names`` where a quantity is ``given``: arrays that go together, [...].

    Arrays are contact fraction and model_error_curve, NaN where they are not known, the largest force of the path, the
    variables and how much each changes over a step there, and the numbers of the run.
    """
    fraction, stated, largest = arrays[:3]
    count = len(names)
    values = dict(zip(names, arrays[3 : 3 + count], strict=True))
    changes = dict(zip(names, arrays[3 + count : 3 + 2 * count], strict=True))
    numbers = dict(zip(_NUMBERS, arrays[3 + 2 * count :], strict=True))
    force = _first(FORCES, names)
    whole, over_largest, at_force = _relative_errors(values[force], fraction, stated, numbers, adheres)
    of_force = np.abs(values[force]) * _over_value(whole - over_largest) + largest * over_largest
    shift = _over(of_force, changes[force])

    def at_given_force(name: str) -> Floats:
        if name == _H:
            return shift * np.abs(changes[_H])
        return np.abs(values[name]) * _over_value(at_force[QUANTITIES[name]])

    kept = next((_first(alike, names) for alike in (FORCES, _AREAS) if given in alike), _H)
    moved = 0.0 * shift if kept in FORCES else _over(at_given_force(kept), changes[kept])

    def error(name: str) -> Floats:
        if name not in FORCES:
            return at_given_force(name) + np.abs(changes[name]) * moved
        return of_force * _over(np.abs(changes[name]), changes[force]) if kept == _H else np.abs(changes[name]) * moved

    return tuple(np.broadcast_arrays(*(error(name) for name in names)))


def _relative_errors(
    force: Floats, fraction: Floats, stated: Floats, numbers: Mapping[str, Floats], adheres: bool
) -> tuple[Floats, Floats, list[Floats]]:
    """Return the error of the force at given separation, its part over the largest force, and errors [1] of quantities
    at given force.
    """
    touching, origin, coupled = force != 0.0, numbers["asperity_origin"], np.isfinite(numbers["grid_points"])
    interaction, by_jkr, most = (numbers[name] for name in ("interaction_error", _BY_JKR, "largest_contact_fraction"))
    others = np.add.reduce([numbers[name] for name in PARTS if name not in ("interaction_error", _BY_JKR)])
    fraction = np.where(np.isnan(fraction), np.where(touching, most, 0.0), fraction)
    foreseen = interaction_along(interaction, fraction, most, origin, coupled)
    foreseen += np.where(touching, others + by_jkr, 0.0)
    whole = np.where(np.isnan(stated), np.minimum(foreseen, 1.0), stated)
    sticky_hills = adheres & (origin == ORIGINS.index("hills"))
    over_largest = np.where(sticky_hills, whole, np.minimum(whole, by_jkr))
    own = np.maximum(whole - over_largest - np.where(touching, others, 0.0), 0.0)
    at_force = relative_at_force(own, fraction, others + by_jkr, origin, coupled)
    return whole, over_largest, [np.where(sticky_hills, np.fmax(each, whole), each) for each in at_force]


def attributes(name: str, given: str) -> dict[str, str]:
    """Return the attributes of the error of a variable where a quantity is ``given``."""
    words, where = (each.replace("_", " ") for each in (name, given))
    about = f"estimated error of the {words} at given {where} by the assumptions of the model"
    return {"units": LAW_VARIABLES[name].units, "long_name": about}


def known_in(result: ResultView, curves: Collection[str]) -> list[str]:
    """Return the names of ``curves`` whose error is known: none under a body, on a lateral path, without a force."""
    told = set(result.variables) >= {*_NUMBERS[:-1]} and result.flat and result.control != LATERAL.name
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
    largest = abs(curves[labels[names.index(_first(FORCES, names))]]).max("step")
    numbers = (dataset.get(name, np.nan * dataset["interaction_error"]) for name in _NUMBERS)
    errors = xr.apply_ufunc(
        errors_at,
        *(read[name].value if name in read else unknown for name in ("contact_fraction", _STATED)),
        largest,
        *(read[name].value for name in names),
        *(read[name].rise for name in names),
        *numbers,
        kwargs={"names": names, "given": given, "adheres": adheres(result)},
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
    """Return the errors of variables along a path of given separation, force or pressure, by their names.

    None for other paths, and where errors are not known.
    """
    given, suffix = result.control, "_mean" if result.keeps_statistics else ""
    held = {**result.coordinates, **result.variables}
    labels = known_in(result, [name for name in held if "step" in held[name].dims])
    if not labels or given not in (*FORCES, _H):
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
    largest = np.fmax.reduce(np.abs(curves[names.index(_first(FORCES, names))]), axis=-1, keepdims=True)
    changes = [_changes(each, result.legs) for each in curves]
    if given in FORCES and {"force", "stiffness"} <= {*names}:  # the slope of the law itself, also at a single load
        stiffness = curves[names.index("stiffness")]
        for name, change in (("force", stiffness), (_H, np.where(np.isfinite(stiffness), 1.0, np.nan))):
            changes[names.index(name)] = change
    numbers = [values(name) for name in _NUMBERS]
    options: dict[str, Any] = {"names": names, "given": given, "adheres": adheres(result)}
    errors = errors_at(fraction, values(_STATED), largest, *curves, *changes, *numbers, **options)
    return {
        f"{label}{MODEL_ERROR}": Array(dims, np.array(error), attributes(name, given))
        for label, name, error in zip(labels, names, errors, strict=True)
        if name != given
    }


def adheres(result: ResultView) -> bool:
    """Return whether asperities adhere; of a law of one ensemble by its avalanches, which coupled ones alone have."""
    return result.adheres or "avalanche_count" in result.variables


def _bare(label: str) -> str:
    """Return the name of a variable without that of the statistic."""
    return label.removesuffix("_mean")


def _first(names: Sequence[str], among: Collection[str]) -> str:
    return next(name for name in names if name in among)


def _spread(array: Array, dims: Sequence[str]) -> Floats:
    """Return the values of an array over dimensions, of length 1 where it does not have them."""
    sizes = dict(zip(array.dims, array.values.shape, strict=True))
    return np.asarray(array.values, dtype=np.float64).reshape([sizes.get(dim, 1) for dim in dims])


def _over_value(error: Floats) -> Floats:
    """Return a relative error, which is over the true value, over a value that is too small by it."""
    return np.asarray(error / (1.0 - np.minimum(error, _MOST)))


def _changes(curve: Floats, legs: Sequence[Leg]) -> Floats:
    """Return the change of a curve over the two steps around each of a leg, or over one at its ends: [..., step]."""
    found = np.full(curve.shape, np.nan)
    for leg in legs:
        part = np.concatenate([curve[..., leg.steps[:1]], curve[..., leg.steps], curve[..., leg.steps[-1:]]], axis=-1)
        found[..., leg.steps] = part[..., 2:] - part[..., :-2]
    return found


def _over(error: Floats, change: Floats) -> Floats:
    """Return an error over the magnitude of a change; 0 where the error is, NaN on a plateau."""
    error, size = np.broadcast_arrays(error, np.abs(change))
    known = (size > 0.0) & (error != 0.0)
    return np.asarray(np.divide(error, size, out=np.where(error == 0.0, 0.0, np.nan), where=known))

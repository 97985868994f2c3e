"""The error of the model in each variable of a result, in its own unit, where a quantity is given.

At given force each variable X has an error of its own, and the separation that of the force at given separation over
the slope of the law. Where another quantity C is given, X is off by its change with C times the error of C besides.
"""

from collections.abc import Collection, Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from roughmdr.model_error.at_force import QUANTITIES, along_path, relative_at_force
from roughmdr.model_error.parts import PARTS
from roughmdr.numerics.arguments import Floats
from roughmdr.result.view import Leg, ResultView
from roughmdr.storage.labelled import Array
from roughmdr.variables import LATERAL, LAW_VARIABLES, MODEL_ERROR, ORIGINS, SEPARATION, WITH_MODEL_ERROR

if TYPE_CHECKING:
    import xarray as xr

FORCES = ("force", "pressure")
"""Variables that tell the force; the first one that a result has counts."""
_AREAS = ("contact_fraction", "contact_area")
_H = SEPARATION.name
_STATED = "model_error_curve"
_NUMBERS = (*PARTS, "largest_contact_fraction", "asperity_origin")
_GRID, _BY_JKR = "grid_points", "adhesion_range_error"
_MOST = 0.9
"""Largest relative error that a value is corrected for: of a value that is too small by more nothing is left."""
_OWN = "own"
"""Dimension of length 1 in place of the steps, of numbers of a run."""


def errors_at_force(*arrays: Floats, names: Sequence[str], legs: Sequence[Leg], adheres: bool) -> tuple[Floats, ...]:
    """Return the error of each of the ``names`` at given force, of a force that at given separation: [..., step].

    Arrays are contact fraction and model_error_curve, NaN where they are not known, and the variables, [..., step];
    then the numbers of the runs and the points of their grids, [..., 1].
    """
    fraction, stated = arrays[:2]
    curves = dict(zip(names, arrays[2:], strict=False))
    numbers = dict(zip((*_NUMBERS, _GRID), arrays[2 + len(names) :], strict=True))
    force_name = _first(FORCES, curves)
    of_force, over_largest, at_force = _relative_errors(curves[force_name], fraction, stated, numbers, adheres)

    def error(name: str) -> Floats:
        size = np.abs(curves[name])
        if name in QUANTITIES:
            return size * _over_value(at_force[QUANTITIES[name]])
        if name == _H:
            return _over(error(force_name), _changes(curves[force_name], legs)) * np.abs(_changes(curves[_H], legs))
        largest: Floats = np.fmax.reduce(size, axis=-1, keepdims=True)
        return size * _over_value(of_force) + largest * over_largest

    return tuple(error(name) for name in names)


def _relative_errors(
    force: Floats, fraction: Floats, stated: Floats, numbers: Mapping[str, Floats], adheres: bool
) -> tuple[Floats, Floats, list[Floats]]:
    """Return the error of the force at given separation over itself, the part over the largest force, and errors [1] of
    quantities at given force.
    """
    touching, origin, coupled = force != 0.0, numbers["asperity_origin"], np.isfinite(numbers[_GRID])
    interaction, by_jkr = numbers["interaction_error"], numbers[_BY_JKR]
    others = np.add.reduce([numbers[name] for name in PARTS if name not in ("interaction_error", _BY_JKR)])
    fraction = np.where(np.isnan(fraction), np.where(touching, numbers["largest_contact_fraction"], 0.0), fraction)
    foreseen = along_path(interaction, fraction, origin, coupled) + np.where(touching, others + by_jkr, 0.0)
    whole = np.where(np.isnan(stated), np.minimum(foreseen, 1.0), stated)
    sticky_hills = adheres & (origin == ORIGINS.index("hills"))
    over_largest = np.where(sticky_hills, whole, np.minimum(whole, by_jkr))
    own = np.maximum(whole - over_largest - np.where(touching, others, 0.0), 0.0)
    at_force = relative_at_force(own, fraction, others + by_jkr, origin, coupled)
    at_force = [np.where(sticky_hills, np.fmax(each, whole), each) for each in at_force]
    return whole - over_largest, over_largest, at_force


def kept_by(given: str, names: Collection[str]) -> str:
    """Return the variable, of ``names``, that is known exactly where a quantity is given; the separation for others.

    A quantity of the reference is given at a separation, and that of a path is.
    """
    alike = next((each for each in (FORCES, _AREAS) if given in each), (_H,))
    return _first(alike, names)


def at_given(error: Floats, change: Floats, kept: Floats, kept_change: Floats, *, name: str, given: str) -> Floats:
    """Return the error of a variable where a quantity is ``given``, from those of ``errors_at_force``: [...].

    ``kept`` is the error of the variable that is then known exactly, ``change`` that of both over a step.
    """
    shifted = np.abs(change) * _over(kept, kept_change)
    if name in FORCES:
        return 0.0 * error if given in FORCES else shifted if given in _AREAS else error
    return error if given in FORCES else error + shifted


def attributes(name: str, given: str) -> dict[str, str]:
    """Return the attributes of the error of a variable where a quantity is ``given``."""
    words, where = (each.replace("_", " ") for each in (name, given))
    about = f"estimated error of the {words} at given {where} by the assumptions of the model"
    return {"units": LAW_VARIABLES[name].units, "long_name": about}


def known_in(result: ResultView, curves: Collection[str]) -> list[str]:
    """Return the names of ``curves`` whose error is known: none under a body, on a lateral path, without a force."""
    told = set(result.variables) >= {*_NUMBERS} and result.flat and result.control != LATERAL.name
    bare = {name.removesuffix("_mean"): name for name in curves if name.removesuffix("_mean") in WITH_MODEL_ERROR}
    return list(bare.values()) if told and not set(FORCES).isdisjoint(bare) and _H in bare else []


def errors_over_steps(result: ResultView, curves: "Mapping[str, xr.DataArray]") -> "dict[str, xr.DataArray]":
    """Return the errors of variables over the steps, as ``errors_at_force``, from the curves of a result."""
    import xarray as xr

    labels = known_in(result, curves)
    if not labels:
        return {}
    dataset, bare = result.dataset, {name.removesuffix("_mean"): array for name, array in curves.items()}
    one = bare[_first(FORCES, bare)]
    unknown = xr.full_like(one, np.nan)
    arrays = [bare.get("contact_fraction", unknown), bare.get(_STATED, unknown), *(curves[label] for label in labels)]
    numbers = [
        dataset[name] if name in dataset else np.nan * dataset["interaction_error"] for name in (*_NUMBERS, _GRID)
    ]
    names = [label.removesuffix("_mean") for label in labels]
    found = xr.apply_ufunc(
        errors_at_force,
        *arrays,
        *(each.expand_dims(_OWN, axis=-1) for each in numbers),
        kwargs={"names": names, "legs": result.legs, "adheres": adheres(result)},
        input_core_dims=[["step"]] * len(arrays) + [[_OWN]] * len(numbers),
        output_core_dims=[["step"]] * len(labels),
        keep_attrs=False,
        dask="parallelized",
        output_dtypes=[np.float64] * len(labels),
    )
    return dict(zip(labels, found if len(labels) > 1 else (found,), strict=True))


def errors_along(result: ResultView) -> dict[str, Array]:
    """Return the errors of variables along a path of given separation, force or pressure, by their names.

    None for other paths, and where errors are not known.
    """
    given, suffix = result.control, "_mean" if result.keeps_statistics else ""
    held = {**result.coordinates, **result.variables}
    labels = known_in(result, [name for name in held if "step" in held[name].dims])
    if not labels or given not in (*FORCES, _H):
        return {}
    runs = result.variables["interaction_error"].dims
    dims = (*runs, "step")

    def values(name: str) -> Floats:
        found = held.get(name, held.get(f"{name}{suffix}"))
        return np.full((1,) * len(dims), np.nan) if found is None else _spread(found, dims)

    names = [label.removesuffix("_mean") for label in labels]
    fraction = values("contact_fraction")
    if np.isnan(fraction).all():
        fraction = values("contact_area") / values("nominal_area")
    curves = [values(name) for name in names]
    numbers = [values(name) for name in (*_NUMBERS, _GRID)]
    errors = errors_at_force(
        fraction, values(_STATED), *curves, *numbers, names=names, legs=result.legs, adheres=adheres(result)
    )
    changes = [_changes(each, result.legs) for each in curves]
    kept = names.index(kept_by(given, names))
    return {
        f"{label}{MODEL_ERROR}": Array(
            dims, at_given(error, change, errors[kept], changes[kept], name=name, given=given), attributes(name, given)
        )
        for label, name, error, change in zip(labels, names, errors, changes, strict=True)
        if name != given
    }


def adheres(result: ResultView) -> bool:
    """Return whether asperities adhere; of a law of one ensemble by its avalanches, which coupled ones alone have."""
    return result.adheres or "avalanche_count" in result.variables


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

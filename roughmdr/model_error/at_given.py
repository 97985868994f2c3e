"""The error of the model in variables of a law, each in its own unit, where a quantity is given.

At given force each variable X has an error of its own, and the separation that of the force at given separation over
the slope of the law. Where another quantity C is given, X is off by its change with C times the error of C besides; at
given separation, but for the stiffness, by ``_STEEPEST`` times the relative error of the force at most.
"""

from collections.abc import Collection, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from roughmdr.model_error.at_force import (
    NAMES,
    QUANTITIES,
    RELEASING,
    ByInteraction,
    by_range,
    interaction_along,
    relative_at_force,
    softened,
)
from roughmdr.model_error.parts import PARTS, PLASTIC, PLASTIC_AT_FORCE, SOFTNESS
from roughmdr.numerics.arguments import Floats
from roughmdr.variables import ORIGINS, SEPARATION

FORCES = ("force", "pressure")
"""Variables that tell the force; the first one that a result has counts."""
_METHOD = ("asperity_origin", "grid_points")
_AREAS = ("contact_fraction", "contact_area")
_H = SEPARATION.name
STATED, _BY_JKR = "model_error_curve", "adhesion_range_error"
ALWAYS = (*PARTS, "largest_contact_fraction", "asperity_origin")
NUMBERS = (*ALWAYS, "grid_points", "avalanche_count", "tabor_number", PLASTIC, SOFTNESS, *PLASTIC_AT_FORCE)
"""Numbers of a run that its errors follow from; those beside ``ALWAYS`` are known of some contacts alone: of contacts
that yield ``PLASTIC_AT_FORCE`` where the flat is lower than ever before.
"""
_MOST = 0.9
"""Largest relative error that a value is corrected for: of a value that is too small by more nothing is left."""
_STEEPEST = 3.0
"""Largest change of areas, radii and conductances with the force, both relative, that moves their errors [1]. Where
contacts jump, the force may hardly change from step to step; under JKR as many areas at given separation are bounded so
as without it, 99.4 %."""


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
    numbers = dict(zip(NUMBERS, arrays[4 + 2 * count :], strict=True))
    force = first_of(FORCES, names)
    # Contacts that push and pull leave little of their errors in the sum: they are at least of the tension.
    load, smallest = np.maximum(np.abs(values[force]), tension), np.finfo(np.float64)
    over, pulling = np.maximum(load, largest * smallest.eps**2 + smallest.tiny), np.minimum(values[force], 0.0)
    numbers["by_range"] = by_range(numbers[_BY_JKR], numbers["tabor_number"], largest / over)
    numbers["left"] = np.maximum(1.0 + pulling / over, smallest.eps)
    touching = np.asarray(sum(values[name] != 0.0 for name in names if name != _H)) > 0  # also under no load
    of_itself, over_largest, at_force = _relative_errors(touching, fraction, stated, numbers)
    of_force = load * _of_value(of_itself) + largest * over_largest
    by_stiffness = force == "force" and "stiffness" in values  # the slope of the law itself, also at a single load

    def at_given_force(name: str) -> Floats:
        if name == _H and by_stiffness:
            return _per_change(of_force, values["stiffness"])
        if name == _H:
            return _per_change(of_force, changes[force]) * np.abs(changes[_H])
        return np.abs(values[name]) * _of_value(at_force[QUANTITIES[name]])

    kept = next((first_of(alike, names) for alike in (FORCES, _AREAS) if given in alike), _H)

    def error(name: str) -> Floats:
        if kept in FORCES:
            return 0.0 * of_force if name in FORCES else at_given_force(name)
        moved = np.abs(changes[name]) * _per_change(at_given_force(kept), changes[kept])
        if kept == _H and name not in (_H, "stiffness"):
            steepest = _STEEPEST * np.abs(values[name]) * of_force / over
            known = (values[name] != 0.0) & np.isfinite(changes[name] * changes[kept])
            moved = np.where(known, np.fmin(moved, steepest), moved)
        if name not in FORCES:
            return at_given_force(name) + moved
        if kept != _H:
            return moved
        of_pulled = of_force + np.where(pulling < 0.0, (RELEASING - 1.0) * largest * numbers[_BY_JKR], 0.0)
        return of_pulled if name == force else of_pulled * _per_change(np.abs(values[name]), values[force])

    return tuple(np.broadcast_arrays(*(error(name) for name in names)))


def _relative_errors(
    touching: NDArray[np.bool_], fraction: Floats, stated: Floats, numbers: Mapping[str, Floats]
) -> tuple[Floats, Floats, list[Floats]]:
    """Return the error of the force at given separation, its part over the largest force, and errors [1] of quantities
    at given force.
    """
    origin, grid = (numbers[name] for name in _METHOD)
    interaction, by_jkr, most = (numbers[name] for name in ("interaction_error", _BY_JKR, "largest_contact_fraction"))
    others = _others(numbers)
    fraction = np.where(np.isnan(fraction), np.where(touching, most, 0.0), fraction)
    yields, loads = np.isfinite(numbers[PLASTIC]), np.isfinite(numbers[PLASTIC_AT_FORCE[0]])
    by_model = np.where(yields & touching, numbers[PLASTIC], 0.0)
    shared = softened(interaction, np.where(loads, numbers[SOFTNESS], np.nan), fraction, most, origin, grid)
    foreseen = np.where(yields, shared.own, interaction_along(interaction, fraction, most, origin, grid))
    foreseen += np.where(touching, others + by_jkr, 0.0) + by_model * loads
    whole = np.where(np.isnan(stated), np.minimum(foreseen, 1.0), stated)
    of_jkr = np.minimum(whole, by_jkr)
    own = np.maximum(whole - of_jkr - np.where(touching, others, 0.0), 0.0) * (interaction != 0.0)
    sticky_hills = (origin == ORIGINS.index("hills")) & np.isfinite(numbers["avalanche_count"])
    over_largest = np.where(sticky_hills, whole, of_jkr)  # which hills attraction with a range makes sooner
    pulled = numbers["by_range"], numbers["left"]
    shared = shared if yields.any() else ByInteraction(own, elastic=own, softness=1.0)
    at_force = relative_at_force(shared, fraction, _at_force(numbers), *pulled, origin, grid)
    return whole - over_largest, over_largest + by_model * ~loads * np.isnan(stated), at_force


def largest_at_force(numbers: Mapping[str, Any]) -> dict[str, float]:
    """Return the largest relative errors of quantities at given force [1], by their names: NaN where not known.

    ``numbers`` are those of one run or arrays over runs, by name; nothing is told without all that errors follow from,
    nor of contacts that yield and adhere.
    """
    yields, adheres = PLASTIC in numbers, not np.isfinite(numbers.get(PLASTIC_AT_FORCE[0], np.nan)).any()
    if not numbers.keys() >= {*ALWAYS} or (yields and adheres):
        return {}
    of = {name: np.asarray(numbers.get(name, np.nan), dtype=np.float64)[..., None] for name in NUMBERS}
    own, fraction, origin, grid = (of[name] for name in ("interaction_error", "largest_contact_fraction", *_METHOD))
    by_jkr, none = by_range(of[_BY_JKR], of["tabor_number"], np.ones(1)), np.ones(1)
    shared = ByInteraction(own, elastic=own, softness=1.0)
    if yields:
        shared = softened(own, of[SOFTNESS], fraction, fraction, origin, grid)
    found = relative_at_force(shared, fraction, _at_force(of), by_jkr, none, origin, grid)
    return {name: float(np.fmax.reduce(each, axis=None)) for name, each in zip(NAMES, found, strict=True)}


def _at_force(numbers: Mapping[str, Floats]) -> list[Floats]:
    """Return the errors of the quantities ``NAMES`` at given force by all but interaction and the range of adhesion."""
    area, stiffness, radius = (
        _others(numbers) + np.where(np.isfinite(numbers[PLASTIC]), numbers[name], 0.0) for name in PLASTIC_AT_FORCE
    )
    return [area, stiffness, radius, radius]


def _others(numbers: Mapping[str, Floats]) -> Floats:
    """Return the errors by all but interaction and the range of adhesion."""
    parts = [numbers[name] for name in PARTS if name not in ("interaction_error", _BY_JKR)]
    return np.asarray(np.add.reduce(parts))


def first_of(names: Sequence[str], among: Collection[str]) -> str:
    """Return the first of the ``names`` that is ``among`` others."""
    return next(name for name in names if name in among)


def _of_value(error: Floats) -> Floats:
    """Return a relative error, which is over the true value, over a value that is too small by it."""
    return np.asarray(error / (1.0 - np.minimum(error, _MOST)))


def _per_change(error: Floats, change: Floats) -> Floats:
    """Return an error over the magnitude of a change; 0 where the error is, NaN on a plateau."""
    error, size = np.broadcast_arrays(error, np.abs(change))
    known = (size > 0.0) & (error != 0.0)
    return np.asarray(np.divide(error, size, out=np.where(error == 0.0, 0.0, np.nan), where=known))

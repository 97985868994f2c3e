"""The part of a result at chosen values of its swept keys."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from roughmdr.errors import RoughmdrError, StoreError
from roughmdr.result.view import ResultView
from roughmdr.schema.quantities import Quantity
from roughmdr.schema.units import dimension_of
from roughmdr.schema.wording import short_repr, suggestion
from roughmdr.storage.labelled import Array, Labelled
from roughmdr.variables import AUXILIARY_COORDINATES, swept_name

_NEAR = 0.01  # difference from the value asked for, over it, that is allowed: so values of a logspace can be typed


def select(result: ResultView, chosen: Mapping[str, object]) -> tuple[ResultView, str]:
    """Return the part of a result where swept keys have the values ``chosen``, and these in words.

    Errors as ``indices_of``.
    """
    return _at(result, indices_of(result, chosen))


def cell_of(result: ResultView, chosen: Mapping[str, object]) -> tuple[int, ...]:
    """Return the index of a cell: the first value of the swept keys that are not chosen. Errors as ``indices_of``."""
    indices = indices_of(result, chosen)
    return tuple(indices.get(name, 0) for name in result.sweep)


def pull_off_step(result: ResultView, cell: tuple[int, ...], realization: int) -> int:
    """Return the step of the unloading nearest to the pull-off of a realisation; StoreError where there is none."""
    if "pull_off_separation" not in result.variables or "realization" not in result.sizes:
        raise StoreError("step is 'pull-off', and the result holds none of single realisations; give its number")
    run = (*cell, realization)
    place = result.variables["pull_off_separation"].values[run] if realization < result.sizes["realization"] else np.nan
    if np.isnan(place):
        raise StoreError(f"step is 'pull-off', and realisation {realization} has none; give the number of a step")
    of_run = result.variables.get("separation")
    separation = result.path[cell] if of_run is None else of_run.values[run]
    away = np.where(result.branches == "unloading", np.abs(separation - place), np.inf)
    return int(np.nanargmin(away))


def indices_of(result: ResultView, chosen: Mapping[str, object]) -> dict[str, int]:
    """Return the indices of values of swept keys, by their dimensions.

    Keys may have dots or underscores; values are numbers in SI, strings with a unit, or names. Keys that are swept
    together name the cell that has all these values. StoreError where a key is not swept, or has no such value, and
    where several cells have them.
    """
    swept = {
        name: array
        for name, array in result.coordinates.items()
        if len(array.dims) == 1 and array.dims[0] in result.sweep and name not in AUXILIARY_COORDINATES
    }
    places: dict[str, NDArray[np.bool_]] = {}
    for key, value in chosen.items():
        name = swept_name(key)
        if not swept:
            raise StoreError(f"select: {key!r} is not swept: the result has no sweep")
        if name not in swept:
            raise StoreError(f"select: {key!r} is not swept{suggestion(name, [*swept])}")
        (dimension,) = swept[name].dims
        there = swept[name].values == swept[name].values[_index(key, value, swept[name])]
        places[dimension] = there & places.get(dimension, True)
    for dimension, there in places.items():
        if there.sum() != 1:
            many = "no cell" if not there.any() else f"{there.sum()} cells"
            keys = ", ".join(name for name, array in swept.items() if array.dims == (dimension,))
            raise StoreError(f"select: {many} along {dimension} has the values chosen; choose by {keys}")
    return {dimension: int(there.argmax()) for dimension, there in places.items()}


def along_longest(result: ResultView) -> tuple[ResultView, str]:
    """Return the cells along the swept key with most values, at the middle values of others, and these in words."""
    sizes = result.sweep
    longest = max(sizes, key=lambda name: sizes[name])
    return _at(result, {name: size // 2 for name, size in sizes.items() if name != longest})


def _at(result: ResultView, indices: Mapping[str, int]) -> tuple[ResultView, str]:
    places = [indices.get(name, 0) for name in result.sweep]
    fixed = {name for name, array in result.coordinates.items() if array.dims and set(array.dims) <= set(indices)}
    whole = [part for part in result.label(tuple(places)).split(", ") if part.split(" = ")[0] in fixed]

    def part(array: Array) -> Array:
        index = tuple(indices.get(dim, slice(None)) for dim in array.dims)
        values = np.asarray(array.values[index], dtype=array.values.dtype)
        return Array(tuple(dim for dim in array.dims if dim not in indices), values, array.attrs)

    variables, coordinates = (
        {name: part(array) for name, array in arrays.items() if name not in indices}
        for arrays in (result.variables, result.coordinates)
    )
    return ResultView(Labelled(variables, coordinates, result.attrs)), ", ".join(whole)


def _index(key: str, value: object, coordinate: Array) -> int:
    """Return where a coordinate has a value."""
    values, shown = coordinate.values, short_repr(value)
    if values.dtype.kind not in "if":
        found = np.flatnonzero(values == value)
        if not found.size:
            available = suggestion(str(value), [*map(str, values)])
            raise StoreError(f"select: {key} = {shown} is not in the result{available}")
        return int(found[0])
    try:
        number = Quantity(dimension_of(str(coordinate.attrs.get("units", "1"))))(value)
    except RoughmdrError as error:
        raise StoreError(f"select: {key} = {shown}: {error}") from None
    nearest = int(np.argmin(np.abs(values - number)))
    if abs(values[nearest] - number) > _NEAR * abs(number):
        listed = ", ".join(f"{each:g}" for each in values[:12])
        more = ", ..." if values.size > 12 else ""
        raise StoreError(f"select: {key} = {shown} is not in the result; it has {listed}{more} (in SI)")
    return nearest

"""A number of each cell of a sweep, with its standard error."""

from typing import NamedTuple, cast

import numpy as np
from numpy.typing import ArrayLike

from roughmdr.errors import RoughmdrError, StoreError
from roughmdr.numerics.arguments import Floats
from roughmdr.pictures.curves import Quantity
from roughmdr.pictures.request import Request
from roughmdr.result.view import ResultView, parts_of
from roughmdr.schema.wording import suggestion
from roughmdr.variables import LAW_VARIABLES, OVER_AREA, PULL_OFF, RUN_VARIABLES

_PULL_OFF = "pull_off_force"
_PLACES = ("force", "pressure", "contact_fraction", "separation")


class Number(NamedTuple):
    """A number of each cell, over the swept keys, in SI."""

    name: str
    unit: str
    mean: Floats
    error: Floats
    """Standard error of the mean; NaN where there is none."""
    where: str
    """Position on the path, in words; empty for numbers that are not taken from a curve."""


def number_of(result: ResultView, request: Request) -> Number:
    """Return the number that is asked for; StoreError where the result lacks it."""
    if len(request.variables) > 1:
        raise StoreError(f"variables are {', '.join(request.variables)}; a sweep is drawn of one")
    if len(request.at) > 1:
        raise StoreError(f"at names {', '.join(request.at)}; a law is taken at one of them")
    name = request.variables[0] if request.variables else _usual(result, request)
    if name in result.curves or (request.at and name in LAW_VARIABLES):
        return _of_curve(result, name, request)
    if request.per_area:
        name = OVER_AREA.get(name, name)
    declared = {**PULL_OFF, **RUN_VARIABLES}
    if name not in declared or not result.holds(name) or not declared[name].units:
        available = [*result.curves, *(each for each in declared if result.holds(each))]
        raise StoreError(f"variable {name!r} is not in the result{suggestion(name, available)}")
    if request.at:
        raise StoreError(f"at does not go with {name}, which is no curve")
    if name in result.variables and "realization" not in result.variables[name].dims:
        mean = np.asarray(result.variables[name].values, dtype=np.float64)
        return Number(name, declared[name].units, mean, np.full_like(mean, np.nan), "")
    return Number(name, declared[name].units, *result.mean(name), "")


def _usual(result: ResultView, request: Request) -> str:
    """Return the usual variable of a sweep: the pull-off force, or else the tangential force, or else the force."""
    if not request.at and result.holds(_PULL_OFF) and np.isfinite(result.mean(_PULL_OFF)[0]).any():
        return _PULL_OFF
    available = result.curves
    others = [name for name in available if name not in request.at] or available
    return next((name for name in ("tangential_force", "force", "pressure") if name in others), others[0])


def _of_curve(result: ResultView, name: str, request: Request) -> Number:
    """Return a variable where the loading reaches what is asked for, or else where its mean is largest."""
    quantity = Quantity.of(result, name, per_area=request.per_area)
    if not request.at:
        mean, error = result.mean(name)
        largest = np.nanargmax(np.where(np.isnan(mean), -np.inf, mean), axis=-1)[..., None]
        mean, error = (np.take_along_axis(values, largest, axis=-1)[..., 0] for values in (mean, error))
        where = "at its largest along the path"
    else:
        ((place, value),) = request.at.items()
        if place not in _PLACES:
            raise StoreError(f"at is {place!r}, which is none{suggestion(place, list(_PLACES))}")
        if place == name:
            raise StoreError(f"at {place} = {value} does not go with {name} itself: name another variable")
        import xarray as xr

        from roughmdr.result.interpolation import at_value

        try:
            parts = [
                at_value(each.dataset, place, cast("ArrayLike", value), "loading") for each in parts_of(result, 4.0)
            ]
        except RoughmdrError as refused:
            raise StoreError(f"at {place} = {value}: {refused}") from None
        found = ResultView(parts[0] if len(parts) == 1 else xr.concat(parts, "realization", data_vars="minimal"))
        if not found.holds(name):
            available = [each.removesuffix("_mean") for each in found.variables if "interpolation" not in each]
            raise StoreError(f"variable {name!r} is not in the result{suggestion(name, available)}")
        mean, error = found.mean(name)
        if np.isnan(mean).all():
            raise StoreError(f"at {place} = {value}: no loading reaches it")
        where = f"where loading reaches {place.replace('_', ' ')} {value}"
    shape = tuple(result.sweep.values())
    mean, error = (quantity.scaled(values.reshape(shape)) for values in (mean, error))
    return Number(quantity.name, quantity.unit, mean, error, where)

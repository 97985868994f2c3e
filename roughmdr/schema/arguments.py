"""Arguments of Python functions, checked: each error names the argument, its value and what is allowed.

A number is in SI, or a string with a unit, as in a scene. A dimension is spelled as in ``units``.
"""

import math
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from roughmdr.errors import OutOfRange, RoughmdrError, warn_limits
from roughmdr.numerics.arguments import Floats
from roughmdr.schema.units import DIMENSIONLESS, millipascals, quantity
from roughmdr.schema.wording import short_repr

_LEAST_STEPS = 2


def check_number(name: str, value: float | str, dimension: str, *, zero: bool = False) -> float:
    """Return ``value`` in SI; OutOfRange unless it is finite and above 0 (or 0, where ``zero`` allows that)."""
    unit = "" if dimension == DIMENSIONLESS else f" {dimension}"
    allowed = f"a finite number {'of at least' if zero else 'above'} 0{unit}"
    try:
        number = _from_text(name, value, dimension) if isinstance(value, str) else float(value)
    except (TypeError, ValueError, OverflowError) as error:
        if isinstance(error, OutOfRange):
            raise
        raise OutOfRange(f"{name} is {value!r}; it must be {allowed}") from None
    if not (math.isfinite(number) and (number > 0.0 or (zero and number == 0.0))):
        raise OutOfRange(f"{name} is {number:g}{unit}; it must be {allowed}")
    return number


def check_steps(value: object) -> int:
    """Return a number of steps; OutOfRange unless it is a whole number of at least 2."""
    if isinstance(value, bool) or not isinstance(value, int | np.integer) or value < _LEAST_STEPS:
        raise OutOfRange(f"steps is {value!r}; it must be a whole number of at least {_LEAST_STEPS}")
    return int(value)


def check_poisson(name: str, value: float) -> float:
    """Return a Poisson's ratio as a float; OutOfRange unless it is above -1 and at most 1/2."""
    try:
        ratio = float(value)
    except (TypeError, ValueError):
        raise OutOfRange(f"{name} is {value!r}; it must be a number above -1 and at most 0.5") from None
    if not -1.0 < ratio <= 0.5:
        raise OutOfRange(f"{name} is {ratio:g}; it must be above -1 and at most 0.5")
    return ratio


def check_values(name: str, raw: ArrayLike, dimension: str) -> Floats:
    """Return a number or a one-dimensional array of numbers in SI; OutOfRange unless all are finite."""
    values = floats_in_si(name, raw, dimension, "a number or a one-dimensional array")
    if values.ndim > 1:
        raise OutOfRange(f"{name} has {values.ndim} dimensions; it must be a number or a one-dimensional array")
    undefined = ~np.isfinite(np.atleast_1d(values))
    if undefined.any():
        raise OutOfRange(f"{name} is {np.atleast_1d(values)[undefined][0]}; it must be finite")
    return values


def check_scalar(name: str, raw: ArrayLike, dimension: str) -> float:
    """Return one number in SI; OutOfRange unless it is finite."""
    value = check_values(name, raw, dimension)
    if value.ndim:
        raise OutOfRange(f"{name} has {value.ndim} dimensions; it must be one number")
    return float(value)


def exactly_one(owner: str, **choices: Any) -> tuple[str, Any]:
    """Return the name and the value of the only choice that is not None; RoughmdrError unless there is just one."""
    given = {name: value for name, value in choices.items() if value is not None}
    if len(given) != 1:
        got = " and ".join(given) or "none"
        raise RoughmdrError(f"got {got}; {owner} takes exactly one of {', '.join(choices)}")
    return given.popitem()


def floats_in_si(name: str, raw: ArrayLike, dimension: str, allowed: str) -> Floats:
    """Return a new array of numbers, given as such or as strings with units; OutOfRange, unless all can be read, says
    that they must be what is ``allowed``.
    """
    try:
        given = np.array(raw)
        if given.dtype.kind != "U":
            return given.astype(np.float64)
        return np.reshape([_from_text(name, str(text), dimension) for text in given.flat], given.shape)
    except OutOfRange:
        raise
    except (TypeError, ValueError, OverflowError):
        raise OutOfRange(f"{name} is {raw!r}; it must be {allowed}") from None


def _from_text(name: str, text: str, dimension: str) -> float:
    try:
        number = quantity(text, dimension)
    except RoughmdrError as error:
        raise OutOfRange(f"{name} is {short_repr(text)}: {error}") from None
    if doubt := millipascals(text):
        warn_limits([f"{name} is {short_repr(text)}: {doubt}"])
    return number

"""Arguments of Python functions, checked: each error names the argument, its value and what is allowed.

A number is in SI, or a string with a unit, as in a scene. A dimension is spelled as in ``units``.
"""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from roughmdr.errors import OutOfRange, RoughmdrError
from roughmdr.numerics.arguments import Floats
from roughmdr.schema.quantities import Quantity, from_text
from roughmdr.schema.units import as_text


def check_number(name: str, value: float | str, dimension: str, *, zero: bool = False) -> float:
    """Return ``value`` in SI; OutOfRange unless it is finite and above 0 (or 0, where ``zero`` allows that)."""
    bound = Quantity(dimension, at_least=0.0) if zero else Quantity(dimension, above=0.0)
    return bound.argument(name, value)


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
        given = np.array(as_text(raw))
        if given.dtype.kind != "U":
            return given.astype(np.float64)
        return np.reshape([from_text(name, str(text), dimension) for text in given.flat], given.shape)
    except OutOfRange:
        raise
    except (TypeError, ValueError, OverflowError):
        raise OutOfRange(f"{name} is {raw!r}; it must be {allowed}") from None

"""Checks of numbers that callers hand in: each error names the argument, its value and what is allowed."""

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from roughmdr.errors import OutOfRange

Floats = NDArray[np.float64]


def check_number(name: str, value: float, unit: str, *, zero: bool = False) -> float:
    """Return ``value`` as a float; OutOfRange unless it is finite and above 0 (or 0, where that is allowed)."""
    allowed = f"a finite number {'of at least' if zero else 'above'} 0 {unit}"
    try:
        number = float(value)
    except (TypeError, ValueError, OverflowError):
        raise OutOfRange(f"{name} is {value!r}; it must be {allowed}") from None
    if not (math.isfinite(number) and (number > 0.0 or (zero and number == 0.0))):
        raise OutOfRange(f"{name} is {number:g} {unit}; it must be {allowed}")
    return number


def check_values(name: str, raw: ArrayLike) -> Floats:
    """Return a number or a one-dimensional array of numbers as floats; OutOfRange unless all are finite."""
    try:
        values = np.asarray(raw, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        raise OutOfRange(f"{name} is {raw!r}; it must be a number or a one-dimensional array") from None
    if values.ndim > 1:
        raise OutOfRange(f"{name} has {values.ndim} dimensions; it must be a number or a one-dimensional array")
    not_finite = values[~np.isfinite(values)]
    if not_finite.size:
        raise OutOfRange(f"{name} is {not_finite.flat[0]}; it must be finite")
    return values

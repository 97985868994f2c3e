"""Differences of elementary functions that cancel, written so that they do not; plain Python, for any number of digits.

Each is a power series near 0 and the difference itself elsewhere.
"""

import math

_NEAR = 0.3  # the difference itself loses a digit and a half there
_TERMS = 50  # enough for 50 digits there


def _odd_series(x: float, first: float, ratio: float) -> float:
    """x^n/n + ratio x^(n + 2)/(n + 2) + ratio^2 x^(n + 4)/(n + 4) + ..., n = ``first`` 3 or 5."""
    power = x * x * x if first == 3.0 else x * x * x * x * x
    total, odd = power / first, first
    for _ in range(_TERMS):
        power = ratio * power * x * x
        odd = odd + 2.0
        before, total = total, total + power / odd
        if total == before:
            break
    return total


def less_atan(q: float) -> float:
    """q - atan q for q >= 0: q^3/3 - q^5/5 + ..."""
    return q - math.atan(q) if q > _NEAR else _odd_series(q, 3.0, -1.0)


def less_atan_and_cube(q: float) -> float:
    """q^3/3 - (q - atan q) for q >= 0: q^5/5 - q^7/7 + ..."""
    return q * q * q / 3.0 - (q - math.atan(q)) if q > _NEAR else _odd_series(q, 5.0, -1.0)


def beyond_tanh(t: float, x: float) -> float:
    """t - x for x = tanh t >= 0: x^3/3 + x^5/5 + ..."""
    return t - x if x > _NEAR else _odd_series(x, 3.0, 1.0)

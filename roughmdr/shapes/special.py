"""Differences of elementary functions that cancel, written so that they do not; plain Python, for any number of digits.

Each is a power series near 0 and the difference itself elsewhere.
"""

import math

_NEAR = 0.3  # the difference itself loses a digit and a half there
_TERMS = 50  # enough for 50 digits there


def less_atan(q: float) -> float:
    """q - atan q for q >= 0: q^3/3 - q^5/5 + ..."""
    if q > _NEAR:
        return q - math.atan(q)
    power = q * q * q
    total, odd = power / 3.0, 3.0
    for _ in range(_TERMS):
        power = -power * q * q
        odd = odd + 2.0
        before, total = total, total + power / odd
        if total == before:
            break
    return total


def less_atan_and_cube(q: float) -> float:
    """q^3/3 - (q - atan q) for q >= 0: q^5/5 - q^7/7 + ..."""
    if q > _NEAR:
        return q * q * q / 3.0 - (q - math.atan(q))
    power = q * q * q * q * q
    total, odd = power / 5.0, 5.0
    for _ in range(_TERMS):
        power = -power * q * q
        odd = odd + 2.0
        before, total = total, total + power / odd
        if total == before:
            break
    return total


def beyond_tanh(t: float, x: float) -> float:
    """t - x for x = tanh t >= 0: x^3/3 + x^5/5 + ..."""
    if x > _NEAR:
        return t - x
    power = x * x * x
    total, odd = power / 3.0, 3.0
    for _ in range(_TERMS):
        power = power * x * x
        odd = odd + 2.0
        before, total = total, total + power / odd
        if total == before:
            break
    return total

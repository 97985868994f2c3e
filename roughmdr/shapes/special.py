"""Differences of elementary functions that cancel, written so that they do not."""

from roughmdr.numerics.vector_math import atan, fifth_series, third_series

NEAR = 0.4142  # up to here the series; the difference itself loses a digit and a half there, with many digits nothing


def less_atan(q: float) -> float:
    """q - atan q for q >= 0: q^3/3 - q^5/5 + ..."""
    return q - atan(q) if q > NEAR else q * q * q * third_series(-q * q)


def less_atan_and_cube(q: float) -> float:
    """q^3/3 - (q - atan q) for q >= 0: q^5/5 - q^7/7 + ..."""
    square = q * q
    if q > NEAR:
        return q * square / 3.0 - (q - atan(q))
    return q * square * square * fifth_series(-square)


def beyond_tanh(t: float, x: float) -> float:
    """t - x for x = tanh t >= 0: x^3/3 + x^5/5 + ..."""
    return t - x if x > NEAR else x * x * x * third_series(x * x)

"""Elementary functions without branches or calls, so that a loop over asperities becomes vector code.

Plain Python on floats, to be compiled, and within three roundings of the function; ``ProfileShape.precisely``
replaces them by functions of mpmath of the same names. Differences that cancel are series where they would lose digits.
"""

import math

import numpy as np

SERIES_UP_TO = 0.4142
"""Differences of arguments up to here are computed as series: directly they would lose a digit and a half."""

LOG_2_HIGH, LOG_2_LOW = 0.6931471803691238, 1.9082149292705877e-10  # the first times a whole number is exact
_PER_LOG_2 = 1.0 / math.log(2.0)
_TO_WHOLE = 6755399441055744.0  # 1.5 2^52: added to a number it leaves the nearest whole one, in the last bits
_ODD = tuple(1.0 / (2 * k + 5) for k in range(20))
_FACTORIAL = tuple(1.0 / math.factorial(k + 2) for k in range(12))
_TAN_22_5, _TAN_67_5 = math.sqrt(2.0) - 1.0, math.sqrt(2.0) + 1.0
_SMALLEST_NORMAL = float(np.finfo(np.float64).tiny)
_MANTISSA, _ONE = np.int64(0xFFFFFFFFFFFFF), np.int64(0x3FF0000000000000)
_EXP_MAX, _EXP_MIN = 709.0, -60.0  # e^709 is a float, e^-60 - 1 is -1


def sqrt(x: float) -> float:
    """Return the square root of x >= 0."""
    return math.sqrt(x)


def fifth_series(v: float) -> float:
    """Return 1/5 + v/7 + v^2/9 + ... for |v| < 0.172."""
    square = v * v
    even, odd = 0.0, 0.0
    for k in range(18, -1, -2):
        even, odd = even * square + _ODD[k], odd * square + _ODD[k + 1]
    return even + v * odd


def third_series(v: float) -> float:
    """Return 1/3 + v/5 + ... = S(v) for |v| < 0.172, so that atan q = q - q^3 S(-q^2) and artanh x = x + x^3 S(x^2)."""
    return 1.0 / 3.0 + v * fifth_series(v)


def atan(q: float) -> float:
    """Return atan q for q >= 0, from that of the tangent of an angle below pi/8."""
    steep, middling = q > _TAN_67_5, q > _TAN_22_5
    above = -1.0 if steep else (q - 1.0 if middling else q)
    below = q if steep else (q + 1.0 if middling else 1.0)
    z = above / below
    begin = 0.5 * math.pi if steep else (0.25 * math.pi if middling else 0.0)
    return begin + (z - z * z * z * third_series(-z * z))


def q_minus_atan(q: float) -> float:
    """Return q - atan q for q >= 0: q^3/3 - q^5/5 + ..."""
    return q - atan(q) if q > SERIES_UP_TO else q * q * q * third_series(-q * q)


def atan_minus_cubic(q: float) -> float:
    """Return atan q - (q - q^3/3) for q >= 0: q^5/5 - q^7/7 + ..."""
    square = q * q
    if q > SERIES_UP_TO:
        return q * square / 3.0 - (q - atan(q))
    return q * square * square * fifth_series(-square)


def t_minus_tanh(t: float, x: float) -> float:
    """Return t - x for x = tanh t >= 0: x^3/3 + x^5/5 + ..."""
    return t - x if x > SERIES_UP_TO else x * x * x * third_series(x * x)


def _power_of_two(shifted: float) -> float:
    """Return 2^k for the k, -1022 to 1023, that was added to _TO_WHOLE."""
    return float(np.int64((np.float64(shifted).view(np.int64) + np.int64(1023)) << np.int64(52)).view(np.float64))


def scale_and_growth(high: float, low: float) -> tuple[float, float]:
    """Return 2^k and e^r - 1, for high + low = k ln 2 + r and high from -708 to 709."""
    shifted = high * _PER_LOG_2 + _TO_WHOLE
    k = shifted - _TO_WHOLE
    r = ((high - k * LOG_2_HIGH) - k * LOG_2_LOW) + low
    square = r * r
    even, odd = 0.0, 0.0
    for j in range(10, -1, -2):
        even, odd = even * square + _FACTORIAL[j], odd * square + _FACTORIAL[j + 1]
    return _power_of_two(shifted), r + square * (even + r * odd)


def expm1(x: float) -> float:
    """Return e^x - 1; inf beyond 709."""
    scale, growth = scale_and_growth(_EXP_MAX if x > _EXP_MAX else (_EXP_MIN if x < _EXP_MIN else x), 0.0)
    return math.inf if x > _EXP_MAX else scale * growth + (scale - 1.0)


def tanh(t: float) -> float:
    """Return the hyperbolic tangent of t >= 0."""
    growth = expm1(600.0 if t > 300.0 else 2.0 * t)
    return growth / (growth + 2.0)


def binade_cell(y: float, split: int) -> tuple[int, float]:
    """Return the cell in which a normal y > 0 lies, and its position there, from 0 to 1.

    Each interval from 2^k to 2^(k + 1) has 2^split equal cells; cell 0 begins at 1.
    """
    bits = np.float64(y).view(np.int64)
    within = np.int64(((bits << split) & _MANTISSA) | _ONE).view(np.float64)
    return int((bits >> np.int64(52 - split)) - (np.int64(1023) << split)), float(within) - 1.0


def power_and_log(x: float) -> tuple[float, float]:
    """Return k and ln m for x = 2^k m normal and m from 0.7 to 1.42."""
    k, beyond = binade_cell(x, 0)
    high = beyond > math.sqrt(2.0) - 1.0
    m, power = (0.5 + 0.5 * beyond if high else 1.0 + beyond), float(k + 1 if high else k)
    z = (m - 1.0) / (m + 1.0)
    return power, 2.0 * (z + z * z * z * third_series(z * z))


def log(x: float) -> float:
    """Return ln x for a normal x > 0, NaN elsewhere."""
    power, rest = power_and_log(x)
    return power * LOG_2_HIGH + (rest + power * LOG_2_LOW) if _SMALLEST_NORMAL <= x < math.inf else math.nan


def log1p(y: float) -> float:
    """Return ln(1 + y) for y >= 0."""
    above = 1.0 + y
    return log(above) + (y - (above - 1.0)) / above

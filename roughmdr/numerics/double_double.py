"""Arithmetic with about 31 digits: a number is an unevaluated sum (hi, lo) of two floats.

Next to detachment an error in the fold is magnified by the inverse square root of the distance to it; and for exponents
near 1/2 the scale of the contact is a logarithm divided by a small number. Single floats have too few digits for both.

Source: T. J. Dekker, Numer. Math. 18 (1971) 224; D. E. Knuth, The Art of Computer Programming 2, 4.2.2 (two_sum).
"""

import math
from fractions import Fraction

from roughmdr.numerics.jit import njit

Pair = tuple[float, float]

_SPLITTER = 134217729.0  # 2^27 + 1
LOG_2 = (0.6931471805599453, 2.3190468138462996e-17)
LOG_3 = (1.0986122886681098, -9.07129723500153e-17)
_ODD = tuple(1.0 / j for j in range(1, 23, 2))
_ODD_REST = tuple(float(Fraction(1, j) - Fraction(1.0 / j)) for j in range(1, 23, 2))
PI = (3.141592653589793, 1.2246467991473532e-16)
ROUNDING = 2.0**-53
"""Largest relative error of one rounding of a float."""


@njit
def two_sum(a: float, b: float) -> Pair:
    """Return a + b exactly."""
    s = a + b
    t = s - a
    return s, (a - (s - t)) + (b - t)


@njit
def two_product(a: float, b: float) -> Pair:
    """Return a * b exactly, while neither factor is above 1e300 nor the product below 1e-290."""
    p = a * b
    t = _SPLITTER * a
    a1 = t - (t - a)
    a2 = a - a1
    t = _SPLITTER * b
    b1 = t - (t - b)
    b2 = b - b1
    return p, ((a1 * b1 - p) + a1 * b2 + a2 * b1) + a2 * b2


@njit
def add(x: Pair, y: Pair) -> Pair:
    """Return x + y."""
    s, e = two_sum(x[0], y[0])
    t, f = two_sum(x[1], y[1])
    s, e = two_sum(s, e + t)
    return two_sum(s, e + f)


@njit
def multiply(x: Pair, y: Pair) -> Pair:
    """Return x * y."""
    p, e = two_product(x[0], y[0])
    return two_sum(p, e + (x[0] * y[1] + x[1] * y[0]))


@njit
def divide(x: Pair, y: Pair) -> Pair:
    """Return x / y."""
    q = x[0] / y[0]
    p, e = two_product(q, y[0])
    return two_sum(q, ((((x[0] - p) - e) + x[1]) - q * y[1]) / y[0])


@njit
def log(x: Pair) -> Pair:
    """Return ln x for x > 0: x = m 2^k with m near 1, ln m = 2 artanh((m - 1)/(m + 1)) as a power series."""
    m, k = math.frexp(x[0])
    if m < math.sqrt(0.5):
        m *= 2.0
        k -= 1
    reduced = (m, math.ldexp(x[1], -k))
    z = divide(add(reduced, (-1.0, 0.0)), add(reduced, (1.0, 0.0)))
    square = multiply(z, z)
    tail = 0.0
    for j in range(43, 22, -2):  # |z| < 0.1716: the first term left out is below 1e-34
        tail = tail * square[0] + 1.0 / j
    series = (tail, 0.0)  # times z^22 < 1e-16
    for i in range(10, -1, -1):
        series = add(multiply(series, square), (_ODD[i], _ODD_REST[i]))
    series = multiply(multiply(series, z), (2.0, 0.0))
    return add(series, multiply((float(k), 0.0), LOG_2))


@njit
def exp(x: Pair) -> Pair:
    """Return e^x, for x[0] within the range of ``math.exp``; the relative error is the error of x, plus x[1]^2/2."""
    y = math.exp(x[0])
    error = add(x, multiply((-1.0, 0.0), log((y, 0.0))))
    return two_sum(y, y * (error[0] + error[1]))


@njit
def sqrt(x: Pair) -> Pair:
    """Return the square root of x > 0: the rounded root, corrected by the remainder of its exact square."""
    root = math.sqrt(x[0])
    p, e = two_product(root, root)
    return two_sum(root, (((x[0] - p) - e) + x[1]) / (2.0 * root))

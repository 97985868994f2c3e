"""One power-law asperity without adhesion, whose state is x: for sums over asperities, as vector code.

Reduced as in ``hertz``: a/width = x^(1/n) and P over 2 E* width depth = n/(n + 1) a x (H 10, 16, 25).
"""

import math
from functools import partial

import numpy as np

from roughmdr.numerics.double_double import two_product
from roughmdr.numerics.jit import compiled, njit
from roughmdr.numerics.vector_math import LOG_2_HIGH, LOG_2_LOW, power_and_log, scale_and_growth

_SMALLEST_NORMAL = float(np.finfo(np.float64).tiny)
_RAISED_BY, _RAISED = 54.0, 2.0**54  # power of two, and its exponent, that makes all floats normal
_LOG_MAX, _LOG_MIN = 709.0, -708.0  # natural logarithms of the largest and the smallest normal float
_power_and_log, _scale_and_growth = (compiled(part, small=True) for part in (power_and_log, scale_and_growth))
_vector = partial(njit, small=True)


@_vector
def root(x: float, n: float) -> float:
    """x^(1/n) for x >= 0 and n > 0; 0 below e^-708, inf beyond e^709; within 2 + 1/n roundings.

    Its logarithm is two floats: with one alone the error would be ln x/n roundings.
    """
    small = x < _SMALLEST_NORMAL
    power, rest = _power_and_log(x * _RAISED if small else x)
    power = power - _RAISED_BY if small else power
    above, below = power * LOG_2_HIGH, rest + power * LOG_2_LOW
    high = (above + below) / n
    product, error = two_product(high, n)
    low = (((above - product) + below) - error) / n
    scale, growth = _scale_and_growth(_LOG_MAX if high > _LOG_MAX else (_LOG_MIN if high < _LOG_MIN else high), low)
    found = math.inf if high > _LOG_MAX else (0.0 if high < _LOG_MIN else scale + scale * growth)
    return found if x > 0.0 else 0.0


@_vector
def state(x: float, n: float) -> float:
    """x >= 0 itself."""
    return x


@_vector
def radius_force_stiffness(x: float, n: float) -> tuple[float, float, float]:
    """a over width, P over 2 E* width depth, and k over 2 E* width."""
    a = root(x, n)
    return a, n / (n + 1.0) * (a * x), a


@njit
def energy(x: float, n: float) -> float:
    """U over 2 E* width depth^2."""
    return float(n * n / ((n + 1.0) * (2.0 * n + 1.0)) * (root(x, n) * x * x))

"""kappa(n), the ratio of the MDR profile g of a power law to its profile f (H 26)."""

import math

from roughmdr.numerics import double_double as extended
from roughmdr.numerics.double_double import Pair
from roughmdr.numerics.jit import njit

_MIN_EXPONENT, _MAX_EXPONENT = 1e-18, 1e18  # beyond them the limits are right to the last digit
_EULER = (-1.0, 5.0, -61.0, 1385.0, -50521.0, 2702765.0, -199360981.0)  # E_2, E_4, ... E_14


@njit
def _gamma_step(z: float) -> Pair:
    """Return Gamma(z + 1/2)/Gamma(z) for z > 0.

    The asymptotic series in w = z - 1/4, sqrt(w) exp[-sum_k E_k/(2 k (4 w)^k)], begun at z >= 24 where the first term
    left out is below 1e-23 (NIST DLMF 5.11.8 at 3/4 and 1/4, with B_{k+1}(1/4) = -(k+1) E_k/4^(k+1) of 24.4.31).
    """
    numerator, denominator, shift = (1.0, 0.0), (1.0, 0.0), 0.0
    while z + shift < 24.0:
        numerator = extended.multiply(numerator, extended.two_sum(z, shift))
        denominator = extended.multiply(denominator, extended.two_sum(z, shift + 0.5))
        shift += 1.0
    w = extended.two_sum(z, shift - 0.25)
    tail = 0.0
    for i in range(6, -1, -1):
        k = 2.0 * (i + 1.0)
        tail = (tail - _EULER[i] / (2.0 * k)) / (16.0 * w[0] * w[0])
    correction = extended.two_sum(1.0, math.expm1(tail))
    return extended.multiply(extended.multiply(extended.sqrt(w), correction), extended.divide(numerator, denominator))


@njit
def precise_kappa(exponent: float) -> Pair:
    """Return kappa(n) = sqrt(pi)/2 n Gamma(n/2)/Gamma((n + 1)/2) (H 26)."""
    if exponent < _MIN_EXPONENT:
        return extended.two_sum(1.0, exponent * math.log(2.0))  # the next term is O(n^2)
    if exponent > _MAX_EXPONENT:
        return math.sqrt(0.5 * math.pi) * math.sqrt(exponent), 0.0  # the next term is 1/(4 n) of it
    half = (0.5 * exponent, 0.0)
    return extended.divide(extended.multiply(extended.sqrt(extended.PI), half), _gamma_step(half[0]))


@njit
def kappa(exponent: float) -> float:
    """Return kappa of an exponent: 1 at n -> 0, pi/2 for the cone, 2 for the paraboloid, about sqrt(pi n/2) beyond."""
    return precise_kappa(exponent)[0]

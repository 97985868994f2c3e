"""kappa(n): by how much the MDR profile of a power law is steeper than the law itself (H 26)."""

import math

from roughmdr.numerics import double_double as extended
from roughmdr.numerics.double_double import Pair
from roughmdr.numerics.jit import njit

_LEAST, _LARGEST = 1e-18, 1e18  # beyond them the limits are right to the last digit
_EULER = (-1.0, 5.0, -61.0, 1385.0, -50521.0, 2702765.0, -199360981.0)  # E_2, E_4, ... E_14


@njit
def _gamma_step(z: float) -> Pair:
    """Gamma(z + 1/2)/Gamma(z) for z > 0.

    The asymptotic series in w = z - 1/4, sqrt(w) exp[-sum_k E_k/(2 k (4 w)^k)], begun at z >= 24 where the first term
    left out is below 1e-23 (NIST DLMF 5.11.8 at 3/4 and 1/4, with B_{k+1}(1/4) = -(k+1) E_k/4^(k+1) of 24.4.31).
    """
    above, below, lift = (1.0, 0.0), (1.0, 0.0), 0.0
    while z + lift < 24.0:
        above = extended.multiply(above, extended.two_sum(z, lift))
        below = extended.multiply(below, extended.two_sum(z, lift + 0.5))
        lift += 1.0
    w = extended.two_sum(z, lift - 0.25)
    tail = 0.0
    for i in range(6, -1, -1):
        k = 2.0 * (i + 1.0)
        tail = (tail - _EULER[i] / (2.0 * k)) / (16.0 * w[0] * w[0])
    growth = extended.two_sum(1.0, math.expm1(tail))
    return extended.multiply(extended.multiply(extended.sqrt(w), growth), extended.divide(above, below))


@njit
def precise_kappa(exponent: float) -> Pair:
    """kappa(n) = sqrt(pi)/2 n Gamma(n/2)/Gamma((n + 1)/2), the factor from f to g (H 26)."""
    if exponent < _LEAST:
        return extended.two_sum(1.0, exponent * math.log(2.0))  # and terms of its square
    if exponent > _LARGEST:
        return math.sqrt(0.5 * math.pi) * math.sqrt(exponent), 0.0  # and 1/4 of its inverse
    half = (0.5 * exponent, 0.0)
    return extended.divide(extended.multiply(extended.sqrt(extended.PI), half), _gamma_step(half[0]))


@njit
def kappa(exponent: float) -> float:
    """The factor from f to g: 1 at n -> 0, pi/2 for the cone, 2 for the paraboloid, about sqrt(pi n/2) beyond."""
    return precise_kappa(exponent)[0]

"""Inverses of the law of the curvatures of summits, by which they are drawn.

S is the mean curvature (k1 + k2)/2 and v the product k1 k2 of the principal curvatures, without units:
(k1 + k2)/2 = sqrt(2 m4/3) S and k1 k2 = (2 m4/3) v, so that 0 < v < S^2.
"""

import math
from functools import cache

import numpy as np

from roughmdr.numerics.arguments import Floats

_LEVEL = math.sqrt(6.0 / math.pi)
_SMALL = 0.5  # of v and below it, v - 1 + exp(-v) is summed as a series, since the difference cancels
_SMALL_MEAN = 1.0  # of S, likewise for its fraction below
_EXCESS = [(-1.0) ** k / math.factorial(k) for k in range(2, 17)]
_BELOW = [(-0.5) ** k * (3**k - 1 - 2 * k) / (math.factorial(k) * (2 * k + 1)) for k in range(2, 23)]
_LARGEST_MEAN = 10.0  # S that is exceeded by less than any uniform number tells
_NODES = 2049


def mean_curvature(uniform: Floats) -> Floats:
    """S [1] below which these fractions of the summits lie; the fractions from 2^-53 to 1 - 2^-53.

    The density of S is sqrt(6/pi) (S^2 - 1 + exp(-S^2)) exp(-S^2/2), what M. S. Longuet-Higgins, Phil. Trans. R. Soc. A
    249 (1957) 321, gives for all extrema, kept to those where both curvatures are above 0.
    """
    S = np.interp(_stretched(uniform, 1.0 - uniform), *_table())
    t = S * S
    excess = _excess(t)
    # From the smaller of the fractions below and above: 1 - u is exact, and the other one is too coarse.
    off, upper = np.empty_like(S), uniform > 0.5
    off[upper] = (1.0 - uniform[upper]) - _above(S[upper])
    off[~upper] = _below(S[~upper]) - uniform[~upper]
    newton = off / (_LEVEL * excess * np.exp(-0.5 * t))
    return np.asarray(S - newton / (1.0 - 0.5 * newton * S * (2.0 * t / excess - 3.0)))


def product_of_curvatures(uniform: Floats, S: Floats) -> Floats:
    """v [1] below which these fractions lie of the summits that have the mean curvature S.

    Of them v has the density v exp(v) over 0 < v < S^2. With the fraction N(v)/N(S^2), N = (v - 1) exp(v) + 1, this
    solves log N(v) = log u + log N(S^2), which neither cancels nor overflows, by Halley's method.
    """
    top = S * S
    level = np.log(uniform) + top + np.log(_excess(top))
    v = 2.0 * np.logaddexp(0.0, 0.5 * (level - math.log(2.0)))  # right for small v, and to a logarithm for large ones
    for _ in range(3):
        excess = _excess(v)
        rate = v / excess
        newton = (v + np.log(excess) - level) / rate
        v = v - newton / (1.0 - 0.5 * newton * (1.0 + 1.0 / v - rate))
    return np.asarray(v)


def _excess(v: Floats) -> Floats:
    """v - 1 + exp(-v)."""
    excess, small = v - 1.0 + np.exp(-v), v < _SMALL
    excess[small] = v[small] ** 2 * _polynomial(_EXCESS, v[small])
    return excess


def _below(S: Floats) -> Floats:
    """The fraction of the summits whose mean curvature is below S."""
    from scipy.special import erf

    below, small = np.asarray(erf(math.sqrt(1.5) * S) - _LEVEL * S * np.exp(-0.5 * S * S)), S < _SMALL_MEAN
    below[small] = _LEVEL * S[small] ** 5 * _polynomial(_BELOW, S[small] ** 2)
    return below


def _above(S: Floats) -> Floats:
    """The fraction of the summits whose mean curvature is above S."""
    from scipy.special import erfc

    return np.asarray(erfc(math.sqrt(1.5) * S) + _LEVEL * S * np.exp(-0.5 * S * S))


def _polynomial(coefficients: list[float], x: Floats) -> Floats:
    total = np.full_like(x, coefficients[-1])
    for coefficient in reversed(coefficients[:-1]):
        total = total * x + coefficient
    return total


def _stretched(below: Floats, above: Floats) -> Floats:
    """A number that S is nearly proportional to where the fraction below it is small, and smooth in where it is not."""
    return np.asarray(np.where(below > 0.5, -np.log(above), -np.log1p(-np.minimum(below, 0.5))) ** 0.2)


@cache
def _table() -> tuple[Floats, Floats]:
    """Nodes between which a straight line is near enough to S for one step to reach it."""
    S = np.linspace(0.0, _LARGEST_MEAN, _NODES)
    return _stretched(_below(S), _above(S)), S

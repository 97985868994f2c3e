"""Quantiles of the curvatures of summits, by which they are drawn.

S is the mean curvature (k1 + k2)/2 and v the product k1 k2 of the principal curvatures, without units:
(k1 + k2)/2 = sqrt(2 m4/3) S and k1 k2 = (2 m4/3) v, so that 0 < v < S^2.
"""

import math
from functools import cache

import numpy as np
from numpy.polynomial.polynomial import polyval

from roughmdr.numerics.arguments import Floats

_NORM = math.sqrt(6.0 / math.pi)  # of the density of S
_SMALL_V = 0.5  # v up to which v - 1 + exp(-v) is summed as a series, since the difference cancels
_SMALL_S = 1.0  # likewise for the fraction below S
_EXCESS = [(-1.0) ** k / math.factorial(k) for k in range(2, 17)]
_BELOW = [(-0.5) ** k * (3**k - 1 - 2 * k) / (math.factorial(k) * (2 * k + 1)) for k in range(2, 23)]
_MAX_S = 10.0  # no uniform number leads beyond
_TABLE_SIZE = 2049


def mean_curvature(uniform: Floats) -> Floats:
    """Return S [1] below which these fractions of the summits lie; the fractions from 2^-53 to 1 - 2^-53.

    The density of S is sqrt(6/pi) (S^2 - 1 + exp(-S^2)) exp(-S^2/2), which M. S. Longuet-Higgins, Phil. Trans. R. Soc.
    A 249 (1957) 321, gives for all extrema, restricted to those where both curvatures are above 0.
    """
    S = np.interp(_abscissa(uniform, 1.0 - uniform), *_table())
    t = S * S
    excess = _excess(t)
    # From the smaller of the fractions below and above: 1 - u is exact, and the other one is too coarse.
    off, upper = np.empty_like(S), uniform > 0.5
    off[upper] = (1.0 - uniform[upper]) - _above(S[upper])
    off[~upper] = _below(S[~upper]) - uniform[~upper]
    newton = off / (_NORM * excess * np.exp(-0.5 * t))
    return np.asarray(S - newton / (1.0 - 0.5 * newton * S * (2.0 * t / excess - 3.0)))


def product_of_curvatures(uniform: Floats, S: Floats) -> Floats:
    """Return v [1] below which these fractions of the summits with the mean curvature S lie.

    Their density of v is v exp(v) over 0 < v < S^2. With the fraction N(v)/N(S^2), N = (v - 1) exp(v) + 1, this solves
    log N(v) = log u + log N(S^2), which neither cancels nor overflows, by Halley's method.
    """
    v_max = S * S
    log_N = np.log(uniform) + v_max + np.log(_excess(v_max))
    v = 2.0 * np.logaddexp(0.0, 0.5 * (log_N - math.log(2.0)))  # right for small v, and to a logarithm for large ones
    for _ in range(3):
        excess = _excess(v)
        rate = v / excess
        newton = (v + np.log(excess) - log_N) / rate
        v = v - newton / (1.0 - 0.5 * newton * (1.0 + 1.0 / v - rate))
    return np.asarray(v)


def _excess(v: Floats) -> Floats:
    """Return v - 1 + exp(-v)."""
    excess, small = v - 1.0 + np.exp(-v), v < _SMALL_V
    excess[small] = v[small] ** 2 * polyval(v[small], _EXCESS)
    return excess


def _below(S: Floats) -> Floats:
    """Return the fraction of the summits whose mean curvature is below S."""
    from scipy.special import erf

    below, small = np.asarray(erf(math.sqrt(1.5) * S) - _NORM * S * np.exp(-0.5 * S * S)), S < _SMALL_S
    below[small] = _NORM * S[small] ** 5 * polyval(S[small] ** 2, _BELOW)
    return below


def _above(S: Floats) -> Floats:
    """Return the fraction of the summits whose mean curvature is above S."""
    from scipy.special import erfc

    return np.asarray(erfc(math.sqrt(1.5) * S) + _NORM * S * np.exp(-0.5 * S * S))


def _abscissa(below: Floats, above: Floats) -> Floats:
    """Return the abscissa of the table, nearly proportional to S where the fraction below is small."""
    return np.asarray(np.where(below > 0.5, -np.log(above), -np.log1p(-np.minimum(below, 0.5))) ** 0.2)


@cache
def _table() -> tuple[Floats, Floats]:
    """Return a table of S, linear interpolation in which is a sufficient initial guess for one Halley step."""
    S = np.linspace(0.0, _MAX_S, _TABLE_SIZE)
    return _abscissa(_below(S), _above(S)), S

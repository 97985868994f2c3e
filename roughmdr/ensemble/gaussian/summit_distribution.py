"""The joint distribution of height and curvatures of the summits of an isotropic Gaussian surface, from three moments.

Height and second derivatives of such a surface are Gaussian (M. S. Longuet-Higgins, Phil. Trans. R. Soc. A 249 (1957)
321; P. R. Nayak, J. Lubr. Technol. 93 (1971) 398). At a summit both principal curvatures k1, k2 are above 0, and the
density of summits is proportional to k1 k2. With S and v, the mean curvature and the product of the curvatures without
units, (k1 + k2)/2 = sqrt(2 m4/3) S and k1 k2 = (2 m4/3) v, their joint density over 0 < v < S^2 is

    sqrt(6/pi) v exp(v - 3 S^2/2),

and given S the height is normal, of mean sqrt(3 m0/(2 alpha)) S and variance m0 (1 - 3/(2 alpha)). All else here
follows from that by integration.
"""

import math
import sys
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.polynomial.polynomial import polyval
from numpy.typing import ArrayLike

from roughmdr.ensemble.random.distribution import Distribution
from roughmdr.ensemble.random.distribution_families import ndtr, ndtri
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.gauss import unit_gauss
from roughmdr.spectrum import MIN_ALPHA, Moments

SUMMITS_LESS = 1.0 + 16.0 / math.pi - 3.0 * math.sqrt(3.0)
"""Variance that heights of summits lack [m2^2/m4]: S has the mean (4/3) sqrt(6/pi), mean square 2 sqrt(3) + 1/3."""
_TAIL_WIDTH = 12.0  # distance [sqrt(v)] above which a negligible fraction of the summits lies
_NORMAL = Distribution("norm", (), 0.0, 1.0)
_NORM = math.sqrt(6.0 / math.pi)  # factor of the density of S
_SMALL_V = 0.5  # v up to which v - 1 + exp(-v) is summed as a series, since the difference cancels
_SMALL_S = 1.0  # S up to which the fraction below S is summed as a series, for the same reason
_EXCESS = [(-1.0) ** k / math.factorial(k) for k in range(2, 17)]
_BELOW = [(-0.5) ** k * (3**k - 1 - 2 * k) / (math.factorial(k) * (2 * k + 1)) for k in range(2, 23)]
_MAX_S = 10.0  # largest S that a uniform number gives
_TABLE_SIZE = 2049
_PANELS = np.linspace(-10.0, 10.0, 41)  # ends of the panels of integrals over S


class Summits(NamedTuple):
    """Summits that were drawn."""

    height: Floats  # above the mean plane of the surface [m]
    mean_curvature: Floats  # (k1 + k2)/2 [1/m]
    radius: Floats  # 1/sqrt(k1 k2) [m] (J. A. Greenwood, Wear 261 (2006) 191)


class SummitDistribution(NamedTuple):
    """The distribution of the summits of a surface with these moments, whose alpha is above 3/2."""

    moments: Moments

    @property
    def density(self) -> float:
        """Summits per area [1/m2]."""
        return self.moments.summit_density

    @property
    def mean(self) -> float:
        """Mean height above the mean plane, 4 sqrt(m0/(pi alpha)) [m]."""
        return 4.0 * math.sqrt(self.moments.m0 / (math.pi * self.moments.alpha))

    @property
    def sigma(self) -> float:
        """Standard deviation of the heights, sqrt(m0 (1 - (1 + 16/pi - 3 sqrt(3))/alpha)) [m]."""
        return math.sqrt(self.moments.m0 * (1.0 - SUMMITS_LESS / self.moments.alpha))

    @property
    def _parts(self) -> tuple[float, float]:
        """c^2 = 3/(2 alpha), the part of the surface's variance that goes with the mean curvature, and 1 - c^2."""
        alpha = self.moments.alpha
        return MIN_ALPHA / alpha, (alpha - MIN_ALPHA) / alpha

    @property
    def height_spread(self) -> float:
        """Standard deviation of the heights of summits with the same second derivatives [m]."""
        return math.sqrt(self.moments.m0 * self._parts[1])

    def height_range(self, v: float, deviations: float) -> tuple[float, float]:
        """Return bounds [m] on the heights of summits with v: S is at least sqrt(v), and seldom much more."""
        per_S, spread = math.sqrt(self._parts[0] * self.moments.m0), deviations * self.height_spread
        return per_S * math.sqrt(v) - spread, per_S * (math.sqrt(v) + deviations) + spread

    def height_exceeded(self, chance: float) -> float:
        """Return the height [m] that a summit exceeds with this chance, which is at least 1e-20 and below 1.

        The fraction above z is the mean, over the mean curvatures S, of that of the normal heights given S.
        """
        from scipy.optimize import brentq

        (c, t), (nodes, weights) = map(math.sqrt, self._parts), unit_gauss(16)

        def log_excess(zeta: float) -> float:
            turn = (zeta + t * _PANELS) / c  # S at which the fraction above zeta changes
            edges = np.unique(np.concatenate([_PANELS, turn]).clip(0.0, _MAX_S))
            width = np.diff(edges)
            S = edges[:-1, None] + width[:, None] * nodes
            density = _NORM * _excess(S * S) * np.exp(-0.5 * S * S)
            fraction = float(width @ (density * ndtr((c * S - zeta) / t) @ weights))
            return math.log(max(fraction, sys.float_info.min) / chance)

        return math.sqrt(self.moments.m0) * float(brentq(log_excess, -_MAX_S, _MAX_S, xtol=1e-13, rtol=1e-14))

    def draw(self, height: Floats, mean: Floats, product: Floats) -> Summits:
        """Return summits at uniform numbers from 2^-53 to 1 - 2^-53 for height and the curvatures' mean and product."""
        S = mean_curvature(mean)
        c, t = map(math.sqrt, self._parts)
        z = c * S + t * _NORMAL.quantile(height)
        curvature = math.sqrt(2.0 * self.moments.m4 / 3.0) * S
        return Summits(math.sqrt(self.moments.m0) * z, curvature, self.radius(product_of_curvatures(product, S)))

    def radius(self, v: ArrayLike) -> Floats:
        """Return 1/sqrt(k1 k2) = 1/sqrt((2 m4/3) v) [m]."""
        return np.asarray(math.sqrt(MIN_ALPHA / self.moments.m4) / np.sqrt(np.asarray(v, dtype=np.float64)))

    def height_density(self, z: ArrayLike, v: ArrayLike) -> Floats:
        """Return the density [1/m] of the heights z [m] of summits with v [1], at least 0.

        It is exp(-z^2/(2 w^2))/(sqrt(2 pi) w) erfc(y)/erfc(sqrt(3 v/2)), the integral of the joint density over S from
        sqrt(v) to infinity. Here c^2 = 3/(2 alpha), w^2 = (1 - 2 c^2/3) m0, t^2 = 1 - c^2 (the residual variance where
        m0 = 1), y = (sqrt(v) - B)/sqrt(2/A), A = (3 - 2 c^2)/t^2 and B = c z/(sqrt(m0) (3 - 2 c^2)).
        """
        from scipy.special import erfc, erfcx

        c, t = map(math.sqrt, self._parts)
        b, unit = 3.0 - 2.0 * self._parts[0], math.sqrt(self.moments.m0)
        zeta, root = np.asarray(z, dtype=np.float64) / unit, np.sqrt(np.asarray(v, dtype=np.float64))
        y = math.sqrt(0.5 * b) / t * (root - c * zeta / b)
        # Each of the two forms of erfc is used where its exponential is below 1.
        near = erfcx(np.maximum(y, 0.0)) * np.exp(-0.5 * ((zeta - c * root) / t) ** 2)
        far = erfc(np.minimum(y, 0.0)) * np.exp(np.minimum(1.5 * (root * root - zeta * zeta / b), 0.0))
        scale = math.sqrt(1.5 / (math.pi * b)) / unit
        return np.asarray(scale * np.where(y > 0.0, near, far) / erfcx(math.sqrt(1.5) * root))


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


def product_density(v: ArrayLike) -> Floats:
    """Return the density [1] of v over all summits, v exp(v) erfc(sqrt(3 v/2)), at v of at least 0."""
    from scipy.special import erfcx

    v = np.asarray(v, dtype=np.float64)
    return np.asarray(v * np.exp(-0.5 * v) * erfcx(np.sqrt(1.5 * v)))


def _root_density(y: Floats) -> Floats:
    """Return the density of sqrt(v)."""
    return 2.0 * y * product_density(y * y)


def product_of_score(scores: Floats) -> Floats:
    """Return v [1] at the quantiles, among all summits, of normal scores from -9 to 9.

    By Newton's method in y = sqrt(v), on the fractions below and above, each by Gauss's rule over its own side.
    """
    nodes, weights = unit_gauss(40)

    def score(y: Floats) -> Floats:
        below = _root_density(y[:, None] * nodes) @ weights * y
        above = _root_density(y[:, None] + _TAIL_WIDTH * nodes) @ weights * _TAIL_WIDTH
        return np.where(below < above, ndtri(below), -ndtri(above))

    grid = np.concatenate([np.geomspace(1e-9, 0.05, 300), np.linspace(0.05, 12.0, 700)[1:]])
    y = np.interp(scores, score(grid), grid)
    for _ in range(4):
        at_y = score(y)
        slope = _root_density(y) * np.sqrt(2.0 * np.pi) * np.exp(0.5 * at_y**2)
        y = np.clip(y - (at_y - scores) / slope, 0.5 * y, 2.0 * y)
    return np.asarray(y * y)

"""The summits of an isotropic Gaussian surface: the joint law of their heights and curvatures, from three moments.

Height and second derivatives of such a surface are Gaussian (M. S. Longuet-Higgins, Phil. Trans. R. Soc. A 249 (1957)
321; P. R. Nayak, J. Lubr. Technol. 93 (1971) 398). At a summit both principal curvatures k1, k2 are above 0, and
summits are met as often as k1 k2 says. With S and v, the mean curvature and the product of the curvatures without
units (``summit_quantiles``), their density is, all over 0 < v < S^2,

    sqrt(6/pi) v exp(v - 3 S^2/2),

and given S the height is normal, of mean sqrt(3 m0/(2 alpha)) S and variance m0 (1 - 3/(2 alpha)). What stands here
follows from that by integration.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from roughmdr.ensemble.gaussian.quantiles import mean_curvature, product_of_curvatures
from roughmdr.ensemble.random.distributions import Distribution
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.gauss import unit_gauss
from roughmdr.spectrum import MIN_ALPHA, Moments

_WIDE = 12.0  # in sqrt(v): above it by so much lies next to nothing
_NORMAL = Distribution("norm", (), 0.0, 1.0)


class Summits(NamedTuple):
    """Summits, drawn."""

    height: Floats
    """Above the mean plane of the surface [m]."""
    mean_curvature: Floats
    """(k1 + k2)/2 [1/m]."""
    radius: Floats
    """1/sqrt(k1 k2) [m] (J. A. Greenwood, Wear 261 (2006) 191)."""


class SummitDistribution(NamedTuple):
    """The law of the summits of a surface with these moments, whose alpha is above 3/2."""

    moments: Moments

    @property
    def density(self) -> float:
        """Summits of a unit of area [1/m2]."""
        return self.moments.summit_density

    @property
    def mean(self) -> float:
        """Mean height above the mean plane, 4 sqrt(m0/(pi alpha)) [m]."""
        return 4.0 * math.sqrt(self.moments.m0 / (math.pi * self.moments.alpha))

    @property
    def sigma(self) -> float:
        """Standard deviation of the heights, sqrt(m0 (1 - (1 + 16/pi - 3 sqrt(3))/alpha)) [m].

        S has the mean (4/3) sqrt(6/pi) and the mean square 2 sqrt(3) + 1/3.
        """
        broad = 1.0 + 16.0 / math.pi - 3.0 * math.sqrt(3.0)
        return math.sqrt(self.moments.m0 * (1.0 - broad / self.moments.alpha))

    @property
    def _tied(self) -> float:
        """c^2 = 3/(2 alpha), the part of the surface's variance that goes with the mean curvature."""
        return MIN_ALPHA / self.moments.alpha

    @property
    def _loose(self) -> float:
        """1 - c^2, without the difference of numbers that are nearly equal."""
        return (self.moments.alpha - MIN_ALPHA) / self.moments.alpha

    @property
    def height_spread(self) -> float:
        """The least spread of the heights of summits that have all derivatives in common [m]."""
        return math.sqrt(self.moments.m0 * self._loose)

    def height_range(self, v: float, deviations: float) -> tuple[float, float]:
        """The heights [m] that bound those of summits with v: S is at least sqrt(v), and seldom much more."""
        mean, spread = math.sqrt(self._tied * self.moments.m0), deviations * self.height_spread
        return mean * math.sqrt(v) - spread, mean * (math.sqrt(v) + deviations) + spread

    def draw(self, height: Floats, mean: Floats, product: Floats) -> Summits:
        """Summits from independent uniform numbers for the height, the mean curvature and the product of curvatures.

        The numbers from 2^-53 to 1 - 2^-53.
        """
        S = mean_curvature(mean)
        z = math.sqrt(self._tied) * S + math.sqrt(self._loose) * _NORMAL.quantile(height)
        mean_of_both = math.sqrt(2.0 * self.moments.m4 / 3.0) * S
        return Summits(math.sqrt(self.moments.m0) * z, mean_of_both, self.radius(product_of_curvatures(product, S)))

    def radius(self, v: ArrayLike) -> Floats:
        """1/sqrt(k1 k2) = 1/sqrt((2 m4/3) v) [m]."""
        return np.asarray(math.sqrt(MIN_ALPHA / self.moments.m4) / np.sqrt(np.asarray(v, dtype=np.float64)))

    def height_density(self, z: ArrayLike, v: ArrayLike) -> Floats:
        """The density [1/m] of the heights z [m] of those summits that have v [1], at least 0.

        With c^2 = 3/(2 alpha), w^2 = (1 - 2 c^2/3) m0 and the residual variance t^2 = 1 - c^2 of a surface of m0 = 1 it
        is exp(-z^2/(2 w^2))/(sqrt(2 pi) w) erfc(y)/erfc(sqrt(3 v/2)), where y = (sqrt(v) - B)/sqrt(2/A),
        A = (3 - 2 c^2)/t^2 and B = c z/(sqrt(m0) (3 - 2 c^2)): the joint density over S from sqrt(v) to infinity.
        """
        from scipy.special import erfc, erfcx

        c, t, kept = math.sqrt(self._tied), math.sqrt(self._loose), 3.0 - 2.0 * self._tied
        unit = math.sqrt(self.moments.m0)
        zeta, root = np.asarray(z, dtype=np.float64) / unit, np.sqrt(np.asarray(v, dtype=np.float64))
        y = math.sqrt(0.5 * kept) / t * (root - c * zeta / kept)
        # Of the two forms of erfc each is taken where its exponential is below 1.
        near = erfcx(np.maximum(y, 0.0)) * np.exp(-0.5 * ((zeta - c * root) / t) ** 2)
        far = erfc(np.minimum(y, 0.0)) * np.exp(np.minimum(1.5 * (root * root - zeta * zeta / kept), 0.0))
        scale = math.sqrt(1.5 / (math.pi * kept)) / unit
        return np.asarray(scale * np.where(y > 0.0, near, far) / erfcx(math.sqrt(1.5) * root))


def product_of_score(scores: Floats) -> Floats:
    """v [1] that lies as high among all summits as a normal score from -9 to 9 does among its own.

    By Newton's method in y = sqrt(v), on the fractions below and above, each by Gauss's rule over its own side.
    """
    from scipy.special import ndtri

    nodes, weights = unit_gauss(40)

    def score(y: Floats) -> Floats:
        below = _part(y[:, None] * nodes) @ weights * y
        above = _part(y[:, None] + _WIDE * nodes) @ weights * _WIDE
        return np.where(below < above, ndtri(below), -ndtri(above))

    grid = np.concatenate([np.geomspace(1e-9, 0.05, 300), np.linspace(0.05, 12.0, 700)[1:]])
    y = np.interp(scores, score(grid), grid)
    for _ in range(4):
        own = score(y)
        slope = _part(y) * np.sqrt(2.0 * np.pi) * np.exp(0.5 * own**2)
        y = np.clip(y - (own - scores) / slope, 0.5 * y, 2.0 * y)
    return np.asarray(y * y)


def _part(y: Floats) -> Floats:
    """The density of sqrt(v)."""
    return 2.0 * y * product_density(y * y)


def product_density(v: ArrayLike) -> Floats:
    """The density [1] of v over all summits, v exp(v) erfc(sqrt(3 v/2)), at v of at least 0."""
    from scipy.special import erfcx

    v = np.asarray(v, dtype=np.float64)
    return np.asarray(v * np.exp(-0.5 * v) * erfcx(np.sqrt(1.5 * v)))

"""The joint distribution of height and curvatures of the summits of an isotropic Gaussian surface, from three moments.

Height and second derivatives of such a surface are Gaussian (M. S. Longuet-Higgins, Phil. Trans. R. Soc. A 249 (1957)
321; P. R. Nayak, J. Lubr. Technol. 93 (1971) 398). At a summit both principal curvatures k1, k2 are above 0, and the
density of summits is proportional to k1 k2. With S and v, the mean curvature and the product of the curvatures without
units (``quantiles``), their joint density over 0 < v < S^2 is

    sqrt(6/pi) v exp(v - 3 S^2/2),

and given S the height is normal, of mean sqrt(3 m0/(2 alpha)) S and variance m0 (1 - 3/(2 alpha)). All else here
follows from that by integration.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from roughmdr.ensemble.gaussian.quantiles import mean_curvature, product_of_curvatures
from roughmdr.ensemble.random.distribution import Distribution
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.gauss import unit_gauss
from roughmdr.spectrum import MIN_ALPHA, Moments

_TAIL_WIDTH = 12.0  # in sqrt(v): a negligible fraction lies farther above
_NORMAL = Distribution("norm", (), 0.0, 1.0)


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
        """Standard deviation of the heights, sqrt(m0 (1 - (1 + 16/pi - 3 sqrt(3))/alpha)) [m].

        S has the mean (4/3) sqrt(6/pi) and the mean square 2 sqrt(3) + 1/3.
        """
        numerator = 1.0 + 16.0 / math.pi - 3.0 * math.sqrt(3.0)
        return math.sqrt(self.moments.m0 * (1.0 - numerator / self.moments.alpha))

    @property
    def _c2(self) -> float:
        """c^2 = 3/(2 alpha), the part of the surface's variance that goes with the mean curvature."""
        return MIN_ALPHA / self.moments.alpha

    @property
    def _residual(self) -> float:
        """1 - c^2, without cancellation."""
        return (self.moments.alpha - MIN_ALPHA) / self.moments.alpha

    @property
    def height_spread(self) -> float:
        """Standard deviation of the heights of summits with the same second derivatives [m]."""
        return math.sqrt(self.moments.m0 * self._residual)

    def height_range(self, v: float, deviations: float) -> tuple[float, float]:
        """Return bounds [m] on the heights of summits with v: S is at least sqrt(v), and seldom much more."""
        per_S, spread = math.sqrt(self._c2 * self.moments.m0), deviations * self.height_spread
        return per_S * math.sqrt(v) - spread, per_S * (math.sqrt(v) + deviations) + spread

    def draw(self, height: Floats, mean: Floats, product: Floats) -> Summits:
        """Return summits at independent uniform numbers for height, mean curvature and product of curvatures.

        The numbers are from 2^-53 to 1 - 2^-53.
        """
        S = mean_curvature(mean)
        z = math.sqrt(self._c2) * S + math.sqrt(self._residual) * _NORMAL.quantile(height)
        curvature = math.sqrt(2.0 * self.moments.m4 / 3.0) * S
        return Summits(math.sqrt(self.moments.m0) * z, curvature, self.radius(product_of_curvatures(product, S)))

    def radius(self, v: ArrayLike) -> Floats:
        """Return 1/sqrt(k1 k2) = 1/sqrt((2 m4/3) v) [m]."""
        return np.asarray(math.sqrt(MIN_ALPHA / self.moments.m4) / np.sqrt(np.asarray(v, dtype=np.float64)))

    def height_density(self, z: ArrayLike, v: ArrayLike) -> Floats:
        """Return the density [1/m] of the heights z [m] of summits with v [1], at least 0.

        With c^2 = 3/(2 alpha), w^2 = (1 - 2 c^2/3) m0 and the residual variance t^2 = 1 - c^2 of a surface of m0 = 1 it
        is exp(-z^2/(2 w^2))/(sqrt(2 pi) w) erfc(y)/erfc(sqrt(3 v/2)), where y = (sqrt(v) - B)/sqrt(2/A),
        A = (3 - 2 c^2)/t^2 and B = c z/(sqrt(m0) (3 - 2 c^2)): the joint density over S from sqrt(v) to infinity.
        """
        from scipy.special import erfc, erfcx

        c, t, b = math.sqrt(self._c2), math.sqrt(self._residual), 3.0 - 2.0 * self._c2
        unit = math.sqrt(self.moments.m0)
        zeta, root = np.asarray(z, dtype=np.float64) / unit, np.sqrt(np.asarray(v, dtype=np.float64))
        y = math.sqrt(0.5 * b) / t * (root - c * zeta / b)
        # Each of the two forms of erfc is used where its exponential is below 1.
        near = erfcx(np.maximum(y, 0.0)) * np.exp(-0.5 * ((zeta - c * root) / t) ** 2)
        far = erfc(np.minimum(y, 0.0)) * np.exp(np.minimum(1.5 * (root * root - zeta * zeta / b), 0.0))
        scale = math.sqrt(1.5 / (math.pi * b)) / unit
        return np.asarray(scale * np.where(y > 0.0, near, far) / erfcx(math.sqrt(1.5) * root))


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
    from scipy.special import ndtri

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

"""The summits of an isotropic Gaussian surface: the joint density of heights and curvatures, and means over it.

P. R. Nayak, J. Lubr. Technol. 93 (1971) 398. With a = m4/3, mean curvature (k1 + k2)/2 = sqrt(2 a) S and half the
difference of the curvatures sqrt(2 a q), the density of (S, q) over all summits is
sqrt(6/pi) (S^2 - q) exp(-q - S^2/2), 0 < q < S^2. The height z = sqrt(m0) zeta is normal given S, whatever q is:
zeta and S correlate by rho = sqrt(3/(2 alpha)), and exp(-S^2/2) is that of a normal S. k1 k2 = 2 a (S^2 - q).
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.chebyshev import PiecewiseChebyshev
from roughmdr.numerics.quadrature import Rows, panel_rule
from roughmdr.schema.arguments import check_values
from roughmdr.spectrum import MIN_ALPHA, Moments
from roughmdr.theory.equal_summits import Variable, check_variable, representable
from roughmdr.theory.heights import NORMAL_EDGES, Heights

# n and p of delta^n (k1 k2)^(-p/2), to which force, area and number of a contact are proportional.
_POWERS: dict[Variable, tuple[float, float]] = {
    "pressure": (1.5, 0.5),
    "contact_fraction": (1.0, 1.0),
    "contact_density": (0.0, 0.0),
}
# b/a from contacts so narrow that they are negligible, since their fraction goes as (b/a)^3, to circular ones.
_RATIOS = np.concatenate([[0.0], 2.0 ** np.arange(-20, -1), 1.0 - 2.0 ** np.arange(-1, -7, -1), [1.0]])
_S_MAX = 64.0  # heights up to 39, and 9 deviations beyond


class Ellipses(NamedTuple):
    """Hertz's contacts of paraboloids with principal curvatures k1 >= k2 by the ratio b/a of their axes."""

    spread: Floats  # (k1 - k2)/(k1 + k2)
    spread_slope: Floats  # its derivative with respect to b/a
    force: Floats  # P/[4/3 E* (k1 k2)^(-1/4) delta^(3/2)]
    area: Floats  # A/[pi (k1 k2)^(-1/2) delta]

    @classmethod
    def of(cls, ratio: Floats) -> "Ellipses":
        """Return the contacts at a given delta, from Hertz's theory (K. L. Johnson, Contact Mechanics, 1985, sec. 4.2).

        With e^2 = 1 - (b/a)^2, D = (K - E)/e^2 and B = K - D, which do not cancel for nearly circular contacts:
        k2/k1 = (b/a)^2 D/B, k2 a^2 = 2 delta D/K and P = 2 pi/3 E* delta a/K.
        """
        from scipy.special import ellipkm1, elliprd

        ratio2 = ratio * ratio
        K, D = ellipkm1(ratio2), elliprd(0.0, ratio2, 1.0) / 3.0
        B = K - D
        quotient = ratio2 * D / B
        # d log(D/B)/d log(b/a), from the derivatives of K and E.
        dD, dK = (D * ratio2 - B) / (1.0 - ratio2), -B
        quotient_slope = (2.0 + dD / D - (dK - dD) / B) * quotient / ratio
        return cls(
            (1.0 - quotient) / (1.0 + quotient),
            -2.0 * quotient_slope / (1.0 + quotient) ** 2,
            np.pi / 2.0 * np.sqrt(2.0) * (D * B / ratio2) ** 0.25 / K**1.5,
            2.0 * np.sqrt(D * B) / K,
        )


def mean_over_summits(
    elliptic: bool, separation: ArrayLike, effective_modulus: float, moments: Moments, variable: Variable
) -> Floats:
    """Return ``variable`` at separations [m] from the mean plane, with elliptic contacts or with circular ones."""
    given = check_values("separation", separation, "m")
    power, _ = _POWERS[check_variable(variable)]
    deviation, curvature = math.sqrt(moments.m0), math.sqrt(2.0 / 3.0) * math.sqrt(moments.m4)
    unit = {
        "pressure": 4.0 / 3.0 * effective_modulus * deviation * math.sqrt(deviation / curvature),
        "contact_fraction": math.pi * deviation / curvature,
        "contact_density": 1.0,
    }[variable]
    heights = _weighted(elliptic, variable, moments.alpha)
    with np.errstate(over="ignore", invalid="ignore"):  # refused below
        h = given.ravel() / deviation
        above = np.maximum(heights.edges[0] - h, 0.0)

        def value(rows: Rows, beyond: Floats) -> Floats:
            return np.asarray((above[rows, None] + beyond) ** power)

        return representable(variable, moments.summit_density * unit * heights.mean(h, value), given)


def _weighted(elliptic: bool, variable: Variable, alpha: float) -> Heights:
    """Return the density of heights zeta of the summits, weighted with the factor of their curvatures in ``variable``.

    It is phi(zeta) Q(zeta) with Q = ∫ phi(x) G(rho zeta + c x) dx over S = rho zeta + c x > 0, c^2 = 1 - rho^2.
    """
    rho, c = math.sqrt(MIN_ALPHA / alpha), math.sqrt((alpha - MIN_ALPHA) / alpha)
    weight = _weight_of_curvature(elliptic, variable)
    nodes, panel_weights = (part.ravel() for part in panel_rule(np.linspace(0.0, 1.0, 7)))

    def smoothed(zeta: Floats) -> Floats:
        """Q, over the root of the distance to S = 0, where G goes as a half-integer power."""
        zeta = zeta[:, None]
        first = np.maximum(-rho * zeta / c, -9.0)
        root_length = np.sqrt(np.maximum(first, 0.0) + 10.0 - first)
        y = root_length * nodes
        x = first + y * y
        S = np.maximum(rho * zeta + c * x, 0.0)
        return np.asarray(np.sum(2.0 * root_length * panel_weights * y * np.exp(-0.5 * x * x) * weight(S), axis=1))

    # Q bends at heights of about c/rho, where S = 0 comes within its deviation.
    bends = c * 2.0 ** np.arange(-1, math.ceil(math.log2(NORMAL_EDGES[-1] / c)))
    edges = np.concatenate([NORMAL_EDGES[[0, -1]], [0.0], -bends[bends < -NORMAL_EDGES[0]], bends])
    Q = PiecewiseChebyshev.of(smoothed, np.unique(edges), 24)
    return Heights(lambda zeta: np.exp(-0.5 * zeta * zeta) / (2.0 * math.pi) * Q(zeta), NORMAL_EDGES)


def _weight_of_curvature(elliptic: bool, variable: Variable) -> Callable[[Floats], Floats]:
    """Return G(S) = sqrt(12) ∫ (S^2 - q) exp(-q) (S^2 - q)^(-p/2) f dq over 0 < q < S^2, p and f those of ``variable``.

    sqrt(12) = sqrt(6/pi) sqrt(2 pi). With q = (r S)^2 the integral is over the spread r of the curvatures, which is a
    function of the ratio of the axes of the contact.
    """
    ratio, panel_weights = (part.ravel() for part in panel_rule(_RATIOS))
    ellipses = Ellipses.of(ratio)
    r, dr = ellipses.spread, -panel_weights * ellipses.spread_slope
    _, p = _POWERS[variable]
    shape = {"pressure": ellipses.force, "contact_fraction": ellipses.area, "contact_density": np.ones_like(r)}
    factor = shape[variable] if elliptic else np.ones_like(r)
    weights = math.sqrt(12.0) * 2.0 * (1.0 - r * r) ** (1.0 - 0.5 * p) * factor * r * dr

    def over_power(S: Floats) -> Floats:
        return np.asarray(np.exp(-((S[:, None] * r) ** 2)) @ weights)

    table = PiecewiseChebyshev.of(over_power, np.append(0.0, 2.0 ** np.arange(0, math.log2(_S_MAX) + 0.5, 0.5)), 20)
    return lambda S: np.asarray(S ** (4.0 - p) * table(S))

"""Hertz's elliptic contact, relative to the circular one of the same geometric mean curvature."""

from typing import NamedTuple

import numpy as np

from roughmdr.numerics.arguments import Floats


class Ellipses(NamedTuple):
    """Contacts of paraboloids with principal curvatures k1 >= k2 by the ratio b/a of their axes."""

    spread: Floats
    """(k1 - k2)/(k1 + k2)."""
    spread_slope: Floats
    """Its derivative with respect to b/a."""
    force: Floats
    """P/[4/3 E* (k1 k2)^(-1/4) delta^(3/2)]."""
    area: Floats
    """A/[pi (k1 k2)^(-1/2) delta]."""

    @classmethod
    def of(cls, ratio: Floats) -> "Ellipses":
        """Return them from K. L. Johnson, Contact Mechanics (1985), eq. (4.26) to (4.32), at a given delta.

        With e^2 = 1 - (b/a)^2, D = (K - E)/e^2 and B = K - D, which do not cancel for nearly circular contacts:
        k2/k1 = (b/a)^2 D/B, k2 a^2 = 2 delta D/K and P = 2 pi/3 E* delta a/K.
        """
        from scipy.special import ellipkm1, elliprd

        ratio2 = ratio * ratio
        K = ellipkm1(ratio2)
        D = elliprd(0.0, ratio2, 1.0) / 3.0
        B = K - D
        quotient = ratio2 * D / B
        # d log(D/B)/d log(b/a), from the derivatives of K and E.
        eccentricity2 = 1.0 - ratio2
        dD = (D * ratio2 - B) / eccentricity2
        dK = -B
        quotient_slope = (2.0 + dD / D - (dK - dD) / B) * quotient / ratio
        return cls(
            (1.0 - quotient) / (1.0 + quotient),
            -2.0 * quotient_slope / (1.0 + quotient) ** 2,
            np.pi / 2.0 * np.sqrt(2.0) * (D * B / ratio2) ** 0.25 / K**1.5,
            2.0 * np.sqrt(D * B) / K,
        )

"""The expected force of paraboloids, slow and plain: a double integral with many digits, by nothing of the package.

Over the heights by the contact radius a, in which both Hertz's law and JKR's are closed forms and the fold is smooth;
over the radius of the tip by the trapezoidal rule in its normal score, which converges as fast as Gauss's.
"""

import math
from typing import NamedTuple

from mpmath import mp, mpf


class Rough(NamedTuple):
    """Paraboloids whose heights are "normal" about 0 or "exponential" from 0 upwards; all in SI."""

    heights: str
    std: float
    """Of the heights [m]."""
    radius: float
    """Mean radius of the tips [m]."""
    radius_std: float
    """Of the lognormal law of the radius [m]; 0 for equal tips."""
    modulus: float
    work: float = 0.0

    def force(self, separation: float, closest: float | None = None, digits: int = 25) -> float:
        """Expected force [N] of one asperity at a separation [m], on the way in.

        On the way back the flat has been as near as ``closest`` [m]. Not where some tips of this radius law have let go
        of their lowest summits and others not: there the trapezoidal rule would meet a kink.
        """
        with mp.workdps(digits + 5):
            h = mpf(separation)
            nearest = h if closest is None else mpf(closest)
            if not self.radius_std:
                return float(self._tip(mpf(self.radius), h, nearest, digits))
            spread = mp.sqrt(mp.log1p((mpf(self.radius_std) / self.radius) ** 2))
            median = self.radius * mp.exp(-spread * spread / 2)
            step, end = _trapezoid(digits)
            total = mpf(0)
            for number in range(-end, end + 1):
                score = number * step
                share = step * mp.npdf(score)
                total += share * self._tip(median * mp.exp(spread * score), h, nearest, digits)
            return float(total)

    def _tip(self, R: mpf, h: mpf, nearest: mpf, digits: int) -> mpf:
        """Of tips of radius R."""
        E, w = mpf(self.modulus), mpf(self.work)
        floor = nearest if self.heights == "normal" else max(nearest, 0)
        fold = mp.cbrt(mp.pi * w * R * R / (8 * E))
        begin, end = (_contact_radius(z - h, R, mp.sqrt(2 * mp.pi * w / E), fold) for z in (floor, self._top(digits)))
        if not begin < end:
            return mpf(0)

        def bears(a: mpf) -> mpf:
            stretch = mp.sqrt(2 * mp.pi * a * w / E)
            force = 4 * E * a**3 / (3 * R) - 2 * E * a * stretch
            return force * self._density(h + a * a / R - stretch) * (2 * a / R - stretch / (2 * a))

        return mp.quad(bears, mp.linspace(begin, end, 7), method="gauss-legendre")

    def _top(self, digits: int) -> mpf:
        """A height that one of 10^(digits + 4) summits reaches: the force grows while they get fewer."""
        decades = (digits + 4) * mp.log(10)
        return self.std * (decades if self.heights == "exponential" else mp.sqrt(2 * decades))

    def _density(self, z: mpf) -> mpf:
        if self.heights == "exponential":
            return mp.exp(-z / self.std) / self.std
        return mp.npdf(z, 0, self.std)


def _trapezoid(digits: int) -> tuple[mpf, int]:
    """Step and number of steps to each side: exp(-2 pi^2/step^2) and exp(-end^2/2) are both 10^-(digits + 4)."""
    decades = (digits + 4) * math.log(10.0)
    step = mp.pi * mp.sqrt(2 / mpf(decades))
    return step, math.ceil(math.sqrt(2.0 * decades) / step)


def _contact_radius(indentation: mpf, R: mpf, stretch: mpf, fold: mpf) -> mpf:
    """a with a^2/R - stretch sqrt(a) = indentation, or the fold: by Newton's rule from above, where all is convex."""
    if indentation <= fold * fold / R - stretch * mp.sqrt(fold):
        return fold
    a = 2 * fold + 2 * mp.sqrt(R * max(indentation, 0)) + mp.cbrt((stretch * R) ** 2)
    while True:
        root = mp.sqrt(a)
        change = (a * a / R - stretch * root - indentation) / (2 * a / R - stretch / (2 * root))
        if change <= mp.eps * 1000 * a:  # below 0 it is a rounding: near the fold there are such
            return a
        a -= change

"""Expected force and area of paraboloids: double integrals with many digits, by nothing of the package.

The variable of integration over the heights is the contact radius a, in which both Hertz's law and JKR's are closed
forms and the fold is smooth. The integral over the radius of the tip is by the trapezoidal rule in its normal score,
which converges as fast as Gauss's; by two rules where some tips have detached from their lowest summits.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

from mpmath import mp, mpf

Quantity = Callable[[mpf, mpf], mpf]  # a quantity of a contact of radius a [m] of a tip of radius R [m]


class Rough(NamedTuple):
    """Paraboloids whose heights are "normal" about 0 or "exponential" from 0 upwards; all in SI units."""

    heights: str
    std: float  # standard deviation of the heights [m]
    radius: float  # mean radius of the tips [m]
    radius_std: float  # standard deviation of the lognormal radius [m]; 0 for equal tips
    effective_modulus: float
    work: float = 0.0

    def force(self, separation: float, closest: float | None = None, digits: int = 25) -> float:
        """Return the expected force [N] of one asperity at a separation [m].

        In loading; in unloading, where the flat has been as near as ``closest`` [m].
        """
        return self._mean(self._force, separation, closest, digits)

    def area(self, separation: float, closest: float | None = None, digits: int = 25) -> float:
        """Return the expected contact area [m2] likewise."""
        return self._mean(lambda a, R: mp.pi * a * a, separation, closest, digits)

    def _force(self, a: mpf, R: mpf) -> mpf:
        E, w = mpf(self.effective_modulus), mpf(self.work)
        return 4 * E * a**3 / (3 * R) - 2 * E * a * mp.sqrt(2 * mp.pi * a * w / E)

    def _mean(self, quantity: Quantity, separation: float, closest: float | None, digits: int) -> float:
        """Return the mean of a quantity over the radii of the tips."""
        with mp.workdps(digits + 5):
            h = mpf(separation)
            nearest = h if closest is None else mpf(closest)
            if not self.radius_std:
                return float(self._tip(quantity, mpf(self.radius), h, nearest, digits))
            spread = mp.sqrt(mp.log1p((mpf(self.radius_std) / self.radius) ** 2))
            median = self.radius * mp.exp(-spread * spread / 2)

            def integrand(score: mpf) -> mpf:
                return mp.npdf(score) * self._tip(quantity, median * mp.exp(spread * score), h, nearest, digits)

            step, end = _trapezoid(digits)
            if self.work and h > nearest:  # where tips of a radius detach from their lowest summits
                last = (4 * (h - nearest) / 3) ** 3 * (self.effective_modulus / (mp.pi * self.work)) ** 2
                kink = mp.log(last / median) / spread
                if abs(kink) < step * end:
                    return float(mp.quad(integrand, [-step * end, kink, step * end]))
            return float(step * mp.fsum(integrand(number * step) for number in range(-end, end + 1)))

    def _tip(self, quantity: Quantity, R: mpf, h: mpf, nearest: mpf, digits: int) -> mpf:
        """Return the mean of a quantity of tips of radius R."""
        E, w = mpf(self.effective_modulus), mpf(self.work)
        floor = nearest if self.heights == "normal" else max(nearest, 0)
        fold = mp.cbrt(mp.pi * w * R * R / (8 * E))
        begin, end = (_contact_radius(z - h, R, mp.sqrt(2 * mp.pi * w / E), fold) for z in (floor, self._top(digits)))
        if not begin < end:
            return mpf(0)

        def integrand(a: mpf) -> mpf:
            stretch = mp.sqrt(2 * mp.pi * a * w / E)
            return quantity(a, R) * self._density(h + a * a / R - stretch) * (2 * a / R - stretch / (2 * a))

        return mp.quad(integrand, mp.linspace(begin, end, 7), method="gauss-legendre")

    def _top(self, digits: int) -> mpf:
        """Return a height that one of 10^(digits + 4) summits reaches: the force grows as they become fewer."""
        decades = (digits + 4) * mp.log(10)
        return self.std * (decades if self.heights == "exponential" else mp.sqrt(2 * decades))

    def _density(self, z: mpf) -> mpf:
        if self.heights == "exponential":
            return mp.exp(-z / self.std) / self.std
        return mp.npdf(z, 0, self.std)


def _trapezoid(digits: int) -> tuple[mpf, int]:
    """Return step and steps to each side, so that exp(-2 pi^2/step^2) and exp(-end^2/2) are 10^-(digits + 4)."""
    decades = (digits + 4) * math.log(10.0)
    step = mp.pi * mp.sqrt(2 / mpf(decades))
    return step, math.ceil(math.sqrt(2.0 * decades) / step)


def _contact_radius(indentation: mpf, R: mpf, stretch: mpf, fold: mpf) -> mpf:
    """Return a with a^2/R - stretch sqrt(a) = indentation, or the fold; by Newton's method from above (convex)."""
    if indentation <= fold * fold / R - stretch * mp.sqrt(fold):
        return fold
    a = 2 * fold + 2 * mp.sqrt(R * max(indentation, 0)) + mp.cbrt((stretch * R) ** 2)
    while True:
        root = mp.sqrt(a)
        change = (a * a / R - stretch * root - indentation) / (2 * a / R - stretch / (2 * root))
        if change <= mp.eps * 1000 * a:  # below 0 it is a rounding, as happens near the fold
            return a
        a -= change

"""One viscoelastic contact with F_el = c delta^p, in time: the integrals of Lee and Radok and of Ting as they stand.

E. H. Lee, J. R. M. Radok, J. Appl. Mech. 27 (1960) 438; T. C. T. Ting, J. Appl. Mech. 33 (1966) 845.
"""

from collections.abc import Sequence
from typing import NamedTuple

from oracles.multiprecision import Number, mp, root


class Triangle(NamedTuple):
    """A flat that comes from first touch at time 0 with ``speed``, dwells at ``depth`` and retracts."""

    depth: Number
    speed: Number
    retraction_speed: Number
    dwell: Number
    series: Sequence[tuple[Number, Number]]
    """Share and relaxation time of each term."""

    def modulus(self, t: Number) -> Number:
        """Return phi(t)."""
        return 1 - sum(mp.mpf(g) * (1 - mp.exp(-t / tau)) for g, tau in self.series)

    @property
    def turn(self) -> Number:
        """Time at which loading ends."""
        return mp.mpf(self.depth) / self.speed

    @property
    def release(self) -> Number:
        """Time at which retraction begins."""
        return self.turn + self.dwell

    def contact_time(self, t: Number) -> Number:
        """Return t1, the time of loading at which the contact was as it is at t; 0 where it is lost."""
        if t <= self.release:
            return min(t, self.turn)

        def imbalance(t1: Number) -> Number:
            loaded = self.speed * mp.quad(lambda s: self.modulus(t - s), [t1, self.turn])
            return loaded - self.retraction_speed * mp.quad(lambda s: self.modulus(t - s), [self.release, t])

        return root(imbalance, mp.mpf(0), self.turn) if imbalance(mp.mpf(0)) > 0 else mp.mpf(0)

    def force(self, t: Number, coefficient: Number, exponent: Number) -> Number:
        """Return the force at t of a contact with the elastic force c delta^p."""
        t1, p, v = self.contact_time(t), mp.mpf(exponent), self.speed

        def rate(x: Number) -> Number:  # s = x^2, since the slope of the force begins as a root
            s = x * x
            return self.modulus(t - s) * coefficient * p * v * (v * s) ** (p - 1) * 2 * x

        return mp.quad(rate, mp.linspace(0, mp.sqrt(t1), 5)) if t1 > 0 else mp.mpf(0)

"""The cohesive zone of one contact in its fields: a < x < c, where u1 = -beta sqrt(c^2 - x^2), beta = 2 sigma0/E*.

With m = sqrt(c^2 - a^2), and p and u from u1 as for the springs of the contact, the zone adds to pi p/E* within the
contact -beta atan(m/sqrt(a^2 - r^2)), and p = -sigma0 beyond; to pi u/2 beyond the contact -beta Z, with

    Z(r) = ∫_a^min(r, c) sqrt((c^2 - x^2)/(r^2 - x^2)) dx

in Carlson's integrals R_F and R_D, which do not cancel where the zone is thin (B. C. Carlson, Numer. Algorithms 10
(1995) 13).
"""

import math
from typing import Any, NamedTuple

import numpy as np

from roughmdr.asperity.contact import Contact
from roughmdr.kernels.profile.layout import JUNCTION, STRENGTH
from roughmdr.numerics.arguments import Floats


class Zone(NamedTuple):
    """The zone of one contact, in metres."""

    inner: float
    """a [m]."""
    extent: float
    """m = sqrt(c^2 - a^2) [m]; 0 where there is no zone."""
    pull: float
    """beta [1]."""
    strength: float
    """sigma0 [Pa]."""
    t: float
    """The parameter t of the profile at a."""

    @property
    def outer(self) -> float:
        """The cohesive radius c [m]."""
        return math.hypot(self.inner, self.extent)

    @property
    def stretch(self) -> float:
        """delta - g(a) [m] where there is a zone: -beta m."""
        return -self.pull * self.extent

    @classmethod
    def of(cls, contact: Contact, state: float) -> "Zone":
        """Return the zone of an equilibrium under adhesion with a range."""
        kernels, params, width = contact.kernels, contact.params, contact.radius
        strength = contact.adhesion.strength
        pull = 2.0 * strength / contact.effective_modulus
        if contact.shape.pinned:
            m = min(max(-state / float(params[STRENGTH]), 0.0), 1.0)
            return cls(width * float(kernels.radius(state, params)), width * m, pull, strength, 0.0)
        if state <= 1.0:
            return cls(0.0, width * state * float(params[JUNCTION]), pull, strength, 0.0)
        edge: Any = vars(kernels)["zone_edge"](state, params)
        return cls(width * edge[1], width * edge[2], pull, strength, float(edge[0]))

    def pressure_share(self, r: Floats) -> Floats:
        """Return the part of the zone in pi p/E* at radii [m] within the contact."""
        leg = np.sqrt(self.inner - r) * np.sqrt(self.inner + r)
        return np.asarray(-self.pull * np.arctan2(self.extent, leg))

    def displacement_share(self, r: Floats) -> Floats:
        """Return the part of the zone in pi u/2 [m] at radii [m] outside the contact: -beta Z(r)."""
        within = r <= self.outer
        share = np.empty_like(r)
        share[within], share[~within] = self._within(r[within]), self._beyond(r[~within])
        return -self.pull * share

    def _within(self, r: Floats) -> Floats:
        """Return Z for a <= r <= c: sqrt(q) n/r [R_F(a^2/r^2, m^2/q, 1) + n^2/(3 q) R_D(...)], q = c^2 - r^2, n^2 =
        r^2 - a^2; at r = c it is c - a, on the axis c pi/2.
        """
        from scipy.special import elliprd, elliprf

        a, c, m = self.inner, self.outer, self.extent
        found = np.full(r.shape, 0.5 * math.pi * c)
        found[r == c] = m * m / (c + a)
        inside = (r > 0.0) & (r < c)
        at = r[inside]
        n, root = np.sqrt(at - a) * np.sqrt(at + a), np.sqrt(c - at) * np.sqrt(c + at)
        x, y, near = (a / at) ** 2, (m / root) ** 2, n / root
        found[inside] = n / at * root * (elliprf(x, y, 1.0) + near * near / 3.0 * elliprd(x, y, 1.0))
        return found

    def _beyond(self, r: Floats) -> Floats:
        """Return Z for r > c: m^3/(3 c sqrt(r^2 - c^2)) R_D(a^2/c^2, (r^2 - a^2)/(r^2 - c^2), 1)."""
        from scipy.special import elliprd

        a, c, m = self.inner, self.outer, self.extent
        root = np.sqrt(r - c) * np.sqrt(r + c)
        leg = np.sqrt(r - a) * np.sqrt(r + a)
        return np.asarray(m / root * m * (m / c) / 3.0 * elliprd((a / c) ** 2, (leg / root) ** 2, 1.0))

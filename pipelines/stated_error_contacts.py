"""One asperity along a path of the flat, with many digits and from the slope f' of its profile alone.

A contact walks on the stable branches of its equilibrium curve: down at the foot of one to the branch within it, or to
no contact; up at its end to the next; on at first touch.
"""

import math
from collections.abc import Iterable, Iterator
from typing import Any

from oracles.jkr import Asperity, Branch
from oracles.multiprecision import Number, mp
from oracles.profiles import Piece, Profile, SphereProfile, profile_of
from scipy.optimize import brentq

from roughmdr.kernels.adhesion import release_stretch
from roughmdr.shapes import Cone, Paraboloid, PowerLaw, PowerSeries, Shape, Sphere, Tabulated

DIGITS = 40
_NEAR = 1e-11  # of the way from the foot of a branch: so near its tangent is right to the square of it
_MOST = 100  # steps of Newton's method
_FARTHEST = 34.0  # from the middle of a branch, in the logarithm: doubles end there


class Powers(Profile):
    """f = sum of c r^n in closed form, for any exponents (H 12, 26)."""

    def __init__(self, terms: dict[Number, Number]) -> None:
        super().__init__([Piece(mp.mpf(0), None, ((mp.mpf(1), 0.0),))])
        self.terms = {n: mp.sqrt(mp.pi) / 2 * n * mp.gamma(n / 2) / mp.gamma((n + 1) / 2) * c for n, c in terms.items()}

    def mdr(self, a: Number) -> tuple[Number, Number, Number]:
        """g(a) [m], g'(a) [1] and G(a) [m2]."""
        parts = {n: g_at_1 * a**n for n, g_at_1 in self.terms.items()}
        slope = mp.fsum(n * g for n, g in parts.items()) / a
        return mp.fsum(parts.values()), slope, a * mp.fsum(g / (n + 1) for n, g in parts.items())


class Ball(SphereProfile):
    """A sphere in closed form: its quadrature is slow next to the equator."""

    def mdr(self, a: Number) -> tuple[Number, Number, Number]:
        """g(a) [m], g'(a) [1] and G(a) [m2]."""
        R: Number = self.end
        angle, gap = mp.atanh(a / R), (R - a) * (R + a)
        return a * angle, angle + a * R / gap, (R * a - gap * angle) / 2


def profile(shape: Shape) -> Profile:
    """The profile of a shape."""
    given: dict[str, Any] = dict(shape.parameters)
    match shape:
        case Paraboloid():
            return Powers({mp.mpf(2): 1 / (2 * mp.mpf(shape.radius))})
        case Cone():
            return Powers({mp.mpf(1): mp.mpf(shape.slope)})
        case PowerLaw():
            width, rise, n = (mp.mpf(given[name]) for name in ("width", "rise", "exponent"))
            return Powers({n: rise / width**n})
        case PowerSeries():
            return Powers({mp.mpf(n): mp.mpf(c) for n, c in given["terms"].items()})
        case Sphere():
            return Ball(mp.mpf(shape.radius))
        case Tabulated():
            columns = {name: column.tolist() for name, column in given.items()}
            return profile_of(shape.name, columns, shape.knot_slopes.tolist())
    return profile_of(shape.name, given)


def walk(indentations: Iterable[Number], arcs: list[tuple[Number, Number]], touch: Number = 0) -> Iterator[int]:
    """The stable branch that a contact is on at each of the indentations of a path, -1 for none.

    ``arcs`` are the indentations between which each branch lies, from the innermost to the outermost; from ``touch`` on
    a contact begins.
    """
    at = -1
    for delta in indentations:
        if at < 0 and delta >= touch:
            at = 0
        while at >= 0 and delta < arcs[at][0]:
            at -= 1
        while at >= 0 and delta > arcs[at][1]:
            at += 1
        yield at


class Follower:
    """One asperity on a half-space."""

    touch: Number = 0
    """The indentation [m] from which on a contact begins."""

    def __init__(self, arcs: list[tuple[Number, Number]]) -> None:
        self.branches = arcs
        """Indentations [m] between which each stable branch lies."""

    def force(self, branch: int, delta: Number) -> Number:
        """[N] on a branch at an indentation [m]."""
        raise NotImplementedError

    def forces(self, indentations: list[Number]) -> list[Number]:
        """[N] at each of the indentations [m] of a path."""
        on = walk(indentations, self.branches, self.touch)
        return [self.force(at, delta) if at >= 0 else mp.mpf(0) for at, delta in zip(on, indentations, strict=True)]


class Punch(Follower):
    """A flat punch without adhesion or with JKR's: its radius is always b."""

    def __init__(self, radius: float, effective_modulus: float, work: float) -> None:
        b = mp.mpf(radius)
        super().__init__([(-mp.sqrt(2 * mp.pi * b * work / mp.mpf(effective_modulus)), mp.inf)])
        self.stiffness = 2 * mp.mpf(effective_modulus) * b

    def force(self, branch: int, delta: Number) -> Number:
        """[N]"""
        return self.stiffness * delta


class Touching(Follower):
    """Any other shape without adhesion or with JKR's."""

    def __init__(self, shape: Shape, effective_modulus: float, work: float) -> None:
        width, _, _ = shape.nondimensional()
        self.shape, self.asperity = shape, Asperity(profile(shape), effective_modulus, work, width)
        self.arcs = self.asperity.branches("indentation")
        super().__init__([(arc.value, self._top(arc)) for arc in self.arcs])

    def _top(self, arc: Branch) -> Number:
        """The indentation [m] where an arc ends."""
        endless = arc.hi is None or arc.hi == self.asperity.profile.end
        return mp.inf if endless else self._indentation(arc.hi)[0]

    def _indentation(self, a: Number) -> tuple[Number, Number]:
        """[m], and its derivative by the radius."""
        g, slope, _ = self.asperity.profile.mdr(a)
        stretch = self.asperity.dl(a)
        return g - stretch, slope - stretch / (2 * a)

    def force(self, branch: int, delta: Number) -> Number:
        """[N], with the contact radius by Newton's method and what is left of the way along the tangent."""
        arc = self.arcs[branch]
        if delta <= arc.value:
            return self.asperity.state(arc.lo)["force"] if arc.lo > 0 else mp.mpf(0)
        a = self._roughly(arc, float(delta))
        for _ in range(_MOST):
            found = self.asperity.state(a)
            rest = delta - found["indentation"]
            if abs(rest) <= _NEAR * (delta - arc.value):
                return found["force"] + found["stiffness"] * rest
            before, a = a, a + rest / self._indentation(a)[1]
            a = max(a, (before + arc.lo) / 2)
            a = a if arc.hi is None else min(a, (before + arc.hi) / 2)
        raise ArithmeticError(f"no contact of {self.shape} at {delta}")

    def _roughly(self, arc: Branch, delta: float) -> Number:
        """The contact radius [m] on an arc in plain double: where Newton's method begins."""
        low, work, effective_modulus = float(arc.lo), float(self.asperity.work), float(self.asperity.effective_modulus)
        start = low or float(self.asperity.width)

        def radius(y: float) -> float:
            if arc.hi is None:
                return low + start * math.exp(y)
            return low + (float(arc.hi) - low) / (1.0 + math.exp(-y))

        def above(y: float) -> float:
            a = radius(y)
            return float(self.shape.g(a)) - release_stretch(a, effective_modulus, work) - delta

        return mp.mpf(radius(brentq(above, -_FARTHEST, _FARTHEST, xtol=1e-15)))

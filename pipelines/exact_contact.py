"""The exact force of one asperity at a given indentation, from closed forms with 60 digits, in about a millisecond.

The state that a kernel found is where the search begins; what is found must be a root, to 28 digits, on the same
stable branch. Profiles are those of DESIGN's table, g and a g - G (H 16, 17, 32, 33, 40, 41), none of them as the
kernels write it.
"""

from collections.abc import Callable
from typing import NamedTuple

from twins import PowerShape, Real, Twin, kappa, mp

import roughmdr as rm
from roughmdr.shapes import Shape

_SMALL = mp.mpf("1e-15")
_CLOSE = mp.mpf("1e-28")  # tables have 40 digits, of which next to a knot a dozen are lost
_PATIENCE = 60


class Point(NamedTuple):
    """A contact radius [m] with g [m] and a g - G [m2] there."""

    a: Real
    g: Real
    push: Real


Profile = Callable[[Real], Point]
"""All at the parameter that the kernels of a shape count their contact radius by."""


def profile(shape: Shape) -> Profile:
    """The profile of a shape that is not a flat punch."""
    given = {name: mp.mpf(value) for name, value in shape.parameters.items() if isinstance(value, float)}
    b = given.get("flat_radius", given.get("blend_radius"))
    match shape:
        case rm.Paraboloid():
            return _powers({mp.mpf(2): 1 / (2 * given["radius"])}, mp.mpf(1))
        case rm.Cone():
            return _powers({mp.mpf(1): given["slope"]}, mp.mpf(1))
        case rm.PowerLaw():
            n = given["exponent"]
            c = given["coefficient"] if "coefficient" in given else given["rise"] / given["width"] ** n
            return _powers({n: c}, mp.mpf(1))
        case rm.PowerSeries():
            terms = {mp.mpf(n): mp.mpf(c) for n, c in shape.terms.items()}
            return _powers(terms, mp.mpf(shape.nondimensional()[0]))
        case rm.Sphere():
            return _sphere(given["radius"])
        case rm.TruncatedCone():
            return _truncated_cone(given["slope"], b)
        case rm.TruncatedParaboloid():
            return _truncated_paraboloid(given["radius"], b)
        case rm.RoundedCone():
            return _rounded_cone(given["slope"], b)
        case rm.CappedParaboloid():
            return _capped(given["radius"], given["cap_radius"], b)
        case rm.RoundedPunch():
            return _rounded_punch(given["edge_radius"], b)
        case rm.Tabulated():
            return lambda t: Point(*(mp.mpf(each) for each in shape.precisely(t)))
    raise ValueError(f"no profile of {shape}")


def _powers(terms: dict[Real, Real], width: Real) -> Profile:
    g_at_1 = {n: kappa(n) * c for n, c in terms.items()}

    def at(t: Real) -> Point:
        a = width * t
        parts = {n: factor * a**n for n, factor in g_at_1.items()}
        return Point(a, mp.fsum(parts.values()), a * mp.fsum(n / (n + 1) * g for n, g in parts.items()))

    return at


def _sphere(R: Real) -> Profile:
    def at(t: Real) -> Point:
        with mp.workdps(mp.dps + _lost(t)):
            a = R * mp.tanh(t)
            return Point(a, a * t, ((R * R + a * a) * t - R * a) / 2)

    return at


def _lost(t: Real) -> int:
    """Digits that differences lose at a small t, in its third power."""
    return int(max(0, -3 * mp.log10(t))) if t > 0 else 0


def _truncated_cone(S: Real, b: Real) -> Profile:
    def at(q: Real) -> Point:
        a, angle = b * mp.sqrt(1 + q * q), mp.atan(q)
        g = S * a * angle
        return Point(a, g, a * g - S / 2 * (a * a * angle - b * b * q))

    return at


def _truncated_paraboloid(R: Real, b: Real) -> Profile:
    def at(q: Real) -> Point:
        a = b * mp.sqrt(1 + q * q)
        g = a * b * q / R
        return Point(a, g, a * g - (b * q) ** 3 / (3 * R))

    return at


def _rounded_cone(S: Real, b: Real) -> Profile:
    def at(t: Real) -> Point:
        a = b * t
        if t <= 1:
            return Point(a, S * a * a / b, 2 * S * a**3 / (3 * b))
        q = mp.sqrt((a - b) * (a + b))
        angle = mp.acos(b / a)
        g = S * a * (a - q) / b + S * a * angle
        return Point(a, g, a * g - S * (a**3 - q**3) / (3 * b) - S / 2 * (a * a * angle - b * q))

    return at


def _capped(R: Real, cap: Real, b: Real) -> Profile:
    def at(t: Real) -> Point:
        if t <= 1:
            a = b * t
            return Point(a, a * a / cap, 2 * a**3 / (3 * cap))
        q = b * (t - 1) * R / cap
        a = mp.sqrt(b * b + q * q)
        g = a * (a - q) / cap + a * q / R
        return Point(a, g, a * g - (a**3 - q**3) / (3 * cap) - q**3 / (3 * R))

    return at


def _rounded_punch(R: Real, b: Real) -> Profile:
    def at(q: Real) -> Point:
        with mp.workdps(mp.dps + _lost(q)):
            a, angle = b * mp.sqrt(1 + q * q), mp.atan(q)
            g = a / R * (b * q - b * angle)
            return Point(a, g, a * g - ((b * q) ** 3 / 3 - b / 2 * (a * a * angle - b * b * q)) / R)

    return at


class Exact:
    """One asperity, half-space of ``effective_modulus`` [Pa], with JKR's ``work`` of adhesion [J/m2] or none (0)."""

    def __init__(self, shape: Shape, effective_modulus: float, work: float) -> None:
        self.profile = profile(shape)
        self.power = Twin(shape, effective_modulus, work) if isinstance(shape, PowerShape) else None
        """Its folds have a closed form."""
        self.effective_modulus = mp.mpf(effective_modulus)
        self.per_root = mp.sqrt(2 * mp.pi * mp.mpf(work) / self.effective_modulus)

    def indentation(self, t: Real) -> Real:
        """delta [m]."""
        a, g, _ = self.profile(mp.mpf(t))
        return g - self.per_root * mp.sqrt(a)

    def force(self, t: Real) -> Real:
        """P [N]."""
        a, _, push = self.profile(mp.mpf(t))
        return 2 * self.effective_modulus * (push - self.per_root * a * mp.sqrt(a))

    def fold(self) -> Real:
        """The a [m] where a power law lets go."""
        if self.power is None:
            raise ValueError("only the folds of power laws have a closed form")
        return self.power.fold("indentation")

    def state(self, indentation: Real, begin: float, low: Real, high: Real) -> Real | None:
        """The t of an indentation [m] on the stable branch from low to high; None where none is found near ``begin``.

        By secants; where they lead out of the branch by halves.
        """
        low, high = mp.mpf(low), mp.mpf(high)
        t = min(max(mp.mpf(begin), low), high)
        other = t + _SMALL * (t or mp.mpf(1))
        value, value_other = self.indentation(t) - indentation, self.indentation(other) - indentation
        scale = max(abs(indentation), self.per_root * mp.sqrt(self.profile(t).a))
        for _ in range(_PATIENCE):
            if value == value_other:
                return None
            slope = (value_other - value) / (other - t)
            if slope > 0 and abs(value) <= _CLOSE * scale:
                return t
            better = t - value / slope if slope > 0 else 2 * t - low
            better = (t + low) / 2 if better < low else ((t + high) / 2 if better > high else better)
            other, value_other = t, value
            t, value = better, self.indentation(better) - indentation
            if value == 0:
                return t
        return None


class Pinned(Exact):
    """A flat punch, whose state is its indentation [m] itself."""

    def __init__(self, shape: rm.FlatPunch, effective_modulus: float, work: float) -> None:
        self.radius = mp.mpf(shape.radius)
        self.effective_modulus = mp.mpf(effective_modulus)
        self.stretch = mp.sqrt(2 * mp.pi * self.radius * mp.mpf(work) / self.effective_modulus)

    def indentation(self, t: Real) -> Real:
        """delta [m]."""
        return mp.mpf(t)

    def force(self, t: Real) -> Real:
        """P [N]."""
        return 2 * self.effective_modulus * self.radius * t

    def fold(self) -> Real:
        """Where it lets go."""
        return -self.stretch

    def state(self, indentation: Real, begin: float, low: Real, high: Real) -> Real | None:
        """The indentation."""
        return indentation

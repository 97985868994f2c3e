"""The exact force of one asperity at a given indentation, with 60 digits, in about a millisecond.

The search begins at the state that a kernel found; the result must be a root, to 28 digits, on the same stable branch.
Profiles are integrals over f' in closed form, none of them as the kernels write it.
"""

from collections.abc import Callable
from typing import NamedTuple

import roughmdr as rm
from oracles.jkr_power_law import JkrPowerLaw, PowerShape
from oracles.multiprecision import Number, mp
from oracles.profiles import closed_profile
from roughmdr.shapes import Shape

_STEP = mp.mpf("1e-15")  # relative, of the first secant
_RTOL = mp.mpf("1e-28")
_MAX_STEPS = 60


class Point(NamedTuple):
    """A contact radius [m] with g [m] and a g - G [m2] there."""

    a: Number
    g: Number
    reduced_load: Number


def radius_of_t(shape: Shape) -> Callable[[Number], Number]:
    """Return the contact radius [m] as a function of the parameter t by which the kernels of a shape count it."""
    width = mp.mpf(shape.nondimensional()[0])
    match shape:
        case rm.Paraboloid() | rm.Cone() | rm.PowerLaw():
            return lambda t: t
        case rm.Sphere():
            return lambda t: mp.mpf(shape.radius) * mp.tanh(t)
        case rm.TruncatedCone() | rm.TruncatedParaboloid() | rm.RoundedPunch():
            return lambda t: mp.mpf(shape.flat_radius) * mp.sqrt(1 + t * t)
        case rm.CappedParaboloid():
            ratio = mp.mpf(shape.radius) / shape.cap_radius
            return lambda t: shape.blend_radius * (t if t <= 1 else mp.sqrt(1 + ((t - 1) * ratio) ** 2))
    return lambda t: width * t


def profile(shape: Shape) -> Callable[[Number], Point]:
    """Return the profile of a shape that is not a flat punch, as a function of t."""
    exact, radius = closed_profile(shape), radius_of_t(shape)

    def at(t: Number) -> Point:
        with mp.workdps(mp.dps + _lost_digits(shape, t)):
            a = radius(t)
            g, _, G = exact.mdr(a)
            return Point(a, g, a * g - G)

    return at


def _lost_digits(shape: Shape, t: Number) -> int:
    """Return how many digits differences lose next to a corner, t = 0 or 1, and next to the equator of a sphere."""
    if isinstance(shape, PowerShape | rm.PowerSeries | rm.Tabulated):
        return 0
    nearest = min(abs(t), abs(t - 1)) or mp.mpf(1)
    return int(5 * max(0, -mp.log10(nearest)) + (t if isinstance(shape, rm.Sphere) else 0))


class ExactContact:
    """One asperity on a half-space of ``effective_modulus`` [Pa], with JKR ``work`` of adhesion [J/m2] or none (0)."""

    def __init__(self, shape: Shape, effective_modulus: float, work: float) -> None:
        self.profile = profile(shape)
        self.power_law = JkrPowerLaw(shape, effective_modulus, work) if isinstance(shape, PowerShape) else None
        """The fold of a power law has a closed form."""
        self.effective_modulus = mp.mpf(effective_modulus)
        self.stretch_at_1 = mp.sqrt(2 * mp.pi * mp.mpf(work) / self.effective_modulus)

    def indentation(self, t: Number) -> Number:
        """Return delta [m] (H 40)."""
        a, g, _ = self.profile(mp.mpf(t))
        return g - self.stretch_at_1 * mp.sqrt(a)

    def force(self, t: Number) -> Number:
        """Return P [N] (H 41)."""
        a, _, reduced_load = self.profile(mp.mpf(t))
        return 2 * self.effective_modulus * (reduced_load - self.stretch_at_1 * a * mp.sqrt(a))

    def fold(self) -> Number:
        """Return the t where a power law detaches."""
        if self.power_law is None:
            raise ValueError("only the folds of power laws have a closed form")
        return self.power_law.fold("indentation")

    def state(self, indentation: Number, begin: float, low: Number, high: Number) -> Number | None:
        """Return the t of an indentation [m] on the stable branch from ``low`` to ``high``, or None.

        By the secant method from ``begin``, and by bisection where that leads out of the branch.
        """
        low, high = mp.mpf(low), mp.mpf(high)
        t = min(max(mp.mpf(begin), low), high)
        other = t + _STEP * (t or mp.mpf(1))
        value, value_other = self.indentation(t) - indentation, self.indentation(other) - indentation
        scale = max(abs(indentation), self.stretch_at_1 * mp.sqrt(self.profile(t).a))
        for _ in range(_MAX_STEPS):
            if value == value_other:
                return None
            slope = (value_other - value) / (other - t)
            if slope > 0 and abs(value) <= _RTOL * scale:
                return t
            step = t - value / slope if slope > 0 else 2 * t - low
            step = (t + low) / 2 if step < low else ((t + high) / 2 if step > high else step)
            other, value_other = t, value
            t, value = step, self.indentation(step) - indentation
            if value == 0:
                return t
        return None


class ExactPunch(ExactContact):
    """A flat punch, whose t is its indentation [m] itself."""

    def __init__(self, shape: rm.FlatPunch, effective_modulus: float, work: float) -> None:
        self.radius, self.effective_modulus = mp.mpf(shape.radius), mp.mpf(effective_modulus)
        self.release_stretch = mp.sqrt(2 * mp.pi * self.radius * mp.mpf(work) / self.effective_modulus)

    def indentation(self, t: Number) -> Number:
        """Return delta [m]."""
        return mp.mpf(t)

    def force(self, t: Number) -> Number:
        """Return P [N]."""
        return 2 * self.effective_modulus * self.radius * t

    def fold(self) -> Number:
        """Return the indentation of detachment [m]."""
        return -self.release_stretch

    def state(self, indentation: Number, begin: float, low: Number, high: Number) -> Number | None:
        """Return the indentation."""
        return indentation

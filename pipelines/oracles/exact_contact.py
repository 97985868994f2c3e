"""The exact force of one asperity at a given indentation, with 60 digits, in about a millisecond.

The search begins at the state that a kernel found; the result must be a root, to 28 digits, on the same stable branch.
Profiles are integrals over f' in closed form, none of them as the kernels write it.
"""

from collections.abc import Callable

import roughmdr as rm
from oracles.jkr import Asperity, JkrPowerLaw, PowerShape
from oracles.multiprecision import Number, mp
from oracles.profiles import closed_profile
from roughmdr.shapes import Shape

_STEP = mp.mpf("1e-15")  # relative, of the first secant
_RTOL = mp.mpf("1e-28")
_MAX_STEPS = 60


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


class ExactContact:
    """One asperity on a half-space of ``effective_modulus`` [Pa], with JKR ``work`` of adhesion [J/m2] or none (0)."""

    def __init__(self, shape: Shape, effective_modulus: float, work: float) -> None:
        self.shape, self.radius = shape, radius_of_t(shape)
        if isinstance(shape, PowerShape):
            self.asperity: Asperity = JkrPowerLaw(shape, effective_modulus, work)
        else:
            self.asperity = Asperity(closed_profile(shape), effective_modulus, work, shape.nondimensional()[0])

    def at(self, t: Number) -> dict[str, Number]:
        """Return the equilibrium at t, with the digits that differences lose next to a corner or an equator."""
        t = mp.mpf(t)
        lost = 0
        if not isinstance(self.shape, PowerShape | rm.PowerSeries | rm.Tabulated | rm.MdrTable):
            nearest = min(abs(t), abs(t - 1)) or mp.mpf(1)  # to a corner
            lost = int(5 * max(0, -mp.log10(nearest)) + (t if isinstance(self.shape, rm.Sphere) else 0))
        with mp.workdps(mp.dps + lost):
            return self.asperity.state(self.radius(t))

    def indentation(self, t: Number) -> Number:
        """Return delta [m] (H 40)."""
        return self.at(t)["indentation"]

    def force(self, t: Number) -> Number:
        """Return P [N] (H 41)."""
        return self.at(t)["force"]

    def fold(self) -> Number:
        """Return the t where a power law detaches: only its fold has a closed form."""
        assert isinstance(self.asperity, JkrPowerLaw)
        return self.asperity.fold("indentation")

    def state(self, indentation: Number, begin: float, low: Number, high: Number) -> Number | None:
        """Return the t of an indentation [m] on the stable branch from ``low`` to ``high``, or None.

        By the secant method from ``begin``, and by bisection where that leads out of the branch.
        """
        low, high = mp.mpf(low), mp.mpf(high)
        t = min(max(mp.mpf(begin), low), high)
        other = t + _STEP * (t or mp.mpf(1))
        value, value_other = self.indentation(t) - indentation, self.indentation(other) - indentation
        scale = max(abs(indentation), self.asperity.dl(self.radius(t)))
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
        self.stiffness = 2 * mp.mpf(effective_modulus) * mp.mpf(shape.radius)
        self.release_stretch = mp.sqrt(2 * mp.pi * mp.mpf(shape.radius) * mp.mpf(work) / mp.mpf(effective_modulus))

    def at(self, t: Number) -> dict[str, Number]:
        """Return the equilibrium."""
        return {"indentation": mp.mpf(t), "force": self.stiffness * t}

    def fold(self) -> Number:
        """Return the indentation of detachment [m]."""
        return -self.release_stretch

    def state(self, indentation: Number, begin: float, low: Number, high: Number) -> Number | None:
        """Return the indentation."""
        return indentation

"""One asperity with JKR adhesion or without: its branches, its folds and its states, exactly.

They are of any profile; the folds of power laws have closed forms. ``ExactContact`` has, in about a millisecond, the
force at an indentation from a state that a kernel found: a root to 28 digits, on the same stable branch.
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial

import numpy as np

import roughmdr as rm
from oracles.multiprecision import Number, bracket, mp, radius_between, root
from oracles.profiles import Profile, closed_profile
from roughmdr.shapes import Shape

WRITTEN = 40
ENERGY_WRITTEN = 25
FOLD_LEVEL = {"indentation": 1.0, "force": 3.0}  # 2 a g'/dl(a) at the folds under each control
_STEP = mp.mpf("1e-15")  # relative, of the first secant
_RTOL = mp.mpf("1e-28")  # error of an indentation, over the larger one of it and of the stretch
_MAX_STEPS = 60
PowerShape = rm.Paraboloid | rm.Cone | rm.PowerLaw


@dataclass(frozen=True)
class Branch:
    """Contact radii lo < a < hi [m], hi None for infinity, over which the control grows from ``value`` at lo."""

    lo: Number
    hi: Number | None
    value: Number


class Asperity:
    """One asperity on a half-space of ``effective_modulus`` [Pa], with ``work`` of adhesion [J/m2] or 0."""

    def __init__(self, profile: Profile, effective_modulus: float, work: float, width: float) -> None:
        self.profile = profile
        self.effective_modulus = mp.mpf(effective_modulus)
        self.work = mp.mpf(work)
        self.width = mp.mpf(width)
        """Length [m] from which searches begin."""

    def dl(self, a: Number) -> Number:
        """Return the stretch [m] at which a spring at ``a`` detaches (H 44)."""
        return mp.sqrt(2 * mp.pi * a * self.work / self.effective_modulus)

    def state(self, a: Number) -> dict[str, Number]:
        """Return indentation [m], force [N] and stiffness [N/m] at contact radius ``a`` [m] (H 32, 33, 40, 41)."""
        g, slope, G = self.profile.mdr(a)
        dl = self.dl(a)
        k = 2 * self.effective_modulus * a
        if self.work > 0 and slope != dl / (2 * a):
            k = 2 * self.effective_modulus * (a * slope - 3 * dl / 2) / (slope - dl / (2 * a))
        force = 2 * self.effective_modulus * (a * g - G - a * dl)
        return {"contact_radius": a, "indentation": g - dl, "force": force, "stiffness": k}

    def growth(self, a: Number) -> Number:
        """Return 2 a g'(a)/dl(a): a grows with the indentation where this is above 1, with the force where above 3."""
        return 2 * a * self.profile.mdr(a)[1] / self.dl(a)

    def energy(self, a: Number, indentation: Number) -> Number:
        """Return U = E* ∫_0^a (delta - g)^2 dx - pi w a^2 [J]."""
        nodes = self.profile.nodes(mp.mpf(0), a, ENERGY_WRITTEN + 10)
        squares = mp.fsum(weight * (indentation - self.profile.mdr(x)[0]) ** 2 for x, weight in nodes)
        return self.effective_modulus * squares - mp.pi * self.work * a**2

    def branches(self, control: str) -> list[Branch]:
        """Return the branches that are stable under ``control``, from the innermost to the outermost."""
        if self.work == 0:
            return [Branch(self.profile.flat, self.profile.end, mp.mpf(0))]
        turning_points = list(self._turning_points(FOLD_LEVEL[control]))
        starts, stops = ([a for rising, a in turning_points if rising is wanted] for wanted in (True, False))
        ends = [*stops, self.profile.end]
        if len(ends) != len(starts) or any(stop <= start for start, stop in zip(starts, stops, strict=False)):
            raise ArithmeticError("minima and maxima do not alternate")
        return [Branch(a, end, self.state(a)[control]) for a, end in zip(starts, ends, strict=True)]

    def _turning_points(self, level: float) -> Iterator[tuple[bool, Number]]:
        """Yield where ``growth`` crosses ``level``, from the smallest radius up: (upwards or not, radius)."""
        kinks = self.profile.kinks
        if not kinks:  # convex and without kinks: sqrt(a) g' grows for ever, so there is one
            yield True, self._only_turning_point(level)
            return
        stretch_at_1 = math.sqrt(2.0 * math.pi * float(self.work / self.effective_modulus))
        corners = [b for b, _ in self.profile.corners]
        last, last_radius = -1.0, mp.mpf(0)
        for base, end in zip([mp.mpf(0), *kinks], [*kinks, None], strict=True):
            scale = float(base or kinks[0])
            low, high = 1e-26 * scale, (1e26 * scale if end is None else float(end - base) * (1.0 - 1e-9))
            offsets = np.geomspace(low, high, 2000)
            if end is not None:
                offsets = np.union1d(offsets, np.linspace(0.0, high, 400)[1:])
            slope = self.profile.rough_slope(float(base), offsets)
            if np.min(slope) < -1e-12 * np.max(slope):
                raise ArithmeticError("g falls somewhere")
            values = 2.0 * np.sqrt(float(base) + offsets) * slope / stretch_at_1 - level
            for value, offset in zip(values, offsets, strict=True):
                radius = base + mp.mpf(float(offset))
                if (value > 0.0) != (last > 0.0):
                    yield bool(value > 0.0), self._turning_point(level, base, last_radius, radius, corners)
                last, last_radius = float(value), radius
        if last <= 0.0:
            raise ArithmeticError("the outermost branch lies beyond the search")

    def _only_turning_point(self, level: float) -> Number:
        """Return the only fold, found by doubling steps in the logarithm of a, or of a/(R - a) for a sphere."""
        radius = partial(radius_between, 0, self.profile.end, self.width)

        def above(y: Number) -> Number:
            return mp.log(self.growth(radius(y)) / mp.mpf(level))

        return radius(root(above, *bracket(above)))

    def _turning_point(self, level: float, base: Number, lo: Number, hi: Number, corners: list[Number]) -> Number:
        """Return the crossing between the radii ``lo`` and ``hi`` [m]; only the latter is surely beyond ``base``."""
        if lo <= base:
            if base in corners:
                return base
            return root(lambda a: self.growth(a) - level, lo, hi)
        start, stop = mp.log(lo - base), mp.log(hi - base)
        return base + mp.exp(root(lambda y: self.growth(base + mp.exp(y)) - level, start, stop))

    def solve(self, branches: list[Branch], control: str, value: float) -> dict[str, Number] | None:
        """Return the state of largest radius with ``control`` = ``value``; None where a sphere's a is nearly R."""
        exact = mp.mpf(value)
        branch = [each for each in branches if each.value < exact][-1]
        rise = exact - branch.value
        radius = partial(radius_between, branch.lo, branch.hi, branch.lo or self.width)

        def above(y: Number) -> Number:
            # Next to a fold, next to a corner and far out this is nearly linear in y.
            return mp.log((self.state(radius(y))[control] - branch.value) / rise)

        if self.profile.end is not None:  # next to R the poles spoil the quadrature
            top = mp.log(mp.mpf(10) ** 9)
            if above(top) < 0:
                return None
        a = radius(root(above, *bracket(above)))
        state = self.state(a)
        if abs(state[control] - exact) > mp.mpf(10) ** (-WRITTEN - 10) * max(abs(exact), rise):
            raise ArithmeticError(f"{control} {value!r} was not met")
        return {**state, control: exact}


def kappa(exponent: Number) -> Number:
    """Return g/f (H 26)."""
    n = mp.mpf(exponent)
    return mp.sqrt(mp.pi) / 2 * n * mp.gamma(n / 2) / mp.gamma((n + 1) / 2)


class JkrPowerLaw(Asperity):
    """f = c r^n pressed into a half-space, without (work = 0) or with JKR adhesion."""

    def __init__(self, shape: PowerShape, effective_modulus: float, work: float) -> None:
        super().__init__(closed_profile(shape), effective_modulus, work, 1.0)
        ((slope_at_1, power),) = self.profile.pieces[0].terms
        self.n = mp.mpf(power) + 1
        self.kappa = kappa(self.n)
        self.g_at_1 = self.kappa / self.n * slope_at_1

    def g(self, a: Number) -> Number:
        """Return the MDR profile [m]."""
        return self.g_at_1 * mp.mpf(a) ** self.n

    def reduced_load(self, a: Number) -> Number:
        """Return a g(a) - G(a) [m2], G the integral of g from 0."""
        return self.n / (self.n + 1) * a * self.g(a)

    def fold(self, control: str) -> Number:
        """Return the a where a g' is dl/2 (under a given "indentation") or 3/2 dl ("force"); 0 without adhesion."""
        multiple = mp.mpf(3 if control == "force" else 1) / 2
        return (multiple * self.dl(1) / (self.n * self.g_at_1)) ** (1 / (self.n - mp.mpf(1) / 2))

    def radius(self, control: str, value: Number) -> Number:
        """Return the a of the stable branch at an indentation or a force."""
        if self.work == 0:
            return (value / self.state(mp.mpf(1))[control]) ** (1 / (self.n + (control == "force")))
        fold = self.fold(control)
        state = self.solve([Branch(fold, None, self.state(fold)[control])], control, value)
        assert state  # there is one of every power law
        return state["contact_radius"]


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

"""One asperity with JKR adhesion or without, exactly: its branches, its folds and its state under either control."""

import itertools
import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from mpmath import mp
from precise_profiles import Number, Profile, tanh_sinh

WRITTEN = 40
ENERGY_WRITTEN = 25
ONE_OF = {"indentation": 1.0, "force": 3.0}
"""Under each control the branch folds where 2 a g' is that many dl(a)."""


def root(function: Callable[[Number], Number], lo: Number, hi: Number) -> Number:
    """Where ``function``, negative at ``lo`` and positive at ``hi``, is 0: Chandrupatla's method."""
    small, narrow = mp.mpf(10) ** (-WRITTEN - 12), mp.mpf(10) ** (10 - mp.dps)
    one, other = lo, hi
    f_one, f_other = function(lo), function(hi)
    if not f_one <= 0 <= f_other:
        raise ArithmeticError(f"no root between {mp.nstr(lo, 20)} and {mp.nstr(hi, 20)}")
    t: Number = mp.mpf(1) / 2
    while True:
        at = one + t * (other - one)
        value = function(at)
        if abs(value) < small or abs(other - one) < narrow * max(1, abs(at)):
            return at
        if (value > 0) == (f_one > 0):
            third, f_third = one, f_one
        else:
            third, f_third, other, f_other = other, f_other, one, f_one
        one, f_one = at, value
        xi, phi = (one - other) / (third - other), (f_one - f_other) / (f_third - f_other)
        t = mp.mpf(1) / 2
        if phi**2 < xi and (1 - phi) ** 2 < 1 - xi:  # inverse quadratic interpolation is safe
            t = f_one / (f_other - f_one) * f_third / (f_other - f_third)
            t += (third - one) / (other - one) * f_one / (f_third - f_one) * f_other / (f_third - f_other)


@dataclass(frozen=True)
class Branch:
    """A stretch of contact radii lo < a < hi [m] over which the control only grows, from ``value`` at lo;
    hi is None where it goes on for ever.
    """

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
        """A length [m] to begin the searches from."""

    def dl(self, a: Number) -> Number:
        """The stretch [m] at which a spring at ``a`` lets go (H 44)."""
        return mp.sqrt(2 * mp.pi * a * self.work / self.effective_modulus)

    def state(self, a: Number) -> dict[str, Number]:
        """Indentation [m], force [N] and stiffness [N/m] at contact radius ``a`` [m] (H 32, 33, 40, 41)."""
        g, slope, G = self.profile.mdr(a)
        dl = self.dl(a)
        k = 2 * self.effective_modulus * a
        if self.work > 0 and slope != dl / (2 * a):
            k = 2 * self.effective_modulus * (a * slope - 3 * dl / 2) / (slope - dl / (2 * a))
        force = 2 * self.effective_modulus * (a * g - G - a * dl)
        return {"contact_radius": a, "indentation": g - dl, "force": force, "stiffness": k}

    def growth(self, a: Number) -> Number:
        """2 a g'(a)/dl(a): a grows with the indentation where this is above 1, with the force where above 3."""
        return 2 * a * self.profile.mdr(a)[1] / self.dl(a)

    def energy(self, a: Number, indentation: Number) -> Number:
        """U = E* ∫_0^a (delta - g)^2 dx - pi w a^2 [J]."""
        edges = [mp.mpf(0), *(b for b in self.profile.kinks if b < a), a]
        total = mp.mpf(0)
        for lo, hi in itertools.pairwise(edges):
            if hi <= self.profile.flat:
                total += (hi - lo) * indentation**2
                continue
            for x, weight in tanh_sinh(ENERGY_WRITTEN + 10, 28):
                total += (hi - lo) * weight * (indentation - self.profile.mdr(lo + (hi - lo) * x)[0]) ** 2
        return self.effective_modulus * total - mp.pi * self.work * a**2

    def branches(self, control: str) -> list[Branch]:
        """The branches that are stable under ``control``, from the innermost to the outermost."""
        if self.work == 0:
            return [Branch(self.profile.flat, self.profile.end, mp.mpf(0))]
        starts: list[Number] = []
        stops: list[Number] = []
        for rising, at in self._turns(ONE_OF[control]):
            (starts if rising else stops).append(at)
        ends = [*stops, self.profile.end]
        if len(ends) != len(starts) or any(stop <= start for start, stop in zip(starts, stops, strict=False)):
            raise ArithmeticError("minima and maxima do not alternate")
        return [Branch(a, end, self.state(a)[control]) for a, end in zip(starts, ends, strict=True)]

    def _turns(self, level: float) -> Iterator[tuple[bool, Number]]:
        """Where ``growth`` passes ``level``, from the smallest radius up: (upwards or not, radius)."""
        kinks = self.profile.kinks
        if not kinks:  # convex and without kinks: sqrt(a) g' grows for ever, so there is one
            yield True, self._single_turn(level)
            return
        stretch = math.sqrt(2.0 * math.pi * float(self.work / self.effective_modulus))
        corners = [b for b, _ in self.profile.corners]
        last, last_radius = -1.0, mp.mpf(0)
        for base, end in zip([mp.mpf(0), *kinks], [*kinks, None], strict=True):
            scale = float(base or kinks[0])
            least, most = 1e-26 * scale, (1e26 * scale if end is None else float(end - base) * (1.0 - 1e-9))
            offsets = np.geomspace(least, most, 2000)
            if end is not None:
                offsets = np.union1d(offsets, np.linspace(0.0, most, 400)[1:])
            slope = self.profile.rough_slope(float(base), offsets)
            if np.min(slope) < -1e-12 * np.max(slope):
                raise ArithmeticError("g falls somewhere")
            values = 2.0 * np.sqrt(float(base) + offsets) * slope / stretch - level
            for value, offset in zip(values, offsets, strict=True):
                radius = base + mp.mpf(float(offset))
                if (value > 0.0) != (last > 0.0):
                    yield bool(value > 0.0), self._turn(level, base, last_radius, radius, value > 0.0, corners)
                last, last_radius = float(value), radius
        if last <= 0.0:
            raise ArithmeticError("the outermost branch lies beyond the search")

    def _single_turn(self, level: float) -> Number:
        """The only fold, found by doubling steps in the logarithm of a, or of a/(R - a) for a sphere."""

        def radius(y: Number) -> Number:
            end: Number = self.profile.end
            return self.width * mp.exp(y) if end is None else end / (1 + mp.exp(-y))

        def above(y: Number) -> Number:
            return mp.log(self.growth(radius(y)) / mp.mpf(level))

        return radius(root(above, *bracket(above)))

    def _turn(self, level: float, base: Number, lo: Number, hi: Number, up: bool, corners: list[Number]) -> Number:
        """The turn between the radii ``lo`` and ``hi`` [m]; only the latter is sure to be beyond ``base``."""
        sign = 1 if up else -1
        if lo <= base:
            if base in corners:
                return base
            return root(lambda a: sign * (self.growth(a) - level), lo, hi)
        start, stop = mp.log(lo - base), mp.log(hi - base)
        return base + mp.exp(root(lambda y: sign * (self.growth(base + mp.exp(y)) - level), start, stop))

    def solve(self, branches: list[Branch], control: str, value: float) -> dict[str, Number] | None:
        """The state of largest radius at which ``control`` has ``value``; None where a sphere's a is all but R."""
        exact = mp.mpf(value)
        branch = [each for each in branches if each.value < exact][-1]
        rise = exact - branch.value
        start = branch.lo or self.width

        def radius(y: Number) -> Number:
            if branch.hi is None:
                return branch.lo + start * mp.exp(y)
            return branch.lo + (branch.hi - branch.lo) / (1 + mp.exp(-y))

        def above(y: Number) -> Number:
            # Next to a fold, next to a corner and far out this is all but straight in y.
            return mp.log((self.state(radius(y))[control] - branch.value) / rise)

        if self.profile.end is not None:  # so close to R that the poles spoil the quadrature
            top = mp.log(mp.mpf(10) ** 9)
            if above(top) < 0:
                return None
        a = radius(root(above, *bracket(above)))
        state = self.state(a)
        if abs(state[control] - exact) > mp.mpf(10) ** (-WRITTEN - 10) * max(abs(exact), rise):
            raise ArithmeticError(f"{control} {value!r} was not met")
        return {**state, control: exact}


def bracket(function: Callable[[Number], Number]) -> tuple[Number, Number]:
    """Arguments at which the growing ``function`` is negative and positive, near 0 where that will do."""
    step = mp.mpf(2)
    lo, hi = mp.mpf(0), mp.mpf(0)
    if function(lo) > 0:
        while function(lo) > 0:
            hi, lo, step = lo, lo - step, step * 2
    else:
        while function(hi) <= 0:
            lo, hi, step = hi, hi + step, step * 2
    return lo, hi

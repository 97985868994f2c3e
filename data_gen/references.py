"""Make the reference tables of single asperities: 40 right digits, from the integrals over the profile's slope.

    python data_gen/references.py -o tests/data --shape cone --shape sphere

Nothing here knows a closed form of g or G. A shape is its slope f'(r) alone, and with r = a cos(psi)
g(a) = a ∫ f' dpsi and G(a) = a^2 ∫ f' sin(psi)^2 dpsi over 0 < psi < pi/2, split wherever f' has a kink (H 17).
The inputs are doubles, written so that they read back to the last bit; the answers are the exact ones of these doubles.
"""

import itertools
import json
import math
import multiprocessing
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, TypeAlias

import click
import numpy as np
from mpmath import mp
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

Number: TypeAlias = Any
"""A number of any precision (mpf)."""
Floats: TypeAlias = NDArray[np.float64]
Parameters: TypeAlias = dict[str, Any]

WORKING = 100
"""Digits carried. Next to a corner fold a - b may be 1e-32 of b, so far more than the 40 that are written."""
SPHERE_WORKING = 70
"""The sphere has no corner, but many nodes."""
WRITTEN = 40
ENERGY_WORKING = 45
"""Digits carried in the energy, of which 25 are written: an integral over an integral costs too much otherwise."""
ENERGY_WRITTEN = 25
SEED = 2012
MODULUS = (1e3, 1e13)
WORK = (1e-9, 10.0)
OMEGA = (1e-4, 1e4)
ONE_OF = {"indentation": 1.0, "force": 3.0}
"""Under each control the branch folds where 2 a g' is that many dl(a)."""
DISTANCES = {
    "indentation": (1e-12, 1e-9, 1e-6, 1e-3, 0.1, 0.9, 1.0, 3.0, 30.0, 1001.0),
    "force": (1e-12, 1e-6, 1e-2, 1.0, 10.0, 1001.0),
}
"""X = 1 - control/pull-off: 0 at the fold, 1 where the control is 0."""
ENERGY_DISTANCES = (1e-3, 1.0, 30.0)
DECADES = {"indentation": (-8.0, -5.0, -2.0, -0.5, 0.4, 3.0), "force": (-8.0, -4.0, -1.0, 0.5, 3.0)}
"""Without adhesion: powers of ten of the shape's own rise, and of modulus * width * rise."""
ENERGY_DECADES = (-2.0, 0.4)


# --- quadrature -------------------------------------------------------------------------------------------------------


@cache
def gauss(digits: int) -> list[tuple[Number, Number]]:
    """Gauss-Legendre nodes and weights on (0, 1), enough of them for trigonometric polynomials to ``digits``."""
    n = 8 + 32 * digits // 100
    rule = []
    with mp.workdps(digits + 10):
        for guess in np.polynomial.legendre.leggauss(n)[0]:
            x = mp.mpf(float(guess))
            for _ in range(2 + math.ceil(math.log2(digits / 14.0))):  # Newton doubles the digits
                before, value = mp.mpf(1), x
                for k in range(2, n + 1):
                    before, value = value, ((2 * k - 1) * x * value - (k - 1) * before) / k
                slope = n * (x * value - before) / (x * x - 1)
                x -= value / slope
            rule.append(((1 + x) / 2, 1 / ((1 - x * x) * slope * slope)))
    return rule


@cache
def tanh_sinh(digits: int, steps: int) -> list[tuple[Number, Number]]:
    """Double-exponential nodes and weights on (0, 1), ``steps`` to the unit: for end points that are not smooth."""
    rule = []
    with mp.workdps(digits + 10):
        edge = math.asinh((digits + 5) * math.log(10.0) / math.pi)
        for i in range(-math.ceil(edge * steps), math.ceil(edge * steps) + 1):
            t = mp.mpf(i) / steps
            grow = mp.exp(mp.pi * mp.sinh(t))
            rule.append((grow / (1 + grow), mp.pi * mp.cosh(t) * grow / (1 + grow) ** 2 / steps))
    return rule


@cache
def whole_moments(power: float, digits: int) -> tuple[Number, Number]:
    """∫ cos(psi)^power and ∫ cos(psi)^power sin(psi)^2 over 0 < psi < pi/2, for power > -1/2."""
    stretch = 8  # sin(phi)^power with phi ~ v^8 is smooth enough at 0 for the rule to see all of it
    plain, squared = mp.mpf(0), mp.mpf(0)
    with mp.workdps(digits + 20):
        for v, weight in tanh_sinh(digits + 20, 256):
            phi = mp.pi / 2 * v**stretch
            density = weight * mp.pi / 2 * stretch * v ** (stretch - 1) * mp.sin(phi) ** mp.mpf(power)
            plain += density
            squared += density * mp.cos(phi) ** 2
    return plain, squared


# --- profiles ---------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Piece:
    """f'(r) = sum of coefficient r^power on lo < r < hi [m]; hi is None where it goes on for ever."""

    lo: Number
    hi: Number | None
    terms: tuple[tuple[Number, float], ...]

    def whole(self) -> bool:
        """Whether there is no other piece."""
        return self.lo == 0 and self.hi is None


def angle(r: Number, a: Number) -> Number:
    """psi where a cos(psi) = r [m], without loss next to r = a; 0 from there on."""
    return mp.atan2(mp.sqrt((a - r) * (a + r)), r) if r < a else mp.mpf(0)


class Profile:
    """An asperity known by f' alone, which is piecewise a sum of powers."""

    end: Number | None = None
    """Where the profile becomes vertical [m], or None."""

    def __init__(self, pieces: list[Piece], corners: list[tuple[Number, Number]] | None = None) -> None:
        self.pieces = pieces
        self.corners = corners or []
        """Radii [m] at which f' jumps up, and the jumps."""

    @property
    def kinks(self) -> list[Number]:
        """Where f' or its derivative jumps [m]."""
        return [piece.lo for piece in self.pieces if piece.lo > 0]

    @property
    def flat(self) -> Number:
        """Radius [m] of the part where f' = 0."""
        lead = [piece.hi for piece in self.pieces if all(c == 0 for c, _ in piece.terms)]
        return lead[-1] if lead else mp.mpf(0)

    def mdr(self, a: Number) -> tuple[Number, Number, Number]:
        """g(a) [m], g'(a) [1] and G(a) [m2]. On a corner itself g' is that from inside."""
        g, slope, G = mp.mpf(0), mp.mpf(0), mp.mpf(0)
        for piece in self.pieces:
            if piece.lo < a and any(c != 0 for c, _ in piece.terms):
                for (c, power), (plain, squared) in zip(piece.terms, self._moments(piece, a), strict=True):
                    scale = c * a ** mp.mpf(power)
                    g += scale * plain
                    slope += scale * plain * (1 + mp.mpf(power))  # the part of r f'' is power times that of f'
                    G += scale * squared
        for b, jump in self.corners:
            if b < a:
                slope += jump * b / mp.sqrt((a - b) * (a + b))
        return g * a, slope, G * a * a

    @staticmethod
    def _moments(piece: Piece, a: Number) -> list[tuple[Number, Number]]:
        if piece.whole():
            return [whole_moments(power, mp.dps) for _, power in piece.terms]
        begin = mp.mpf(0) if piece.hi is None else angle(piece.hi, a)
        length = angle(piece.lo, a) - begin
        sums = [[mp.mpf(0), mp.mpf(0)] for _ in piece.terms]
        for x, weight in gauss(mp.dps):
            cos, sin = mp.cos_sin(begin + length * x)
            for total, (_, power) in zip(sums, piece.terms, strict=True):
                plain = weight * length * cos ** int(power)
                total[0] += plain
                total[1] += plain * sin * sin
        return [(total[0], total[1]) for total in sums]

    def rough_slope(self, base: float, above: Floats) -> Floats:
        """g' [1] at a = base + above [m] in plain double, for the search for folds; ``base`` is 0 or a kink."""
        nodes, weights = np.polynomial.legendre.leggauss(48)
        a = base + above

        def across(r: float) -> Floats:
            """sqrt(a^2 - r^2), without loss next to the kink; 0 beyond a."""
            return np.sqrt(np.maximum((base - r + above) * (base + r + above), 0.0))

        slope = np.zeros_like(a)
        for piece in self.pieces:
            begin = np.zeros_like(a) if piece.hi is None else np.arctan2(across(float(piece.hi)), float(piece.hi))
            half = (np.arctan2(across(float(piece.lo)), float(piece.lo)) - begin) / 2.0
            r = a[:, None] * np.cos(begin[:, None] + half[:, None] * (1.0 + nodes))
            for c, power in piece.terms:
                slope += half * ((1.0 + power) * float(c) * r**power @ weights)
        for b, jump in self.corners:
            with np.errstate(divide="ignore"):
                slope += np.where(across(float(b)) > 0.0, float(jump) * float(b) / across(float(b)), 0.0)
        return slope


class SphereProfile(Profile):
    """f' = r/sqrt(R^2 - r^2), radius R [m]."""

    def __init__(self, radius: Number) -> None:
        super().__init__([])
        self.end = radius

    def mdr(self, a: Number) -> tuple[Number, Number, Number]:
        """g(a) [m], g'(a) [1] and G(a) [m2]."""
        R: Number = self.end
        gap = (R - a) * (R + a)
        g, slope, G = mp.mpf(0), mp.mpf(0), mp.mpf(0)
        # The closer a comes to R, the closer the integrand's poles come to psi = 0: hence the many nodes.
        for cos, square, weight in _sphere_rule(mp.dps):
            depth = gap + a * a * square  # R^2 - r^2
            plain = weight * a * cos / mp.sqrt(depth)
            g += plain
            slope += plain * (1 + R * R / depth)
            G += plain * square
        return g * a, slope, G * a * a


@cache
def _sphere_rule(digits: int) -> list[tuple[Number, Number, Number]]:
    rule = []
    for x, weight in tanh_sinh(digits, 160 if digits > ENERGY_WORKING else 64):
        cos, sin = mp.cos_sin(mp.pi / 2 * x)
        rule.append((cos, sin * sin, weight * mp.pi / 2))
    return rule


def profile_of(shape: str, parameters: Parameters, slopes: list[float] | None = None) -> Profile:
    """The slope f' of ``shape``, from its parameters (doubles, taken as exact)."""
    p = {name: mp.mpf(value) for name, value in parameters.items() if isinstance(value, float)}
    b: Number = p.get("flat_radius", p.get("blend_radius"))
    nothing, none = ((mp.mpf(0), 0.0),), mp.mpf(0)
    match shape:
        case "cone":
            return Profile([Piece(none, None, ((p["slope"], 0.0),))])
        case "paraboloid":
            return Profile([Piece(none, None, ((1 / p["radius"], 1.0),))])
        case "sphere":
            return SphereProfile(p["radius"])
        case "power_law":
            n = p["exponent"]
            return Profile([Piece(none, None, ((n * p["rise"] * p["width"] ** -n, _one_less(n)),))])
        case "power_series":
            terms = [(mp.mpf(float(n)), mp.mpf(c)) for n, c in parameters["terms"].items()]
            return Profile([Piece(none, None, tuple((n * c, _one_less(n)) for n, c in terms))])
        case "truncated_cone":
            flank = ((p["slope"], 0.0),)
            return Profile([Piece(none, b, nothing), Piece(b, None, flank)], [(b, p["slope"])])
        case "truncated_paraboloid":
            flank = ((1 / p["radius"], 1.0),)
            return Profile([Piece(none, b, nothing), Piece(b, None, flank)], [(b, b / p["radius"])])
        case "rounded_cone":
            return Profile([Piece(none, b, ((p["slope"] / b, 1.0),)), Piece(b, None, ((p["slope"], 0.0),))])
        case "capped_paraboloid":
            jump = b / p["radius"] - b / p["cap_radius"]
            pieces = [Piece(none, b, ((1 / p["cap_radius"], 1.0),)), Piece(b, None, ((1 / p["radius"], 1.0),))]
            return Profile(pieces, [(b, jump)] if jump > 0 else [])
        case "rounded_punch":
            R = p["edge_radius"]
            return Profile([Piece(none, b, nothing), Piece(b, None, ((-b / R, 0.0), (1 / R, 1.0)))])
        case "tabulated":
            return _tabulated_profile(parameters["r"], parameters["f"], slopes or [])
    raise ValueError(f"no shape {shape}")


def _one_less(n: Number) -> float:
    """n - 1, which is a double wherever n >= 1/2 is one."""
    power = float(n - 1)
    if mp.mpf(power) != n - 1:
        raise ValueError(f"exponent {n} - 1 is not a double")
    return power


def _tabulated_profile(r: list[float], f: list[float], slopes: list[float]) -> Profile:
    """The cubic Hermite spline's f', a parabola on each piece, and the last slope beyond the table."""
    pieces = []
    for i in range(len(r) - 1):
        lo, hi = mp.mpf(r[i]), mp.mpf(r[i + 1])
        h = hi - lo
        secant, left, right = (mp.mpf(f[i + 1]) - mp.mpf(f[i])) / h, mp.mpf(slopes[i]), mp.mpf(slopes[i + 1])
        # f' = left + first t + second t^2 with t = r - lo, written in powers of r.
        first = (6 * secant - 4 * left - 2 * right) / h
        second = (3 * left + 3 * right - 6 * secant) / h**2
        terms = ((left - first * lo + second * lo**2, 0.0), (first - 2 * second * lo, 1.0), (second, 2.0))
        pieces.append(Piece(lo, hi, terms))
    pieces.append(Piece(mp.mpf(r[-1]), None, ((mp.mpf(slopes[-1]), 0.0),)))
    return Profile(pieces)


def knot_slopes(r: list[float], f: list[float]) -> list[float]:
    """Slopes [1] at the knots, in plain double: those of the not-a-knot spline, kept from overshooting."""
    secants = np.diff(f) / np.diff(r)
    most = 3.0 * np.minimum(np.append(secants, np.inf), np.insert(secants, 0, np.inf))
    spline = CubicSpline(np.array(r), np.array(f), bc_type="not-a-knot").derivative()(np.array(r))
    return [float(slope) for slope in np.minimum(np.maximum(spline, 0.0), most)]


# --- one asperity -----------------------------------------------------------------------------------------------------


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
    """One asperity on a half-space of ``modulus`` [Pa], with ``work`` of adhesion [J/m2] or 0."""

    def __init__(self, profile: Profile, modulus: float, work: float, width: float) -> None:
        self.profile = profile
        self.modulus = mp.mpf(modulus)
        self.work = mp.mpf(work)
        self.width = mp.mpf(width)
        """A length [m] to begin the searches from."""

    def dl(self, a: Number) -> Number:
        """The stretch [m] at which a spring at ``a`` lets go (H 44)."""
        return mp.sqrt(2 * mp.pi * a * self.work / self.modulus)

    def state(self, a: Number) -> dict[str, Number]:
        """Indentation [m], force [N] and stiffness [N/m] at contact radius ``a`` [m] (H 32, 33, 40, 41)."""
        g, slope, G = self.profile.mdr(a)
        dl = self.dl(a)
        k = 2 * self.modulus * a
        if self.work > 0 and slope != dl / (2 * a):
            k = 2 * self.modulus * (a * slope - 3 * dl / 2) / (slope - dl / (2 * a))
        force = 2 * self.modulus * (a * g - G - a * dl)
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
        return self.modulus * total - mp.pi * self.work * a**2

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
        stretch = math.sqrt(2.0 * math.pi * float(self.work / self.modulus))
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


# --- cases ------------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Case:
    """What one asperity is, and the lengths [m] that its rows without adhesion are measured in."""

    shape: str
    parameters: Parameters
    modulus: float
    work: float
    width: float
    rise: float
    slopes: list[float] | None = None


class Draw:
    """Random numbers of few digits, so that the tables can be read."""

    def __init__(self, shape: str) -> None:
        self._random = np.random.Generator(np.random.Philox([SEED, *shape.encode()]))

    def among(self, least: float, most: float) -> float:
        """A number between two, evenly in its logarithm."""
        return few(math.exp(self._random.uniform(math.log(least), math.log(most))))

    def spread(self, count: int, least: float = OMEGA[0], most: float = OMEGA[1]) -> list[float]:
        """``count`` numbers between two, one in each of as many equal parts of the logarithm."""
        ratio = (most / least) ** (1.0 / count)
        return [self.among(least * ratio**i, least * ratio ** (i + 1)) for i in range(count)]

    def material(self, width: float, rise: float, omega: float) -> tuple[float, float] | None:
        """Modulus [Pa] and work [J/m2] with dl(width) = omega rise; None where they would be out of range."""
        ratio = (omega * rise) ** 2 / (2.0 * math.pi * width)
        least, most = max(MODULUS[0], WORK[0] / ratio), min(MODULUS[1], WORK[1] / ratio)
        if least >= most:
            return None
        modulus = self.among(least, most)
        return modulus, float(f"{modulus * ratio:.12g}")


def few(number: float) -> float:
    """``number`` to six digits."""
    return float(f"{number:.6g}")


def adhesive(
    draw: Draw, shape: str, omega: float, form: Callable[[float, float], Parameters], aspect: tuple[float, float]
) -> Case:
    """A case of reduced adhesion ``omega``; ``form`` makes the parameters of a width and a rise [m]."""
    while True:
        width = draw.among(1e-10, 1.0)
        rise = few(width * draw.among(*aspect))
        found = draw.material(width, rise, omega)
        if found is not None:
            return Case(shape, form(width, rise), *found, width=width, rise=rise)


def bare(draw: Draw, shape: str, form: Callable[[float, float], Parameters], aspect: tuple[float, float]) -> Case:
    """A case without adhesion."""
    width = draw.among(1e-10, 1.0)
    rise = few(width * draw.among(*aspect))
    return Case(shape, form(width, rise), draw.among(*MODULUS), 0.0, width, rise)


ASPECT = (1e-3, 10.0)
FORMS: dict[str, Callable[[float, float], Parameters]] = {
    "flat_punch": lambda b, _: {"radius": b},
    "cone": lambda b, h: {"slope": few(h / b)},
    "paraboloid": lambda b, h: {"radius": few(b * b / h)},
    "sphere": lambda b, _: {"radius": b},
    "truncated_cone": lambda b, h: {"slope": few(h / b), "flat_radius": b},
    "truncated_paraboloid": lambda b, h: {"radius": few(b * b / h), "flat_radius": b},
    "rounded_cone": lambda b, h: {"slope": few(h / b), "blend_radius": b},
    "rounded_punch": lambda b, h: {"flat_radius": b, "edge_radius": few(b * b / h)},
}
WINDOWS = {
    "truncated_cone": [1.55, 4.6, 6.0],
    "truncated_paraboloid": [2.3, 7.0, 12.0],
    "rounded_cone": [1.22, 3.7, 3.8],
}
"""Reduced adhesions at which there are two branches, the first under dead load and the others under fixed grips."""


def simple_cases(shape: str, draw: Draw) -> list[Case]:
    """Shapes with at most one form, stretched."""
    form = FORMS[shape]
    aspect = (1.0, 1.0) if shape == "sphere" else ASPECT
    # A cone and a paraboloid have no size of their own: there omega only keeps the radii within reason.
    span = (0.03, 30.0) if shape in {"cone", "paraboloid"} else OMEGA
    omegas = [*draw.spread(7, *span), *WINDOWS.get(shape, [])]
    return [adhesive(draw, shape, omega, form, aspect) for omega in omegas] + [
        bare(draw, shape, form, aspect) for _ in range(3)
    ]


def power_law_cases(shape: str, draw: Draw) -> list[Case]:
    """Exponents from just above 1/2, where the natural scale runs away, to nearly a flat punch."""

    def form(n: float) -> Callable[[float, float], Parameters]:
        return lambda width, rise: {"exponent": n, "width": width, "rise": rise}

    cases = []
    exponents = (0.51, 0.6, 0.75, 1.3, 2.0, 3.7, 8.0, 40.0, 200.0)
    for n, part in zip(exponents, draw.spread(len(exponents)), strict=True):
        # a0/width = omega^(1/(n - 1/2)), kept within six decades.
        omega = few(part ** min(1.0, 1.5 * (n - 0.5)))
        cases.append(adhesive(draw, shape, omega, form(n), ASPECT))
    return cases + [bare(draw, shape, form(n), ASPECT) for n in (0.51, 1.5, 4.0, 200.0)]


def power_series_cases(shape: str, draw: Draw) -> list[Case]:
    """Sums of two and three powers, alike in size somewhere near the width."""

    def form(exponents: tuple[float, ...]) -> Callable[[float, float], Parameters]:
        def make(width: float, rise: float) -> Parameters:
            return {"terms": {repr(n): few(rise * draw.among(0.1, 10.0) * width**-n) for n in exponents}}

        return make

    families = [(2.0, 4.0), (1.0, 2.0), (0.75, 1.5, 3.0), (0.6, 6.0), (2.0, 4.0, 6.0), (1.0, 1.25), (2.0, 20.0)]
    pairs = zip(families, draw.spread(len(families)), strict=True)
    return [adhesive(draw, shape, omega, form(family), ASPECT) for family, omega in pairs] + [
        bare(draw, shape, form(family), ASPECT) for family in families[:3]
    ]


def capped_cases(shape: str, draw: Draw) -> list[Case]:
    """Ratios of the outer to the cap's radius up to 1, where there is no kink left."""

    def form(ratio: float) -> Callable[[float, float], Parameters]:
        def make(width: float, rise: float) -> Parameters:
            radius = few(width * width / rise)
            return {
                "radius": radius,
                "cap_radius": max(radius, few(radius / ratio)),
                "blend_radius": width,
            }

        return make

    ratios = (0.5, 0.01, 1.0, 0.01, 0.99, 0.1, 0.01)
    cases = [
        adhesive(draw, shape, omega, form(ratio), ASPECT) for ratio, omega in zip(ratios, draw.spread(7), strict=True)
    ]
    cases += [adhesive(draw, shape, omega, form(ratio), ASPECT) for ratio, omega in CAPPED_WINDOWS]
    return cases + [bare(draw, shape, form(ratio), ASPECT) for ratio in (0.01, 0.5, 0.99, 1.0)]


CAPPED_WINDOWS = [(0.01, 2.3), (0.5, 2.05), (0.01, 6.9), (0.01, 9.0), (0.01, 12.0), (0.5, 4.0), (0.99, 2.0)]
"""Ratio and reduced adhesion: corner folds, smooth ones not far from them, and both at once."""


def tabulated_cases(shape: str, draw: Draw) -> list[Case]:
    """Three tables, each stretched to several sizes."""
    uneven = np.array([0.0, 0.11, 0.2, 0.37, 0.45, 0.7, 0.81, 1.0, 1.3, 1.45, 1.8, 2.4])
    rounded = np.where(uneven < 0.5, uneven**2, uneven - 0.25)  # a rounded cone, and a little of a fourth power
    flat = np.array([0.0, 0.3, 0.62, 1.0, 1.2, 1.5, 1.9, 2.3, 3.0])
    tables = [
        (uneven, rounded + 0.1 * uneven**4),
        (flat, 0.5 * np.maximum(flat - 1.0, 0.0) ** 2),
        (np.array([0.0, 0.6, 1.5]), np.array([0.0, 0.25, 1.2])),
    ]

    def form(table: tuple[Floats, Floats]) -> Callable[[float, float], Parameters]:
        return lambda width, rise: {
            "r": [few(width * x) for x in table[0].tolist()],
            "f": [few(rise * y) for y in table[1].tolist()],
        }

    cases = [adhesive(draw, shape, omega, form(table), ASPECT) for table in tables for omega in draw.spread(3)] + [
        bare(draw, shape, form(table), ASPECT) for table in tables
    ]
    return [Case(**{**vars(case), "slopes": knot_slopes(case.parameters["r"], case.parameters["f"])}) for case in cases]


CASES: dict[str, Callable[[str, Draw], list[Case]]] = {
    **dict.fromkeys(FORMS, simple_cases),
    "power_law": power_law_cases,
    "power_series": power_series_cases,
    "capped_paraboloid": capped_cases,
    "tabulated": tabulated_cases,
}


# --- tables -----------------------------------------------------------------------------------------------------------


def digits(number: Number, count: int = WRITTEN) -> str:
    """``number`` to so many digits."""
    return str(mp.nstr(number, count, min_fixed=-4, max_fixed=10))


def values(case: Case, control: str, pull_off: Number) -> list[tuple[float, bool]]:
    """The control's values [m or N] of a case's rows, and whether the row also states the energy."""
    if case.work > 0.0:
        distances = DISTANCES[control]
        exact = [(float(pull_off * (1 - mp.mpf(X))), X in ENERGY_DISTANCES) for X in distances]
        return [(value, energy and control == "indentation") for value, energy in exact]
    unit = case.rise if control == "indentation" else case.modulus * case.width * case.rise
    return [(few(unit * 10.0**u), u in ENERGY_DECADES and control == "indentation") for u in DECADES[control]]


def table(case: Case) -> dict[str, Any]:
    """All that is written about one case."""
    with mp.workdps(SPHERE_WORKING if case.shape == "sphere" else WORKING):
        entry: dict[str, Any] = {"parameters": case.parameters}
        if case.slopes is not None:
            entry["slopes"] = case.slopes
        entry |= {"modulus": case.modulus, "work": case.work}
        rows = punch_rows(case, entry) if case.shape == "flat_punch" else asperity_rows(case, entry)
        return {**entry, "rows": rows}


def punch_rows(case: Case, entry: dict[str, Any]) -> list[dict[str, Any]]:
    """A flat punch has no slope to integrate: a = b, and Kendall's pull-off at delta = -dl(b)."""
    b, modulus, work = mp.mpf(case.parameters["radius"]), mp.mpf(case.modulus), mp.mpf(case.work)
    k = 2 * modulus * b
    lost = -mp.sqrt(2 * mp.pi * b * work / modulus)
    end = {"contact_radius": b, "indentation": lost, "force": k * lost}
    if work > 0:
        written = {name: digits(number) for name, number in end.items()}
        entry["pull_off"] = {"displacement": written, "force": written}
    rows = []
    for control in DISTANCES:
        for value, energy in values(case, control, end[control]):
            delta = mp.mpf(value) if control == "indentation" else mp.mpf(value) / k
            force = mp.mpf(value) if control == "force" else k * delta
            state = {"contact_radius": b, "indentation": delta, "force": force, "stiffness": k}
            rows.append(row(control, value, state, modulus * b * delta**2 - mp.pi * work * b**2 if energy else None))
    return rows


def asperity_rows(case: Case, entry: dict[str, Any]) -> list[dict[str, Any]]:
    """The rows of every other shape; fills in the pull-off of ``entry``."""
    asperity = Asperity(profile_of(case.shape, case.parameters, case.slopes), case.modulus, case.work, case.width)
    rows = []
    for control in DISTANCES:
        branches = asperity.branches(control)
        least = min(branches, key=lambda branch: branch.value)
        wanted = values(case, control, least.value)
        if case.work > 0.0:
            state = asperity.state(least.lo)
            end = {name: digits(state[name]) for name in ("contact_radius", "indentation", "force")}
            entry.setdefault("pull_off", {})["displacement" if control == "indentation" else "force"] = end
            outer = branches[-1].value
            if outer > least.value:  # either side of the jump inwards
                wanted += [(float(outer * (1 + side)), False) for side in (-1e-3, 1e-3)]
        for value, energy in wanted:
            found = asperity.solve(branches, control, value) if value > least.value else None
            if found is None or (asperity.profile.end is not None and found["indentation"] > 3 * asperity.profile.end):
                continue
            work_done = None
            if energy:
                with mp.workdps(ENERGY_WORKING):
                    work_done = asperity.energy(found["contact_radius"], found["indentation"])
            rows.append(row(control, value, found, work_done))
    return rows


def row(control: str, value: float, state: dict[str, Number], energy: Number | None) -> dict[str, Any]:
    """One line of a table."""
    line: dict[str, Any] = {"control": control, "value": value}
    line |= {name: digits(number) for name, number in state.items()}
    return line if energy is None else {**line, "energy": digits(energy, ENERGY_WRITTEN)}


def text(shape: str, entries: list[dict[str, Any]]) -> str:
    """The JSON of one shape, a row a line."""
    blocks = []
    for entry in entries:
        head = json.dumps({name: value for name, value in entry.items() if name != "rows"})[:-1]
        rows = ",\n".join(json.dumps(each) for each in entry["rows"])
        blocks.append(f'{head}, "rows": [\n{rows}\n]}}')
    return f'{{"shape": {json.dumps(shape)}, "cases": [\n' + ",\n".join(blocks) + "\n]}\n"


@click.command(help=(__doc__ or "").split("\n")[0])
@click.option(
    "-o", "--output", type=click.Path(file_okay=False, path_type=Path), default=Path("tests/data"), show_default=True
)
@click.option("--shape", "shapes", type=click.Choice(list(CASES)), multiple=True, help="Only these; default all.")
@click.option("--workers", type=click.IntRange(min=1), default=2, show_default=True, help="Processes.")
def main(output: Path, shapes: tuple[str, ...], workers: int) -> None:
    """Write one table a shape."""
    output.mkdir(parents=True, exist_ok=True)
    with multiprocessing.Pool(workers) as pool:
        pending = {
            shape: pool.map_async(table, CASES[shape](shape, Draw(shape)), chunksize=1)
            for shape in dict.fromkeys(shapes or CASES)
        }
        for shape, result in pending.items():
            entries = result.get()
            path = output / f"{shape}.json"
            path.write_text(text(shape, entries), encoding="utf-8")
            rows = sum(len(entry["rows"]) for entry in entries)
            click.echo(f"{path}: {len(entries)} cases, {rows} rows, {path.stat().st_size} bytes")


if __name__ == "__main__":
    main()

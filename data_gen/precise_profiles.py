"""Profiles of which the slope f' alone is known: g and G with as many digits as asked, by quadrature (H 17)."""

import math
from dataclasses import dataclass
from functools import cache
from typing import Any, TypeAlias

import numpy as np
from mpmath import mp
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

Number: TypeAlias = Any
"""A number of any precision (mpf)."""
Floats: TypeAlias = NDArray[np.float64]
Parameters: TypeAlias = dict[str, Any]
ENERGY_WORKING = 45
"""Digits carried in the energy, of which 25 are written: an integral over an integral costs too much otherwise."""


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

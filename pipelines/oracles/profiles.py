"""Profiles given by their slope f' alone: g and G are its integrals, with any number of digits (H 17)."""

import itertools
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from typing import Any, TypeAlias

import numpy as np
from mpmath.calculus.quadrature import GaussLegendre
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from oracles.multiprecision import Number, mp, tanh_sinh
from roughmdr.shapes import MdrTable, Shape, Tabulated

Floats: TypeAlias = NDArray[np.float64]
Parameters: TypeAlias = dict[str, Any]
Terms: TypeAlias = tuple[tuple[Number, float], ...]  # coefficients and powers


@dataclass(frozen=True)
class Piece:
    """f'(r) = sum of coefficient r^power on lo < r < hi [m]; hi is None where it goes on for ever."""

    lo: Number
    hi: Number | None
    terms: Terms


def angle(r: Number, a: Number) -> Number:
    """Return psi where a cos(psi) = r [m], without loss next to r = a; 0 from there on."""
    return mp.atan2(mp.sqrt((a - r) * (a + r)), r) if r < a else mp.mpf(0)


@cache
def whole_moments(power: float, digits: int) -> tuple[Number, Number]:
    """Return ∫ cos(psi)^power and ∫ cos(psi)^power sin(psi)^2 over 0 < psi < pi/2; ``digits`` are those of ``mp``."""
    n = mp.mpf(power)
    plain = mp.sqrt(mp.pi) / 2 * mp.gamma((n + 1) / 2) / mp.gamma(n / 2 + 1)
    return plain, plain / (n + 2)


def antiderivatives(psi: Number) -> list[tuple[Number, Number]]:
    """Return ∫ cos(psi)^power and ∫ cos(psi)^power sin(psi)^2 from 0 to psi, for the powers 0, 1, 2."""
    cos, sin = mp.cos_sin(psi)
    product = sin * cos
    return [
        (psi, (psi - product) / 2),
        (sin, sin**3 / 3),
        ((psi + product) / 2, (psi - product * (1 - 2 * sin * sin)) / 8),
    ]


class Profile:
    """A profile given by f' alone, piecewise a sum of powers: any powers, or 0, 1, 2 where there are several pieces."""

    end: Number | None = None  # radius at which the profile becomes vertical [m], or None

    def __init__(self, pieces: list[Piece], corners: list[tuple[Number, Number]] | None = None) -> None:
        self.pieces = pieces
        self.corners = corners or []
        """Radii [m] at which f' jumps up, and the jumps."""

    @property
    def kinks(self) -> list[Number]:
        """Radii at which f' or its derivative jumps [m]."""
        return [piece.lo for piece in self.pieces if piece.lo > 0]

    @property
    def flat(self) -> Number:
        """Radius [m] of the part where f' = 0."""
        lead = [piece.hi for piece in self.pieces if all(c == 0 for c, _ in piece.terms)]
        return lead[-1] if lead else mp.mpf(0)

    def nodes(self, lo: Number, hi: Number, digits: int) -> Iterator[tuple[Number, Number]]:
        """Yield nodes and weights from ``lo`` to ``hi`` [m], dense on both sides of each kink."""
        for left, right in itertools.pairwise([lo, *(b for b in self.kinks if lo < b < hi), hi]):
            for x, weight in tanh_sinh(digits, 28):
                yield left + (right - left) * x, (right - left) * weight

    def mdr(self, a: Number) -> tuple[Number, Number, Number]:
        """Return g(a) [m], g'(a) [1] and G(a) [m2]; at a corner itself g' is that from inside."""
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
        """Return, for each term, ∫ cos(psi)^power and ∫ cos(psi)^power sin(psi)^2 over the piece, r = a cos(psi)."""
        if piece.lo == 0 and piece.hi is None:
            return [whole_moments(power, mp.dps) for _, power in piece.terms]
        end = antiderivatives(angle(piece.lo, a))
        begin = antiderivatives(mp.mpf(0) if piece.hi is None else angle(piece.hi, a))
        return [(end[int(n)][0] - begin[int(n)][0], end[int(n)][1] - begin[int(n)][1]) for _, n in piece.terms]

    def rough_slope(self, base: float, above: Floats) -> Floats:
        """Return g' [1] at a = base + above [m] in double precision, to search for folds; ``base`` is 0 or a kink."""
        nodes, weights = np.polynomial.legendre.leggauss(48)
        a = base + above

        def across(r: float) -> Floats:
            """Return sqrt(a^2 - r^2), without loss next to the kink; 0 beyond a."""
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
        """Return g(a) [m], g'(a) [1] and G(a) [m2]."""
        R: Number = self.end
        angle, gap = mp.atanh(a / R), (R - a) * (R + a)
        return a * angle, angle + a * R / gap, (R * a - gap * angle) / 2


class MdrTableProfile(Profile):
    """g at rising radii [m], between them the monotone cubic in a^2 of F. N. Fritsch and J. Butland (1984).

    G is by a Gauss rule that is exact for it.
    """

    def __init__(self, a: Floats, g: Floats) -> None:
        super().__init__([])
        self.s = [mp.mpf(0), *(mp.mpf(each) ** 2 for each in a.tolist())]
        self.g = [mp.mpf(0), *map(mp.mpf, g.tolist())]
        self.slopes = _table_slopes(self.s, self.g)

    @property
    def kinks(self) -> list[Number]:
        """Radii at which a piece ends [m]."""
        return [mp.sqrt(s) for s in self.s[1:]]

    def mdr(self, a: Number) -> tuple[Number, Number, Number]:
        """Return g(a) [m], g'(a) [1] and G(a) [m2]."""
        ends = [mp.mpf(0), *(b for b in self.kinks if b < a), a]
        G = mp.fsum(
            (high - low) / 2 * w * self._value_and_slope(low + (high - low) / 2 * (1 + x))[0]
            for low, high in itertools.pairwise(ends)
            for x, w in _gauss(mp.prec)
        )
        g, slope = self._value_and_slope(a)
        return g, 2 * a * slope, G

    def _value_and_slope(self, a: Number) -> tuple[Number, Number]:
        """Return g and dg/da^2."""
        s = a * a
        if s >= self.s[-1]:
            return self.g[-1] + self.slopes[-1] * (s - self.s[-1]), self.slopes[-1]
        k = max(i for i, begin in enumerate(self.s) if begin <= s)
        h, rise = self.s[k + 1] - self.s[k], self.g[k + 1] - self.g[k]
        u, left, right = (s - self.s[k]) / h, self.slopes[k], self.slopes[k + 1]
        blend = u * u * (3 - 2 * u)
        value = self.g[k] + rise * blend + h * (left * u * (1 - u) ** 2 - right * u * u * (1 - u))
        slope = 6 * u * (1 - u) * rise / h + left * (1 - u) * (1 - 3 * u) + right * u * (3 * u - 2)
        return value, slope


@cache
def _gauss(precision: int) -> list[tuple[Number, Number]]:
    """Return six nodes and weights on -1 to 1, to so many bits."""
    return [(x, w) for x, w in GaussLegendre(mp).calc_nodes(2, precision)]


def _table_slopes(s: list[Number], g: list[Number]) -> list[Number]:
    """Return dg/ds at each point: weighted harmonic means, at the ends those of a parabola, kept from the chord."""
    h = [b - a for a, b in itertools.pairwise(s)]
    chord = [(b - a) / each for (a, b), each in zip(itertools.pairwise(g), h, strict=True)]
    if len(h) == 1:
        return [chord[0], chord[0]]
    inner = [
        3 * (a + b) / ((a + 2 * b) / left + (2 * a + b) / right)
        for (a, b), (left, right) in zip(itertools.pairwise(h), itertools.pairwise(chord), strict=True)
    ]
    ends = []
    for one, two, first, second in ((h[0], h[1], chord[0], chord[1]), (h[-1], h[-2], chord[-1], chord[-2])):
        parabola = ((2 * one + two) * first - one * second) / (one + two)
        ends.append(min(max(parabola, first / 2), 2 * first))
    return [ends[0], *inner, ends[1]]


def closed_profile(shape: Shape) -> Profile:
    """Return the profile of a shape that is not a flat punch."""
    if isinstance(shape, MdrTable):
        return MdrTableProfile(shape.radii, shape.indentations)
    if isinstance(shape, Tabulated):
        columns = {name: column.tolist() for name, column in shape.parameters.items()}
        return profile_of(shape.name, columns, shape.knot_slopes.tolist())
    return profile_of(shape.name, dict(shape.parameters))


def profile_of(shape: str, parameters: Parameters, slopes: list[float] | None = None) -> Profile:
    """Return the profile of ``shape`` from its parameters (doubles, taken as exact); of a table with given slopes."""
    p = {name: mp.mpf(value) for name, value in parameters.items() if isinstance(value, float)}
    if shape == "sphere":
        return SphereProfile(p["radius"])
    if shape == "tabulated":
        r, f = parameters["r"], parameters["f"]
        return Profile(_tabulated_pieces(r, f, slopes or knot_slopes(r, f)))
    inner, *beyond = _slope_terms(shape, parameters, p)
    if not beyond:
        return Profile([Piece(mp.mpf(0), None, inner)])
    b, (outer,) = p.get("flat_radius", p.get("blend_radius")), beyond
    jump = sum(c * b ** mp.mpf(power) for c, power in outer) - sum(c * b ** mp.mpf(power) for c, power in inner)
    corners = [(b, jump)] if shape.startswith(("truncated", "capped")) and jump > 0 else []
    return Profile([Piece(mp.mpf(0), b, inner), Piece(b, None, outer)], corners)


def _slope_terms(shape: str, parameters: Parameters, p: dict[str, Number]) -> list[Terms]:
    """Return the terms of f' of a shape with one piece, or those of its inner and its outer piece."""
    nothing = ((mp.mpf(0), 0.0),)
    match shape:
        case "cone":
            return [((p["slope"], 0.0),)]
        case "paraboloid":
            return [((1 / p["radius"], 1.0),)]
        case "power_law":
            n = p["exponent"]
            c = p["coefficient"] if "coefficient" in p else p["rise"] * p["width"] ** -n
            return [((n * c, _one_less(n)),)]
        case "power_series":
            terms = [(mp.mpf(float(n)), mp.mpf(c)) for n, c in parameters["terms"].items()]
            return [tuple((n * c, _one_less(n)) for n, c in terms)]
        case "truncated_cone":
            return [nothing, ((p["slope"], 0.0),)]
        case "truncated_paraboloid":
            return [nothing, ((1 / p["radius"], 1.0),)]
        case "rounded_cone":
            return [((p["slope"] / p["blend_radius"], 1.0),), ((p["slope"], 0.0),)]
        case "capped_paraboloid":
            return [((1 / p["cap_radius"], 1.0),), ((1 / p["radius"], 1.0),)]
        case "rounded_punch":
            return [nothing, ((-p["flat_radius"] / p["edge_radius"], 0.0), (1 / p["edge_radius"], 1.0))]
    raise ValueError(f"no shape {shape}")


def _one_less(n: Number) -> float:
    """Return n - 1, which is a double wherever n >= 1/2 is one."""
    power = float(n - 1)
    if mp.mpf(power) != n - 1:
        raise ValueError(f"exponent {n} - 1 is not a double")
    return power


def _tabulated_pieces(r: list[float], f: list[float], slopes: list[float]) -> list[Piece]:
    """Return f' of the cubic Hermite spline, a parabola on each piece, and the last slope beyond the table."""
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
    return [*pieces, Piece(mp.mpf(r[-1]), None, ((mp.mpf(slopes[-1]), 0.0),))]


def knot_slopes(r: list[float], f: list[float]) -> list[float]:
    """Return the slopes [1] at the knots, in doubles: those of the not-a-knot spline, kept from overshooting."""
    secants = np.diff(f) / np.diff(r)
    most = 3.0 * np.minimum(np.append(secants, np.inf), np.insert(secants, 0, np.inf))
    spline = CubicSpline(np.array(r), np.array(f), bc_type="not-a-knot").derivative()(np.array(r))
    return [float(slope) for slope in np.minimum(np.maximum(spline, 0.0), most)]

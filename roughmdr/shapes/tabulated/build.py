"""The params of a tabulated profile from its spline: the pieces of its MDR profile, as ``lookup`` describes their rows.

It needs the compiler, and so is imported when a table is first made. The MDR profile of the spline is integrated piece
by piece (H 17, 25): with r = x sin(phi) each piece of g = x ∫ f' dphi is a polynomial in sin(phi), which the nodes of
Gauss integrate to rounding error, without the cancellation of the antiderivatives far from the piece.
"""

import math
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.gauss import unit_gauss
from roughmdr.numerics.jit import compiled, njit
from roughmdr.shapes.pieces import ROWS
from roughmdr.shapes.tabulated.lookup import DEGREE, ELASTIC, HEIGHT, KNOT, PIECE, SCALE, elastic_integral_between

_RTOL = 3e-15  # error by the last coefficients, over the largest value on a piece
_NOISE = 1e-11  # an error below this that halving the piece does not lower is rounding
_MIN_HALF_LENGTH = 2.0**-20  # least half length of a piece, over the interval between two knots
_OCTAVES_BEYOND = 2  # beyond the last knot, until the far field is right: 16^-14 is below rounding
_SAMPLES = 8  # on each piece, in the search for where sqrt(a) g' falls
_MIN_FALL = 1e-9  # a smaller fall is rounding

_POINTS = np.cos(np.pi * (np.arange(DEGREE + 1) + 0.5) / (DEGREE + 1))
_TO_POWERS = np.array(
    [np.pad(np.polynomial.chebyshev.cheb2poly([0.0] * i + [1.0]), (0, DEGREE - i)) for i in range(DEGREE + 1)]
)
_TO_CHEBYSHEV = np.linalg.inv(np.polynomial.chebyshev.chebvander(_POINTS, DEGREE))
_SMALL_ANGLE = 0.02
_NODES_SMALL, _WEIGHTS_SMALL = unit_gauss(4)  # enough for a small angle
_NODES, _WEIGHTS = unit_gauss(14)  # enough for a right angle


class _Interval(NamedTuple):
    """Radii whose q = sqrt(a^2 - base^2) lies between start and stop, both times the length."""

    base: float
    length: float
    start: float
    stop: float = 1.0
    error: float = np.inf  # of the interval that this one is a half of


def tabulate(knots: Floats, coefficients: Floats) -> Floats:
    """Return the params of f' = c0 + c1 s + c2 s^2 over s = r - knot; the last piece is c0 alone, without end."""
    ends = np.append(knots[1:], knots[-1] * 2.0 ** np.arange(1, _OCTAVES_BEYOND + 1))
    bases = np.append(knots[:-1], np.full(_OCTAVES_BEYOND, knots[-1]))
    begins = np.append(knots[:-1], knots[-1] * 2.0 ** np.arange(_OCTAVES_BEYOND))
    lengths = np.sqrt((ends - bases) * (ends + bases))
    starts = np.sqrt((begins - bases) * (begins + bases)) / lengths
    found = [(0.0, 0.0, _tip(coefficients)), *_fit([*map(_Interval, bases, lengths, starts)][1:], knots, coefficients)]
    found.sort(key=lambda piece: piece[0])
    begins = np.array([begin for begin, *_ in found] + [ends[-1]])
    rows = np.zeros((begins.size, PIECE))
    rows[:, 0] = begins
    rows[:, KNOT] = [base for _, base, _ in found] + [knots[-1]]
    spline = np.column_stack([_heights(knots, coefficients), coefficients])
    rows[:, HEIGHT:SCALE] = spline[np.searchsorted(knots, rows[:, KNOT])]
    for number, (_, _, numbers) in enumerate([*found, (0.0, 0.0, _far(begins[-1], knots, coefficients))]):
        rows[number, SCALE : SCALE + numbers.size] = numbers
    intervals = _softening_intervals(begins, knots, coefficients)
    params = np.concatenate([[len(rows), PIECE], rows.ravel(), [len(intervals)], np.ravel(intervals)])
    _add_elastic_integrals(params)
    return params


def _fit(intervals: list[_Interval], knots: Floats, coefficients: Floats) -> list[tuple[float, float, Floats]]:
    """Return where each piece begins, its knot and its numbers from the scale on; halved until polynomials fit."""
    pieces: list[tuple[float, float, Floats]] = []
    while intervals:
        base, length, start, stop, before = np.array(intervals).T
        middle, half = 0.5 * (stop + start), 0.5 * (stop - start)
        q = length[:, None] * (middle[:, None] + half[:, None] * _POINTS)
        values = integrals(q.ravel(), np.repeat(base, q.shape[1]), knots, coefficients).reshape(*q.shape, 3)
        chebyshev = np.einsum("cp,spv->svc", _TO_CHEBYSHEV, values)
        largest = np.abs(values).max(axis=1)
        error = (np.abs(chebyshev[..., -2:]).sum(axis=-1) / np.where(largest > 0.0, largest, 1.0)).max(axis=1)
        fits = (error <= _RTOL) | ((error < _NOISE) & (error > 0.5 * before)) | (half < _MIN_HALF_LENGTH)
        powers = chebyshev @ _TO_POWERS
        for i in np.flatnonzero(fits):
            begin = np.hypot(base[i], length[i] * start[i]) if start[i] > 0.0 else base[i]
            sizes = np.abs(powers[i, [0, 2]]).sum(axis=1)
            head = [1.0 / (length[i] * half[i]), middle[i] / half[i], 0.0, *sizes]
            pieces.append((float(begin), float(base[i]), np.concatenate([head, powers[i].ravel()])))
        intervals = [
            _Interval(base[i], length[i], *limits, error[i])
            for i in np.flatnonzero(~fits)
            for limits in ((start[i], middle[i]), (middle[i], stop[i]))
        ]
    return pieces


def _heights(knots: Floats, coefficients: Floats) -> Floats:
    """Return f at the knots."""
    h = np.diff(knots)
    c0, c1, c2 = coefficients[:-1].T
    return np.concatenate([[0.0], np.cumsum(h * (c0 + h * (c1 / 2.0 + h * c2 / 3.0)))])


def _add_elastic_integrals(params: Floats) -> None:
    """Fill in the elastic integral at the beginning of each piece."""
    integral_between, total = compiled(elastic_integral_between), 0.0
    rows = params[ROWS : ROWS + PIECE * int(params[0])].reshape(-1, PIECE)
    for before, after in pairwise(rows):
        # Just inside, where the piece itself is looked up.
        total += integral_between(before[0], np.nextafter(after[0], 0.0), params)
        after[ELASTIC] = total


def _tip(coefficients: Floats) -> Floats:
    """Return the first piece, in powers of a itself, so that it is right however near the tip."""
    c0, c1, c2 = coefficients[0] * np.array([0.5 * np.pi, 1.0, 0.25 * np.pi])
    g, slope, load = (np.zeros(DEGREE + 1) for _ in range(3))
    g[1:4] = c0, c1, c2
    slope[:3] = c0, 2.0 * c1, 3.0 * c2
    load[2:5] = 0.5 * c0, 2.0 / 3.0 * c1, 0.75 * c2
    return np.concatenate([[1.0, 0.0, 0.0, 0.0, 0.0], g, slope, load])


def _far(end: float, knots: Floats, coefficients: Floats) -> Floats:
    """Return the far field: g = a pi S/2 + sum over k of binomial(2k, k) (2a)^(-2k) ∫ (f' - S) r^(2k) dr, slope S."""
    from scipy.special import binom

    nodes, weights = unit_gauss(DEGREE + 3)
    h = np.diff(knots)[:, None]
    s = h * nodes
    c0, c1, c2 = coefficients[:-1].T[:, :, None]
    excess = h * weights * (c0 + s * (c1 + s * c2) - coefficients[-1, 0])
    r = knots[:-1, None] + s
    k = np.arange(DEGREE + 1)
    terms = np.array([binom(2 * i, i) / 4.0**i * np.sum(excess * r ** (2 * i)) for i in k])
    steepness = 0.5 * np.pi * coefficients[-1, 0]
    far = end * np.sum(2.0 * k / (2.0 * k - 1.0) * terms * end ** (-2.0 * k))
    constant = integrals(np.array([end]), np.zeros(1), knots, coefficients)[0, 2] - 0.5 * steepness * end**2 - far
    return np.concatenate([[steepness, constant, 0.0, 0.0, 0.0], terms])


def sample_slope(begins: Floats, knots: Floats, coefficients: Floats) -> tuple[Floats, Floats]:
    """Return radii spread over the pieces, and g' there."""
    x = (begins[:-1, None] + np.diff(begins)[:, None] * (np.arange(_SAMPLES) + 0.5) / _SAMPLES).ravel()
    return x, integrals(x, np.zeros_like(x), knots, coefficients)[:, 1]


def _softening_intervals(begins: Floats, knots: Floats, coefficients: Floats) -> list[tuple[float, float]]:
    """Return the intervals in which sqrt(a) g'(a) falls."""
    from scipy.optimize import minimize_scalar

    def value(x: float) -> float:
        return float(np.sqrt(x) * integrals(np.array([x]), np.zeros(1), knots, coefficients)[0, 1])

    x, slope = sample_slope(begins, knots, coefficients)
    intervals = []
    for top, bottom in _falls(np.sqrt(x) * slope):
        high = minimize_scalar(lambda a: -value(a), bounds=(x[max(top - 1, 0)], x[top + 1]), method="bounded")
        low = minimize_scalar(value, bounds=(x[bottom - 1], x[bottom + 1]), method="bounded")
        intervals.append((float(high.x), float(low.x)))
    return intervals


def _falls(values: Floats) -> list[tuple[int, int]]:
    """Return the indices of each maximum and the minimum after it, where the values fall by more than rounding."""
    falls: list[tuple[int, int]] = []
    top = bottom = 0
    for i in range(1, values.size):
        if bottom == top:
            if values[i] >= values[top]:
                top = bottom = i
            elif values[i] < values[top] * (1.0 - _MIN_FALL):
                bottom = i
        elif values[i] < values[bottom]:
            bottom = i
        elif values[i] > values[bottom] * (1.0 + _MIN_FALL):
            falls.append((top, bottom))
            top = bottom = i
    return falls


@njit
def _root(knot: float, a: float, q: float, base: float) -> float:
    """Return sqrt(a^2 - knot^2) where a^2 = q^2 + base^2."""
    return math.sqrt(q * q + (base - knot) * (base + knot) if knot <= base else (a - knot) * (a + knot))


@njit
def integrals(q: Floats, base: Floats, knots: Floats, coefficients: Floats) -> Floats:
    """Return g, g' and ∫ x g' dx, in columns, at each x = sqrt(q^2 + base^2) > 0, where base is a knot or 0.

    The slope is f' = c0 + c1 s + c2 s^2 over s = r - knot, and the last piece has no end. Angles and s are formed
    without differences of nearly equal numbers; next to a knot, where g' begins like the root of the distance from it,
    x itself has too few digits.
    """
    out = np.zeros((q.size, 3))
    for i in range(q.size):
        a = math.sqrt(q[i] * q[i] + base[i] * base[i])
        for k in range(knots.size):
            knot = knots[k]
            if knot >= a:
                break
            root = _root(knot, a, q[i], base[i])
            angle = math.atan2(root, knot)
            if k + 1 < knots.size and knots[k + 1] < a:
                end = knots[k + 1]
                root_end = _root(end, a, q[i], base[i])
                sine = (end - knot) * (end + knot) * a * a / (end * root + knot * root_end)
                angle = math.atan2(sine, root * root_end + end * knot)
            nodes, weights = (_NODES_SMALL, _WEIGHTS_SMALL) if angle < _SMALL_ANGLE else (_NODES, _WEIGHTS)
            c0, c1, c2 = coefficients[k, 0], coefficients[k, 1], coefficients[k, 2]
            for j in range(nodes.size):
                half = 0.5 * angle * nodes[j]
                if angle < _SMALL_ANGLE:
                    square = half * half
                    sine = half * (1.0 - square / 6.0 * (1.0 - square / 20.0))
                    cosine = 1.0 - 0.5 * square * (1.0 - square / 12.0 * (1.0 - square / 30.0))
                else:
                    sine, cosine = math.sin(half), math.cos(half)
                s = 2.0 * sine * (root * cosine - knot * sine)
                r = knot + s
                slope = c0 + s * (c1 + s * c2)
                weight = angle * weights[j]
                out[i, 0] += weight * a * slope
                out[i, 1] += weight * (slope + r * (c1 + 2.0 * s * c2))
                out[i, 2] += weight * r * r * slope
    return out

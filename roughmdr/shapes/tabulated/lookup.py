"""The MDR profile of a tabulated shape as pieces of polynomials, looked up.

A form holds [number of dips, dips (from, to) ..., number of pieces, their begins ..., the end, for each piece its
knot, scale, middle, strain at its begin, the sums of the magnitudes of the coefficients of g and of ∫ x g' dx and the
coefficients of g, g' and ∫ x g' dx, and for what lies beyond the end its steepness, a constant, the strain at the end
and coefficients; then the number of knots and for each its r, f and the coefficients of f' over r - knot]. Over a piece
these are polynomials in the place q = scale sqrt(a^2 - knot^2) - middle, in which they are smooth although g' has the
kink of a root at every knot; beyond the end g - steepness a is one in 1/a^2.
"""

import math

import numpy as np

from roughmdr.numerics.vector_math import sqrt
from roughmdr.shapes.profile import Form, Profile

DEGREE = 13
HEAD = 6
PIECE = HEAD + 3 * (DEGREE + 1)
FAR = 3 + DEGREE + 1
KNOT = 5

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(20)
_NODES, _WEIGHTS = 0.5 * (1.0 + _NODES), 0.5 * _WEIGHTS


def _piece(t: float, form: Form) -> int:
    """Where the piece stands on which t lies; beyond the last the opposite of where the far field stands."""
    first = 2 + 2 * int(form[0])
    count = int(form[first - 1])
    if t >= form[first + count]:
        return -(first + count + 1 + PIECE * count)
    low, left = 0, count
    while left > 1:
        half = left // 2
        low, left = (low + half if t >= form[first + low + half] else low), left - half
    return first + count + 1 + PIECE * low


def _sum(place: float, begin: int, form: Form) -> float:
    """The polynomial whose coefficients stand from ``begin`` on."""
    square = place * place
    even, odd = form[begin + DEGREE - 1], form[begin + DEGREE]
    for i in range(DEGREE - 3, -1, -2):
        even, odd = even * square + form[begin + i], odd * square + form[begin + i + 1]
    return even + place * odd


def _place_on(t: float, piece: int, form: Form) -> float:
    knot = form[piece]
    return form[piece + 1] * sqrt((t - knot) * (t + knot)) - form[piece + 2]


def _far_sum(t: float, far: int, tilt: float, form: Form) -> float:
    """sum of c_k t^(-2k) times 1, or -2 k (tilt 1), or 2 k/(2 k - 1) (tilt 2), over the terms k of the far field."""
    total, u = 0.0, 1.0 / t / t
    for k in range(DEGREE, -1, -1):
        factor = 1.0 if tilt == 0.0 else (-2.0 * k if tilt == 1.0 else 2.0 * k / (2.0 * k - 1.0))
        total = total * u + factor * form[far + 3 + k]
    return total


def _mdr_profile(t: float, form: Form) -> tuple[float, float, float, float]:
    piece = _piece(t, form)
    if piece < 0:
        steepness = form[-piece]
        slope = steepness + _far_sum(t, -piece, 1.0, form) / t
        return t, 1.0, steepness * t + _far_sum(t, -piece, 0.0, form), slope
    place = _place_on(t, piece, form)
    return t, 1.0, _sum(place, piece + HEAD, form), _sum(place, piece + HEAD + 1 + DEGREE, form)


def _reduced_load(t: float, form: Form) -> float:
    piece = _piece(t, form)
    if piece < 0:
        return 0.5 * form[-piece] * t * t + form[1 - piece] + t * _far_sum(t, -piece, 2.0, form)
    return _sum(_place_on(t, piece, form), piece + HEAD + 2 + 2 * DEGREE, form)


def _mdr_integral(t: float, form: Form) -> float:
    return t * _mdr_profile(t, form)[2] - _reduced_load(t, form)


def _term_sizes(t: float, form: Form) -> tuple[float, float]:
    """At t on the tip, where there are three terms; else the most anywhere on the piece."""
    piece = _piece(t, form)
    if piece < 0:
        return 0.0, 0.0
    if form[piece] > 0.0:
        return form[piece + 4], form[piece + 5]
    g, push = 0.0, 0.0
    for k in range(3, 0, -1):
        g, push = (g + abs(form[piece + HEAD + k])) * t, (push + abs(form[piece + HEAD + 2 * DEGREE + 3 + k])) * t
    return g, push * t


def _roundings(form: Form) -> float:
    """As they are tested; those of the slope next to a knot among them."""
    return 64.0


def _f_and_slope(r: float, form: Form) -> tuple[float, float]:
    begins = 2 + 2 * int(form[0])
    spline = begins + int(form[begins - 1]) * (1 + PIECE) + 1 + FAR
    low, left = 0, int(form[spline])
    while left > 1:
        half = left // 2
        low, left = (low + half if r >= form[spline + 1 + KNOT * (low + half)] else low), left - half
    at = spline + 1 + KNOT * low
    s, c0, c1, c2 = r - form[at], form[at + 2], form[at + 3], form[at + 4]
    return form[at + 1] + s * (c0 + s * (c1 / 2.0 + s * c2 / 3.0)), c0 + s * (c1 + s * c2)


def _t_of_radius(radius: float, width: float, form: Form) -> float:
    return radius / width


def _softening_count(form: Form) -> int:
    return int(form[0])


def _softening_interval(index: int, form: Form) -> tuple[float, float]:
    return form[1 + 2 * index], form[2 + 2 * index]


def _kink(low: float, high: float, form: Form) -> bool:
    """At a knot g' begins like a root: it is smooth only well away from it."""
    first, last = _piece(low, form), _piece(high, form)
    if first < 0:
        return False
    knot = form[first]
    return last < 0 or form[last] != knot or (knot > 0.0 and high - low > 0.1 * (low - knot))


def _breakpoint_count(form: Form) -> int:
    """At the begin of each piece but the first, and at the end."""
    return int(form[1 + 2 * int(form[0])])


def _breakpoint(index: int, form: Form) -> tuple[float, float]:
    begins = 2 + 2 * int(form[0])
    count = int(form[begins - 1])
    begin = form[begins + index + 1]
    return begin, form[begins + count + 1 + PIECE * min(index + 1, count - 1)]


def strain_between(low: float, high: float, form: Form) -> float:
    """2 ∫ g' ∫ x g' dx dx from low to high on one piece, over the fourth power of the place in it."""
    total = 0.0
    for i in range(_NODES.size):
        z = _NODES[i]
        at = low + (high - low) * z * z * z * z
        total += 8.0 * (high - low) * _WEIGHTS[i] * z * z * z * _mdr_profile(at, form)[3] * _reduced_load(at, form)
    return total


def _elastic_integral(t: float, form: Form) -> float:
    piece = _piece(t, form)
    begins = 2 + 2 * int(form[0])
    count = int(form[begins - 1])
    if piece >= 0:
        return form[piece + 3] + strain_between(form[begins + (piece - begins - count - 1) // PIECE], t, form)
    total, low = form[2 - piece], form[begins + count]
    while low < t < math.inf:
        high = min(2.0 * low, t)
        total += strain_between(low, high, form)
        low = high
    return total


PROFILE = Profile(
    _mdr_profile,
    _reduced_load,
    _mdr_integral,
    _t_of_radius,
    _f_and_slope,
    _softening_count,
    _softening_interval,
    _kink,
    elastic_integral=_elastic_integral,
    breakpoint_count=_breakpoint_count,
    breakpoint=_breakpoint,
    roundings=_roundings,
    term_sizes=_term_sizes,
)

"""The MDR profile of a tabulated shape as pieces of polynomials, looked up.

A form holds [number of dips, dips (from, to) ..., number of pieces, their begins ..., the end, for each piece its
knot, scale, middle, strain at its begin, the sums of the magnitudes of the coefficients of g and of ∫ x g' dx and the
coefficients of g, g' and ∫ x g' dx, and for what lies beyond the end its steepness, a constant, the strain at the end
and coefficients; then the number of knots and for each its r, f and the coefficients of f' over r - knot]. Over a piece
these are polynomials in the place q = scale sqrt(a^2 - knot^2) - middle, in which they are smooth although g' has the
kink of a root at every knot; beyond the end g - steepness a is one in 1/a^2.
"""

import math

from roughmdr.numerics.gauss import unit_gauss
from roughmdr.numerics.vector_math import sqrt
from roughmdr.shapes.profile import Params, Profile

DEGREE = 13
HEAD = 6
PIECE = HEAD + 3 * (DEGREE + 1)
FAR = 3 + DEGREE + 1
KNOT = 5

_NODES, _WEIGHTS = unit_gauss(20)


def _piece(t: float, params: Params) -> int:
    """Where the piece stands on which t lies; beyond the last the opposite of where the far field stands."""
    first = 2 + 2 * int(params[0])
    count = int(params[first - 1])
    if t >= params[first + count]:
        return -(first + count + 1 + PIECE * count)
    low, left = 0, count
    while left > 1:
        half = left // 2
        low, left = (low + half if t >= params[first + low + half] else low), left - half
    return first + count + 1 + PIECE * low


def _sum(place: float, begin: int, params: Params) -> float:
    """The polynomial whose coefficients stand from ``begin`` on."""
    square = place * place
    even, odd = params[begin + DEGREE - 1], params[begin + DEGREE]
    for i in range(DEGREE - 3, -1, -2):
        even, odd = even * square + params[begin + i], odd * square + params[begin + i + 1]
    return even + place * odd


def _place_on(t: float, piece: int, params: Params) -> float:
    knot = params[piece]
    return params[piece + 1] * sqrt((t - knot) * (t + knot)) - params[piece + 2]


def _far_sum(t: float, far: int, tilt: float, params: Params) -> float:
    """sum of c_k t^(-2k) times 1, or -2 k (tilt 1), or 2 k/(2 k - 1) (tilt 2), over the terms k of the far field."""
    total, u = 0.0, 1.0 / t / t
    for k in range(DEGREE, -1, -1):
        factor = 1.0 if tilt == 0.0 else (-2.0 * k if tilt == 1.0 else 2.0 * k / (2.0 * k - 1.0))
        total = total * u + factor * params[far + 3 + k]
    return total


def _mdr_profile(t: float, params: Params) -> tuple[float, float, float, float]:
    piece = _piece(t, params)
    if piece < 0:
        steepness = params[-piece]
        slope = steepness + _far_sum(t, -piece, 1.0, params) / t
        return t, 1.0, steepness * t + _far_sum(t, -piece, 0.0, params), slope
    place = _place_on(t, piece, params)
    return t, 1.0, _sum(place, piece + HEAD, params), _sum(place, piece + HEAD + 1 + DEGREE, params)


def _reduced_load(t: float, params: Params) -> float:
    piece = _piece(t, params)
    if piece < 0:
        return 0.5 * params[-piece] * t * t + params[1 - piece] + t * _far_sum(t, -piece, 2.0, params)
    return _sum(_place_on(t, piece, params), piece + HEAD + 2 + 2 * DEGREE, params)


def _mdr_integral(t: float, params: Params) -> float:
    return t * _mdr_profile(t, params)[2] - _reduced_load(t, params)


def _term_sizes(t: float, params: Params) -> tuple[float, float]:
    """At t on the tip, where there are three terms; else the most anywhere on the piece."""
    piece = _piece(t, params)
    if piece < 0:
        return 0.0, 0.0
    if params[piece] > 0.0:
        return params[piece + 4], params[piece + 5]
    g, push = 0.0, 0.0
    for k in range(3, 0, -1):
        g, push = (g + abs(params[piece + HEAD + k])) * t, (push + abs(params[piece + HEAD + 2 * DEGREE + 3 + k])) * t
    return g, push * t


def _roundings(params: Params) -> float:
    """As they are tested; those of the slope next to a knot among them."""
    return 64.0


def _f_and_slope(r: float, params: Params) -> tuple[float, float]:
    begins = 2 + 2 * int(params[0])
    spline = begins + int(params[begins - 1]) * (1 + PIECE) + 1 + FAR
    low, left = 0, int(params[spline])
    while left > 1:
        half = left // 2
        low, left = (low + half if r >= params[spline + 1 + KNOT * (low + half)] else low), left - half
    at = spline + 1 + KNOT * low
    s, c0, c1, c2 = r - params[at], params[at + 2], params[at + 3], params[at + 4]
    return params[at + 1] + s * (c0 + s * (c1 / 2.0 + s * c2 / 3.0)), c0 + s * (c1 + s * c2)


def _t_of_radius(radius: float, width: float, params: Params) -> float:
    return radius / width


def _softening_count(params: Params) -> int:
    return int(params[0])


def _softening_interval(index: int, params: Params) -> tuple[float, float]:
    return params[1 + 2 * index], params[2 + 2 * index]


def _kink(low: float, high: float, params: Params) -> bool:
    """At a knot g' begins like a root: it is smooth only well away from it."""
    first, last = _piece(low, params), _piece(high, params)
    if first < 0:
        return False
    knot = params[first]
    return last < 0 or params[last] != knot or (knot > 0.0 and high - low > 0.1 * (low - knot))


def _breakpoint_count(params: Params) -> int:
    """At the begin of each piece but the first, and at the end."""
    return int(params[1 + 2 * int(params[0])])


def _breakpoint(index: int, params: Params) -> tuple[float, float]:
    begins = 2 + 2 * int(params[0])
    count = int(params[begins - 1])
    begin = params[begins + index + 1]
    return begin, params[begins + count + 1 + PIECE * min(index + 1, count - 1)]


def strain_between(low: float, high: float, params: Params) -> float:
    """2 ∫ g' ∫ x g' dx dx from low to high on one piece, over the fourth power of the place in it."""
    total = 0.0
    for i in range(_NODES.size):
        z = _NODES[i]
        at = low + (high - low) * z * z * z * z
        total += 8.0 * (high - low) * _WEIGHTS[i] * z * z * z * _mdr_profile(at, params)[3] * _reduced_load(at, params)
    return total


def _elastic_integral(t: float, params: Params) -> float:
    piece = _piece(t, params)
    begins = 2 + 2 * int(params[0])
    count = int(params[begins - 1])
    if piece >= 0:
        return params[piece + 3] + strain_between(params[begins + (piece - begins - count - 1) // PIECE], t, params)
    total, low = params[2 - piece], params[begins + count]
    while low < t < math.inf:
        high = min(2.0 * low, t)
        total += strain_between(low, high, params)
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

"""The functions of a tabulated profile, looked up in its params.

The params hold, one after another,
- the number of softening intervals, and the beginning and end of each;
- the number of pieces, where each begins, and where the last one ends;
- for each piece HEAD numbers (its knot, the scale and the shift of u, the elastic integral at its beginning, the sums
  of the magnitudes of the coefficients of g and of the reduced load), then the coefficients of g, of g' and of the
  reduced load as polynomials in u = scale sqrt(a^2 - knot^2) - shift, in which they are smooth although g' begins like
  a root at every knot;
- for the far field beyond the last piece the steepness S, a constant, the elastic integral at its beginning and the
  coefficients of g - S a in 1/a^2;
- the number of knots of the spline, and for each its r, its f and the coefficients of f' in r - knot.
"""

import math

from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.gauss import unit_gauss
from roughmdr.numerics.search import last_at_or_below
from roughmdr.numerics.vector_math import sqrt
from roughmdr.shapes.profile import Params, Profile

DEGREE = 13
HEAD = 6
PIECE = HEAD + 3 * (DEGREE + 1)
FAR = 3 + DEGREE + 1
KNOT = 5

_NODES, _WEIGHTS = unit_gauss(20)


def beginnings(params: Params | Floats) -> tuple[int, int]:
    """Return the offset of the beginnings of the pieces, and the number of pieces."""
    offset = 2 + 2 * int(params[0])
    return offset, int(params[offset - 1])


def _find_piece(t: float, params: Params) -> int:
    """Return the offset of the piece that t lies on; beyond the last one, minus the offset of the far field."""
    offset, count = beginnings(params)
    if t >= params[offset + count]:
        return -(offset + count + 1 + PIECE * count)
    return offset + count + 1 + PIECE * last_at_or_below(t, params, offset, 1, count)


def _polynomial(u: float, offset: int, params: Params) -> float:
    """Return the polynomial in u whose coefficients begin at ``offset``."""
    square = u * u
    even, odd = params[offset + DEGREE - 1], params[offset + DEGREE]
    for i in range(DEGREE - 3, -1, -2):
        even, odd = even * square + params[offset + i], odd * square + params[offset + i + 1]
    return even + u * odd


def _u(t: float, piece: int, params: Params) -> float:
    knot = params[piece]
    return params[piece + 1] * sqrt((t - knot) * (t + knot)) - params[piece + 2]


_VALUE, _SLOPE, _LOAD = 0, 1, 2


def _far_sum(t: float, far: int, kind: int, params: Params) -> float:
    """Return the sum of c_k t^(-2k) (for the value), times -2 k (slope) or 2 k/(2 k - 1) (reduced load)."""
    total, u = 0.0, 1.0 / t / t
    for k in range(DEGREE, -1, -1):
        factor = 1.0 if kind == _VALUE else (-2.0 * k if kind == _SLOPE else 2.0 * k / (2.0 * k - 1.0))
        total = total * u + factor * params[far + 3 + k]
    return total


def _mdr_profile(t: float, params: Params) -> tuple[float, float, float, float]:
    piece = _find_piece(t, params)
    if piece < 0:
        steepness = params[-piece]
        slope = steepness + _far_sum(t, -piece, _SLOPE, params) / t
        return t, 1.0, steepness * t + _far_sum(t, -piece, _VALUE, params), slope
    u = _u(t, piece, params)
    return t, 1.0, _polynomial(u, piece + HEAD, params), _polynomial(u, piece + HEAD + 1 + DEGREE, params)


def _reduced_load(t: float, params: Params) -> float:
    piece = _find_piece(t, params)
    if piece < 0:
        return 0.5 * params[-piece] * t * t + params[1 - piece] + t * _far_sum(t, -piece, _LOAD, params)
    return _polynomial(_u(t, piece, params), piece + HEAD + 2 + 2 * DEGREE, params)


def _term_sizes(t: float, params: Params) -> tuple[float, float]:
    """Return the sizes at t on the tip, where there are three terms; else the largest anywhere on the piece."""
    piece = _find_piece(t, params)
    if piece < 0:
        return 0.0, 0.0
    if params[piece] > 0.0:
        return params[piece + 4], params[piece + 5]
    g, load = 0.0, 0.0
    for k in range(3, 0, -1):
        g, load = (g + abs(params[piece + HEAD + k])) * t, (load + abs(params[piece + HEAD + 2 * DEGREE + 3 + k])) * t
    return g, load * t


def _roundings(params: Params) -> float:
    """Return the roundings as tests find them; those of the slope next to a knot among them."""
    return 64.0


def _f_and_slope(r: float, params: Params) -> tuple[float, float]:
    offset, count = beginnings(params)
    spline = offset + count * (1 + PIECE) + 1 + FAR
    knot = spline + 1 + KNOT * last_at_or_below(r, params, spline + 1, KNOT, int(params[spline]))
    s, c0, c1, c2 = r - params[knot], params[knot + 2], params[knot + 3], params[knot + 4]
    return params[knot + 1] + s * (c0 + s * (c1 / 2.0 + s * c2 / 3.0)), c0 + s * (c1 + s * c2)


def _softening_count(params: Params) -> int:
    return int(params[0])


def _softening_interval(index: int, params: Params) -> tuple[float, float]:
    return params[1 + 2 * index], params[2 + 2 * index]


def _kink(low: float, high: float, params: Params) -> bool:
    """Return whether there is a knot, where g' begins like a root, between low and high or just below low."""
    first, last = _find_piece(low, params), _find_piece(high, params)
    if first < 0:
        return False
    knot = params[first]
    return last < 0 or params[last] != knot or (knot > 0.0 and high - low > 0.1 * (low - knot))


def _breakpoint_count(params: Params) -> int:
    """Return the number of pieces: breakpoints are the beginnings of all but the first, and the end of the last."""
    return beginnings(params)[1]


def _breakpoint(index: int, params: Params) -> tuple[float, float]:
    offset, count = beginnings(params)
    return params[offset + index + 1], params[offset + count + 1 + PIECE * min(index + 1, count - 1)]


def elastic_integral_between(low: float, high: float, params: Params) -> float:
    """Return 2 ∫ g' ∫ x g' dx dx from low to high on one piece, over the fourth root of the distance from low."""
    total = 0.0
    for i in range(_NODES.size):
        z = _NODES[i]
        t = low + (high - low) * z * z * z * z
        total += 8.0 * (high - low) * _WEIGHTS[i] * z * z * z * _mdr_profile(t, params)[3] * _reduced_load(t, params)
    return total


def _elastic_integral(t: float, params: Params) -> float:
    piece = _find_piece(t, params)
    offset, count = beginnings(params)
    if piece >= 0:
        begin = params[offset + (piece - offset - count - 1) // PIECE]
        return params[piece + 3] + elastic_integral_between(begin, t, params)
    total, low = params[2 - piece], params[offset + count]
    while low < t < math.inf:
        high = min(2.0 * low, t)
        total += elastic_integral_between(low, high, params)
        low = high
    return total


PROFILE = Profile(
    _mdr_profile,
    _reduced_load,
    _f_and_slope,
    softening_count=_softening_count,
    softening_interval=_softening_interval,
    kink=_kink,
    elastic_integral=_elastic_integral,
    breakpoint_count=_breakpoint_count,
    breakpoint=_breakpoint,
    roundings=_roundings,
    term_sizes=_term_sizes,
)

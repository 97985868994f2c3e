"""The functions of a tabulated profile, looked up in its params.

The row of a piece (``shapes.pieces``) holds where it begins; the knot of the spline at or before it, with f and the
coefficients of f' in r - knot there; the scale and the shift of u, the elastic integral at its beginning, the sums of
the magnitudes of the coefficients of g and of the reduced load; and the coefficients of g, of g' and of the reduced
load as polynomials in u = scale sqrt(a^2 - knot^2) - shift, in which they are smooth although g' begins like a root at
every knot. The last row is that of the far field: with the steepness S and a constant for scale and shift, and the
coefficients of g - S a in 1/a^2 for those of g.
"""

import math

from roughmdr.numerics.gauss import unit_gauss
from roughmdr.numerics.vector_math import sqrt
from roughmdr.shapes.pieces import breakpoint_count, find, row, softening_count, softening_interval
from roughmdr.shapes.profile import Params, Profile

DEGREE = 13
KNOT, HEIGHT, SPLINE, SCALE, SHIFT, ELASTIC, SIZES = 1, 2, 3, 6, 7, 8, 9
G, SLOPE, LOAD = (11 + kind * (DEGREE + 1) for kind in range(3))
PIECE = LOAD + DEGREE + 1
STEEPNESS, CONSTANT = SCALE, SHIFT

_NODES, _WEIGHTS = unit_gauss(20)


def _is_far(piece: int, params: Params) -> bool:
    return piece == row(int(params[0]) - 1, params)


def _polynomial(u: float, offset: int, params: Params) -> float:
    """Return the polynomial in u whose coefficients begin at ``offset``."""
    square = u * u
    even, odd = params[offset + DEGREE - 1], params[offset + DEGREE]
    for i in range(DEGREE - 3, -1, -2):
        even, odd = even * square + params[offset + i], odd * square + params[offset + i + 1]
    return even + u * odd


def _u(t: float, piece: int, params: Params) -> float:
    knot = params[piece + KNOT]
    return params[piece + SCALE] * sqrt((t - knot) * (t + knot)) - params[piece + SHIFT]


def _far_sum(t: float, far: int, kind: int, params: Params) -> float:
    """Return the sum of c_k t^(-2k) (for the value), times -2 k (slope) or 2 k/(2 k - 1) (reduced load)."""
    total, u = 0.0, 1.0 / t / t
    for k in range(DEGREE, -1, -1):
        factor = 1.0 if kind == G else (-2.0 * k if kind == SLOPE else 2.0 * k / (2.0 * k - 1.0))
        total = total * u + factor * params[far + G + k]
    return total


def _mdr_profile(t: float, params: Params) -> tuple[float, float, float, float]:
    piece = find(t, PIECE, params)
    if _is_far(piece, params):
        steepness = params[piece + STEEPNESS]
        slope = steepness + _far_sum(t, piece, SLOPE, params) / t
        return t, 1.0, steepness * t + _far_sum(t, piece, G, params), slope
    u = _u(t, piece, params)
    return t, 1.0, _polynomial(u, piece + G, params), _polynomial(u, piece + SLOPE, params)


def _reduced_load(t: float, params: Params) -> float:
    piece = find(t, PIECE, params)
    if _is_far(piece, params):
        far = t * _far_sum(t, piece, LOAD, params)
        return 0.5 * params[piece + STEEPNESS] * t * t + params[piece + CONSTANT] + far
    return _polynomial(_u(t, piece, params), piece + LOAD, params)


def _term_sizes(t: float, params: Params) -> tuple[float, float]:
    """Return the sizes at t on the tip, where there are three terms; else the largest anywhere on the piece."""
    piece = find(t, PIECE, params)
    if params[piece + KNOT] > 0.0:
        return params[piece + SIZES], params[piece + SIZES + 1]
    g, load = 0.0, 0.0
    for k in range(3, 0, -1):
        g, load = (g + abs(params[piece + G + k])) * t, (load + abs(params[piece + LOAD + k + 1])) * t
    return g, load * t


def _roundings(params: Params) -> float:
    """Return the roundings as tests find them; those of the slope next to a knot among them."""
    return 64.0


def _f_and_slope(r: float, params: Params) -> tuple[float, float]:
    piece = find(r, PIECE, params)
    s, c0, c1, c2 = (
        r - params[piece + KNOT],
        params[piece + SPLINE],
        params[piece + SPLINE + 1],
        params[piece + SPLINE + 2],
    )
    return params[piece + HEIGHT] + s * (c0 + s * (c1 / 2.0 + s * c2 / 3.0)), c0 + s * (c1 + s * c2)


def _kink(low: float, high: float, params: Params) -> bool:
    """Return whether there is a knot, where g' begins like a root, between low and high or just below low."""
    first, last = find(low, PIECE, params), find(high, PIECE, params)
    if _is_far(first, params):
        return False
    knot = params[first + KNOT]
    return _is_far(last, params) or params[last + KNOT] != knot or (knot > 0.0 and high - low > 0.1 * (low - knot))


def _breakpoint(index: int, params: Params) -> tuple[float, float]:
    following = row(index + 1, params)
    return params[following], params[following + KNOT]


def elastic_integral_between(low: float, high: float, params: Params) -> float:
    """Return 2 ∫ g' ∫ x g' dx dx from low to high on one piece, over the fourth root of the distance from low."""
    total = 0.0
    for i in range(_NODES.size):
        z = _NODES[i]
        t = low + (high - low) * z * z * z * z
        total += 8.0 * (high - low) * _WEIGHTS[i] * z * z * z * _mdr_profile(t, params)[3] * _reduced_load(t, params)
    return total


def _elastic_integral(t: float, params: Params) -> float:
    piece = find(t, PIECE, params)
    total, low = params[piece + ELASTIC], params[piece]
    if not _is_far(piece, params):
        return total + elastic_integral_between(low, t, params)
    while low < t < math.inf:
        high = min(2.0 * low, t)
        total += elastic_integral_between(low, high, params)
        low = high
    return total


PROFILE = Profile(
    _mdr_profile,
    _reduced_load,
    _f_and_slope,
    softening_count=softening_count,
    softening_interval=softening_interval,
    kink=_kink,
    elastic_integral=_elastic_integral,
    breakpoint_count=breakpoint_count,
    breakpoint=_breakpoint,
    roundings=_roundings,
    term_sizes=_term_sizes,
)

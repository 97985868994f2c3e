"""The functions of a profile that is known by its MDR profile g, looked up in its params.

Between two radii of the table g is a cubic in s = x^2, so that every integral of g is a Gauss rule that is exact. The
params hold, one after another,
- the number of pieces, and for each PIECE numbers: the radius where it begins, g there, the coefficients of g in
  s - begin^2 from the first power on, the reduced load and the elastic integral at its beginning;
- the number of softening intervals, and the beginning and end of each.
"""

import math

from roughmdr.numerics.gauss import unit_gauss
from roughmdr.numerics.search import last_at_or_below
from roughmdr.shapes.profile import Params, Profile

PIECE = 7
G, FIRST, SECOND, THIRD, LOAD, ELASTIC = range(1, PIECE)

LOAD_NODES, LOAD_WEIGHTS = unit_gauss(4)  # exact to degree 7: x g' has degree 6
ELASTIC_NODES, ELASTIC_WEIGHTS = unit_gauss(7)  # exact to degree 13: g' times the load has degree 12
_ANGLE_NODES, _ANGLE_WEIGHTS = unit_gauss(16)  # of sines to the sixth power over at most a quarter of a turn


def _find_piece(t: float, params: Params) -> int:
    """Return the offset of the piece that t lies on."""
    return 1 + PIECE * last_at_or_below(t, params, 1, PIECE, int(params[0]))


def _g(t: float, piece: int, params: Params) -> float:
    u = (t - params[piece]) * (t + params[piece])
    return params[piece + G] + u * (params[piece + FIRST] + u * (params[piece + SECOND] + u * params[piece + THIRD]))


def _g_slope(t: float, piece: int, params: Params) -> float:
    u = (t - params[piece]) * (t + params[piece])
    return 2.0 * t * (params[piece + FIRST] + u * (2.0 * params[piece + SECOND] + 3.0 * u * params[piece + THIRD]))


def _mdr_profile(t: float, params: Params) -> tuple[float, float, float, float]:
    piece = _find_piece(t, params)
    return t, 1.0, _g(t, piece, params), _g_slope(t, piece, params)


def _load(t: float, piece: int, params: Params) -> float:
    begin, total = params[piece], 0.0
    for i in range(LOAD_NODES.size):
        x = begin + (t - begin) * LOAD_NODES[i]
        total += LOAD_WEIGHTS[i] * x * _g_slope(x, piece, params)
    return params[piece + LOAD] + (t - begin) * total


def _reduced_load(t: float, params: Params) -> float:
    return _load(t, _find_piece(t, params), params)


def _elastic_integral(t: float, params: Params) -> float:
    piece = _find_piece(t, params)
    begin, total = params[piece], 0.0
    for i in range(ELASTIC_NODES.size):
        x = begin + (t - begin) * ELASTIC_NODES[i]
        total += 2.0 * ELASTIC_WEIGHTS[i] * _g_slope(x, piece, params) * _load(x, piece, params)
    return params[piece + ELASTIC] + (t - begin) * total


def _f_and_slope(r: float, params: Params) -> tuple[float, float]:
    """Return f = 2/pi ∫ g(r sin v) dv from 0 to pi/2, the inverse of (H 17), and df/dr."""
    f, slope, begin = 0.0, 0.0, 0.0
    for number in range(int(params[0])):
        piece = 1 + PIECE * number
        last = number + 1 == int(params[0]) or params[piece + PIECE] >= r
        end = 0.5 * math.pi if last else math.asin(params[piece + PIECE] / r)
        for i in range(_ANGLE_NODES.size):
            sine = math.sin(begin + (end - begin) * _ANGLE_NODES[i])
            weight = 2.0 / math.pi * (end - begin) * _ANGLE_WEIGHTS[i]
            f += weight * _g(r * sine, piece, params)
            slope += weight * sine * _g_slope(r * sine, piece, params)
        if last:
            break
        begin = end
    return f, slope


def _intervals(params: Params) -> int:
    """Return the offset of the softening intervals."""
    return 1 + PIECE * int(params[0])


def _softening_count(params: Params) -> int:
    return int(params[_intervals(params)])


def _softening_interval(index: int, params: Params) -> tuple[float, float]:
    first = _intervals(params) + 1 + 2 * index
    return params[first], params[first + 1]


def _kink(low: float, high: float, params: Params) -> bool:
    """Return whether a piece begins between low and high."""
    following = _find_piece(low, params) + PIECE
    return following < _intervals(params) and params[following] < high


def _breakpoint_count(params: Params) -> int:
    return int(params[0]) - 1


def _breakpoint(index: int, params: Params) -> tuple[float, float]:
    return params[1 + PIECE * (index + 1)], 0.0  # beyond it too g is smooth in x


def _roundings(params: Params) -> float:
    """Return those of the cubic, whose terms cancel in part, and of the sum of the pieces before it."""
    return 32.0 + 4.0 * params[0]


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
)

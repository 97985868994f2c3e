"""A profile that is known by its MDR profile g: its functions, looked up in its params, and those of many at once.

Between two radii of the table g is a cubic in s = x^2, so that every integral of g is a Gauss rule that is exact. The
row of a piece (``shapes.pieces``) holds the radius where it begins, g there, the coefficients of g in s - begin^2 from
the first power on, the reduced load and the elastic integral at its beginning.
"""

import math

import numpy as np

from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.gauss import unit_gauss
from roughmdr.shapes.pieces import ROWS, breakpoint_count, find, row, softening_count, softening_interval
from roughmdr.shapes.profile import Params, Profile

PIECE = 7
G, FIRST, SECOND, THIRD, LOAD, ELASTIC = range(1, PIECE)

_LOAD_NODES, _LOAD_WEIGHTS = unit_gauss(4)  # exact to degree 7: x g' has degree 6
_ELASTIC_NODES, _ELASTIC_WEIGHTS = unit_gauss(7)  # exact to degree 13: g' times the load has degree 12
_ANGLE_NODES, _ANGLE_WEIGHTS = unit_gauss(16)  # for sines to the sixth power over at most a quarter of a turn
_BLOCK = 4096  # tables at once, which bounds the memory


def _g(t: float, piece: int, params: Params) -> float:
    u = (t - params[piece]) * (t + params[piece])
    return params[piece + G] + u * (params[piece + FIRST] + u * (params[piece + SECOND] + u * params[piece + THIRD]))


def _g_slope(t: float, piece: int, params: Params) -> float:
    u = (t - params[piece]) * (t + params[piece])
    return 2.0 * t * (params[piece + FIRST] + u * (2.0 * params[piece + SECOND] + 3.0 * u * params[piece + THIRD]))


def _mdr_profile(t: float, params: Params) -> tuple[float, float, float, float]:
    piece = find(t, PIECE, params)
    return t, 1.0, _g(t, piece, params), _g_slope(t, piece, params)


def _load(t: float, piece: int, params: Params) -> float:
    begin, total = params[piece], 0.0
    for i in range(_LOAD_NODES.size):
        x = begin + (t - begin) * _LOAD_NODES[i]
        total += _LOAD_WEIGHTS[i] * x * _g_slope(x, piece, params)
    return params[piece + LOAD] + (t - begin) * total


def _reduced_load(t: float, params: Params) -> float:
    return _load(t, find(t, PIECE, params), params)


def _elastic_integral(t: float, params: Params) -> float:
    piece = find(t, PIECE, params)
    begin, total = params[piece], 0.0
    for i in range(_ELASTIC_NODES.size):
        x = begin + (t - begin) * _ELASTIC_NODES[i]
        total += 2.0 * _ELASTIC_WEIGHTS[i] * _g_slope(x, piece, params) * _load(x, piece, params)
    return params[piece + ELASTIC] + (t - begin) * total


def _f_and_slope(r: float, params: Params) -> tuple[float, float]:
    """Return f = 2/pi ∫ g(r sin v) dv from 0 to pi/2, the inverse of (H 17), and df/dr."""
    f, slope, begin = 0.0, 0.0, 0.0
    for number in range(int(params[0])):
        piece = row(number, params)
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


def _kink(low: float, high: float, params: Params) -> bool:
    """Return whether a piece begins between low and high."""
    following = find(low, PIECE, params) + PIECE
    return following < row(int(params[0]), params) and params[following] < high


def _breakpoint(index: int, params: Params) -> tuple[float, float]:
    return params[row(index + 1, params)], 0.0  # beyond it too g is smooth in x


def _roundings(params: Params) -> float:
    """Return those of the cubic, whose terms cancel in part, and of the sum of the pieces before it."""
    return 32.0 + 4.0 * params[0]


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
)


def rows_of(radius: Floats, g: Floats) -> Floats:
    """Return the params of tables, [table, number], from radii and g at rising points, [table, point]; both above 0."""
    blocks = range(0, max(radius.shape[0], 1), _BLOCK)
    return np.concatenate([_rows(radius[i : i + _BLOCK], g[i : i + _BLOCK]) for i in blocks])


def knot_slopes(radius: Floats, g: Floats) -> Floats:
    """Return dg/ds at the tip and at each point, [table, point + 1], s = radius^2, so that g rises everywhere.

    Between two pieces it is the weighted harmonic mean of the chords (F. N. Fritsch, J. Butland, SIAM J. Sci. Stat.
    Comput. 5 (1984) 300), at the ends that of the parabola through three points, within a factor of two of the chord.
    """
    h, chord = _chords(radius, g)
    slopes = np.empty((radius.shape[0], radius.shape[1] + 1))
    if h.shape[1] == 1:
        slopes[:] = chord
        return slopes
    before, after = h[:, :-1] + 2.0 * h[:, 1:], 2.0 * h[:, :-1] + h[:, 1:]
    slopes[:, 1:-1] = (before + after) / (before / chord[:, :-1] + after / chord[:, 1:])
    for end, first, second in ((0, 0, 1), (-1, -1, -2)):
        share = h[:, first] / (h[:, first] + h[:, second])
        parabola = chord[:, first] + share * (chord[:, first] - chord[:, second])
        slopes[:, end] = np.clip(parabola, 0.5 * chord[:, first], 2.0 * chord[:, first])
    return slopes


def _chords(radius: Floats, g: Floats) -> tuple[Floats, Floats]:
    """Return the lengths in s of the pieces from the tip to the last point, and the slopes of their chords."""
    begin = np.pad(radius[:, :-1], ((0, 0), (1, 0)))
    h = (radius - begin) * (radius + begin)
    return h, np.diff(g, axis=1, prepend=0.0) / h


def _rows(radius: Floats, g: Floats) -> Floats:
    count, points = radius.shape
    h, chord = _chords(radius, g)
    slopes = knot_slopes(radius, g)
    pieces = np.zeros((count, points + 1, PIECE))
    pieces[:, 1:, 0], pieces[:, 1:, G], pieces[:, :, FIRST] = radius, g, slopes
    pieces[:, :-1, SECOND] = (3.0 * chord - 2.0 * slopes[:, :-1] - slopes[:, 1:]) / h
    pieces[:, :-1, THIRD] = (slopes[:, :-1] + slopes[:, 1:] - 2.0 * chord) / (h * h)
    _add_integrals(pieces)
    intervals = _softening_intervals(pieces)
    head = np.broadcast_to([points + 1.0, PIECE], (count, ROWS))
    return np.concatenate([head, pieces.reshape(count, -1), intervals], axis=1)


def _add_integrals(pieces: Floats) -> None:
    """Fill in the reduced load and the elastic integral at the beginning of each piece."""
    begin = pieces[:, :-1, :1]
    length = np.diff(pieces[:, :, 0], axis=1)[..., None]
    x = begin + length * _LOAD_NODES
    loads = np.sum(length * _LOAD_WEIGHTS * x * _slope(x, pieces[:, :-1]), axis=-1)
    pieces[:, 1:, LOAD] = np.cumsum(loads, axis=1)
    x = begin + length * _ELASTIC_NODES
    within = x[..., None] - begin[..., None]
    y = begin[..., None] + within * _LOAD_NODES
    load = np.sum(within * _LOAD_WEIGHTS * y * _slope(y, pieces[:, :-1]), axis=-1) + pieces[:, :-1, LOAD, None]
    energies = np.sum(2.0 * length * _ELASTIC_WEIGHTS * _slope(x, pieces[:, :-1]) * load, axis=-1)
    pieces[:, 1:, ELASTIC] = np.cumsum(energies, axis=1)


def _slope(x: Floats, pieces: Floats) -> Floats:
    """Return g' at x [table, piece, ...] on its piece."""
    columns = np.moveaxis(pieces, -1, 0)
    begin, first, second, third = (
        columns[i].reshape(*pieces.shape[:2], *[1] * (x.ndim - 2)) for i in (0, FIRST, SECOND, THIRD)
    )
    u = (x - begin) * (x + begin)
    return np.asarray(2.0 * x * (first + u * (2.0 * second + 3.0 * u * third)))


def _softening_intervals(pieces: Floats) -> Floats:
    """Return the number of intervals in which sqrt(a) g'(a) falls, and the ends of each.

    Its derivative has the sign of 3/4 dg/ds + s d2g/ds2, on a piece a parabola in s - begin^2, whose roots part what
    falls from what rises.
    """
    count, number, _ = pieces.shape
    begin, _, first, second, third, _, _ = np.moveaxis(pieces, -1, 0)
    s = begin * begin
    end = np.append(s[:, 1:], np.full((count, 1), np.inf), axis=1) - s
    c, b, a = 0.75 * first + 2.0 * s * second, 3.5 * second + 6.0 * s * third, 8.25 * third
    with np.errstate(all="ignore"):
        q = -0.5 * (b + np.copysign(np.sqrt(np.maximum(b * b - 4.0 * a * c, 0.0)), b))
        roots = np.sort(
            np.clip(np.nan_to_num(np.stack([q / a, c / q])), 0.0, np.where(np.isinf(end), 0.0, end)), axis=0
        )
    edges = np.stack([np.zeros_like(s), *roots, end], axis=-1)
    middle = np.where(np.isinf(edges[..., 1:]), edges[..., :-1], 0.5 * (edges[..., :-1] + edges[..., 1:]))
    falls = c[..., None] + middle * (b[..., None] + middle * a[..., None]) < 0.0
    falls &= edges[..., 1:] > edges[..., :-1]
    starts = np.sqrt(s[..., None] + edges[..., :-1]).reshape(count, -1)
    stops = np.sqrt(s[..., None] + edges[..., 1:]).reshape(count, -1)
    real = (edges[..., 1:] > edges[..., :-1]).reshape(count, -1)
    flat = falls.reshape(count, -1)
    result = np.zeros((count, 1 + 2 * number))
    for i in np.flatnonzero(flat.any(axis=1)):
        each = np.flatnonzero(real[i])
        down = np.concatenate([[False], flat[i, each], [False]])
        first_of, last_of = np.flatnonzero(down[1:] & ~down[:-1]), np.flatnonzero(down[:-1] & ~down[1:]) - 1
        found = np.column_stack([starts[i, each[first_of]], stops[i, each[last_of]]])[:number]
        result[i, 0] = len(found)
        result[i, 1 : 1 + found.size] = found.ravel()
    return result

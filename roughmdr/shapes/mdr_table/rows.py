"""The params of many MDR tables at once, as ``lookup`` describes them."""

import numpy as np

from roughmdr.numerics.arguments import Floats
from roughmdr.shapes.mdr_table.lookup import (
    ELASTIC,
    ELASTIC_NODES,
    ELASTIC_WEIGHTS,
    FIRST,
    LOAD,
    LOAD_NODES,
    LOAD_WEIGHTS,
    PIECE,
    SECOND,
    THIRD,
    G,
)

_BLOCK = 4096  # tables at once, which bounds the memory


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
    return np.concatenate([np.full((count, 1), points + 1.0), pieces.reshape(count, -1), intervals], axis=1)


def _add_integrals(pieces: Floats) -> None:
    """Fill in the reduced load and the elastic integral at the beginning of each piece."""
    begin = pieces[:, :-1, :1]
    length = np.diff(pieces[:, :, 0], axis=1)[..., None]
    x = begin + length * LOAD_NODES
    loads = np.sum(length * LOAD_WEIGHTS * x * _slope(x, pieces[:, :-1]), axis=-1)
    pieces[:, 1:, LOAD] = np.cumsum(loads, axis=1)
    x = begin + length * ELASTIC_NODES
    within = x[..., None] - begin[..., None]
    y = begin[..., None] + within * LOAD_NODES
    load = np.sum(within * LOAD_WEIGHTS * y * _slope(y, pieces[:, :-1]), axis=-1) + pieces[:, :-1, LOAD, None]
    energies = np.sum(2.0 * length * ELASTIC_WEIGHTS * _slope(x, pieces[:, :-1]) * load, axis=-1)
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
    for row in np.flatnonzero(flat.any(axis=1)):
        each = np.flatnonzero(real[row])
        down = np.concatenate([[False], flat[row, each], [False]])
        first_of, last_of = np.flatnonzero(down[1:] & ~down[:-1]), np.flatnonzero(down[:-1] & ~down[1:]) - 1
        found = np.column_stack([starts[row, each[first_of]], stops[row, each[last_of]]])[:number]
        result[row, 0] = len(found)
        result[row, 1 : 1 + found.size] = found.ravel()
    return result

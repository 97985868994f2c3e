"""The MDR profile of any profile f(r), on a row of springs (H 17): g = x ∫_0^x f'(r)/sqrt(x^2 - r^2) dr.

From each edge between springs to the next, f' is taken as a straight line whose mean is the slope of the chord of f.
Lines are integrated exactly, by ∫ dr/sqrt(x^2 - r^2) = -acos(r/x) and ∫ r dr/sqrt(x^2 - r^2) = -sqrt(x^2 - r^2). Summed
over the changes of slope and curvature at each edge r that is

    g = x sum (change of slope) acos(r/x) + x^2 sum (change of curvature) sqrt(1 - (r/x)^2).

Both kernels are smooth in r away from x. So the edges of a block that lies apart from a spring are replaced by a few,
those of Chebyshev's points, and blocks are the larger the further away they lie: N log N evaluations instead of N^2
(L. Greengard, V. Rokhlin, J. Comput. Phys. 73 (1987) 325, in one dimension).
"""

import numpy as np

from roughmdr.numerics.arguments import Floats, Ints

_BLOCK = 64  # edges in the smallest block
_POINTS = 20  # for a block: at the distance of its width, (3 + sqrt(8))^-20 is below a rounding
_CHUNK = 1 << 19  # numbers in memory at once

_NODES = 0.5 - 0.5 * np.cos(np.pi * (np.arange(_POINTS) + 0.5) / _POINTS)


def mdr_transform(heights: Floats) -> Floats:
    """Return g [m] at (i + 1/2) dx from f [m] at i dx, i = 0, 1, ...: one number less. Lengths are in units of dx."""
    slope, curvature = _lines(heights)
    steps = np.stack([np.diff(slope, prepend=0.0), np.diff(curvature, prepend=0.0)])
    count = slope.size
    blocks = np.pad(steps, ((0, 0), (_BLOCK, -count % _BLOCK))).reshape(2, -1, _BLOCK)
    near = np.concatenate([blocks[:, :-1], blocks[:, 1:]], axis=2)  # a block and the one before it
    block = np.arange(count) // _BLOCK
    g = np.zeros(count)
    _add(g, np.arange(count), block, near, _BLOCK * (block - 1), np.arange(2.0 * _BLOCK))
    size, moments = _BLOCK, blocks[:, 1:] @ _weights(np.arange(_BLOCK) / _BLOCK)
    while moments.shape[1] > 2:
        block = np.arange(count) // size
        for back in (2, 3):  # the third before is not in the larger block that counts for all, where the number is odd
            far = np.flatnonzero((block >= back) & ((block % 2 == 1) | (back == 2)))
            source = block[far] - back
            _add(g, far, source, moments, size * source, size * _NODES)
        moments = np.pad(moments, ((0, 0), (0, moments.shape[1] % 2), (0, 0)))
        moments = moments[:, ::2] @ _weights(0.5 * _NODES) + moments[:, 1::2] @ _weights(0.5 + 0.5 * _NODES)
        size *= 2
    return g


def _lines(heights: Floats) -> tuple[Floats, Floats]:
    """Return f' on each piece, extrapolated to the axis, and its slope, from the chords beside it."""
    chord = np.diff(heights)
    limit = 2.0 * np.abs(chord)
    curvature = np.clip(np.gradient(chord), -limit, limit)
    return chord - curvature * (np.arange(chord.size) + 0.5), curvature


def _weights(positions: Floats) -> Floats:
    """Return the weights at Chebyshev's points that replace a source at each position in a block, from 0 to 1."""
    basis = np.polynomial.chebyshev.chebvander
    basis_at_nodes = basis(2.0 * _NODES - 1.0, _POINTS - 1)
    return np.asarray(basis(2.0 * positions - 1.0, _POINTS - 1) @ np.linalg.inv(basis_at_nodes))


def _add(g: Floats, springs: Ints, source: Ints, steps: Floats, begin: Ints, positions: Floats) -> None:
    """Add to g of some springs the steps of one source block each, at ``begin`` plus ``positions``."""
    chunk = _CHUNK // positions.size
    for first in range(0, springs.size, chunk):
        part = slice(first, first + chunk)
        x = springs[part] + 0.5
        ratio = np.clip((begin[part, None] + positions) / x[:, None], -1.0, 1.0)
        slope, curvature = steps[:, source[part]]
        g[springs[part]] += x * (np.arccos(ratio) * slope).sum(axis=1)
        g[springs[part]] += x * x * (np.sqrt((1.0 - ratio) * (1.0 + ratio)) * curvature).sum(axis=1)

"""The MDR profile of any profile f(r), on a row of springs (H 17): g = x ∫_0^x f'(r)/sqrt(x^2 - r^2) dr.

From each edge between springs to the next f' is taken as a straight line, whose mean is the chord of f. Lines are
integrated exactly, by ∫ dr/sqrt(x^2 - r^2) = -acos(r/x) and ∫ r dr/sqrt(x^2 - r^2) = -sqrt(x^2 - r^2). Added up by what
changes in slope and bend at each edge r that is

    g = x sum (change of slope) acos(r/x) + x^2 sum (change of bend) sqrt(1 - (r/x)^2).

Both kernels are smooth in r away from x. So the edges of a block that lies apart from a spring count as few edges,
those of Chebyshev's points, and blocks are the larger the further away they lie: N log N evaluations instead of N^2
(L. Greengard, V. Rokhlin, J. Comput. Phys. 73 (1987) 325, in one dimension).
"""

import numpy as np
from numpy.typing import NDArray

from roughmdr.numerics.arguments import Floats

Ints = NDArray[np.int64]

_BLOCK = 64  # edges in the smallest block
_POINTS = 20  # that stand for a block: as far as it is wide, 3 + sqrt(8) to this power is below a rounding
_AT_ONCE = 1 << 19  # numbers that are worked on

_PLACES = 0.5 - 0.5 * np.cos(np.pi * (np.arange(_POINTS) + 0.5) / _POINTS)


def reduced(heights: Floats) -> Floats:
    """g [m] at (i + 1/2) dx from f [m] at i dx, i = 0, 1, ...: one number less. Lengths count in dx."""
    slope, bend = _lines(heights)
    steps = np.stack([np.diff(slope, prepend=0.0), np.diff(bend, prepend=0.0)])
    count = slope.size
    blocks = np.pad(steps, ((0, 0), (_BLOCK, -count % _BLOCK))).reshape(2, -1, _BLOCK)
    near = np.concatenate([blocks[:, :-1], blocks[:, 1:]], axis=2)  # a block and the one before it
    block = np.arange(count) // _BLOCK
    g = np.zeros(count)
    _add(g, np.arange(count), block, near, _BLOCK * (block - 1), np.arange(2.0 * _BLOCK))
    size, moments = _BLOCK, blocks[:, 1:] @ _shares(np.arange(_BLOCK) / _BLOCK)
    while moments.shape[1] > 2:
        block = np.arange(count) // size
        for back in (2, 3):  # the third before is not in the larger block that counts for all, where the number is odd
            far = np.flatnonzero((block >= back) & ((block % 2 == 1) | (back == 2)))
            source = block[far] - back
            _add(g, far, source, moments, size * source, size * _PLACES)
        moments = np.pad(moments, ((0, 0), (0, moments.shape[1] % 2), (0, 0)))
        moments = moments[:, ::2] @ _shares(0.5 * _PLACES) + moments[:, 1::2] @ _shares(0.5 + 0.5 * _PLACES)
        size *= 2
    return g


def _lines(heights: Floats) -> tuple[Floats, Floats]:
    """The slope that f' has on the axis, and its bend: that of the neighbours' chords as far as f does not fall."""
    chord = np.diff(heights)
    most = 2.0 * np.abs(chord)
    bend = np.clip(np.gradient(chord), -most, most)
    return chord - bend * (np.arange(chord.size) + 0.5), bend


def _shares(places: Floats) -> Floats:
    """What each place in a block, from 0 to 1, counts at each of Chebyshev's points."""
    basis = np.polynomial.chebyshev.chebvander
    own = basis(2.0 * _PLACES - 1.0, _POINTS - 1)
    return np.asarray(basis(2.0 * places - 1.0, _POINTS - 1) @ np.linalg.inv(own))


def _add(g: Floats, springs: Ints, source: Ints, steps: Floats, begin: Ints, places: Floats) -> None:
    """Add to g of some springs what the steps of one source each, from a begin on at some places, make of it."""
    chunk = _AT_ONCE // places.size
    for first in range(0, springs.size, chunk):
        part = slice(first, first + chunk)
        x = springs[part] + 0.5
        ratio = np.clip((begin[part, None] + places) / x[:, None], -1.0, 1.0)
        slope, bend = steps[:, source[part]]
        g[springs[part]] += x * (np.arccos(ratio) * slope).sum(axis=1)
        g[springs[part]] += x * x * (np.sqrt((1.0 - ratio) * (1.0 + ratio)) * bend).sum(axis=1)

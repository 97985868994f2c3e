"""The random numbers that an ensemble is drawn with, a stream for each quantity: independent, or evenly spread.

Streams are never renumbered: the results of old seeds hang on them.
"""

from collections.abc import Callable

import numpy as np

from roughmdr.numerics.arguments import Floats

HEIGHT, POSITION, PARAMETER = 0, 1, 2
"""Streams of the heights, the positions, and the first of the shape parameters; more of them follow."""
COUNT, POPULATION = 100, 101
"""Streams of the number of asperities, and of which population each belongs to."""
_SPREAD = 1000  # the stream of what scrambles the evenly spread numbers

_BITS = 52
SMALLEST_UNIFORM = 0.5 * 2.0**-_BITS

Streams = Callable[[int, int], Floats]
"""(stream, count) -> ``count`` numbers in (0, 1), never 0 or 1."""


def uniforms(seed: int, realization: int, stream: int, count: int) -> Floats:
    """``count`` numbers in (0, 1), never 0 or 1, from one stream of one realization.

    The raw bits of Philox are the same in every version of numpy; a longer draw begins with the shorter one.
    """
    leading: Floats = (_philox(seed, realization, stream).random_raw(count) >> np.uint64(64 - _BITS)).astype(np.float64)
    return (leading + 0.5) * 2.0**-_BITS


def independent(seed: int, realization: int) -> Streams:
    """Streams of independent numbers."""
    return lambda stream, count: uniforms(seed, realization, stream, count)


def spread(seed: int, realization: int, streams: tuple[int, ...]) -> Streams:
    """The given streams as the coordinates of points that fill the cube evenly; all other streams are independent.

    A Sobol sequence, scrambled anew in each realization (A. B. Owen, J. Complexity 14 (1998) 466).
    """
    points: dict[int, Floats] = {}

    def draw(stream: int, count: int) -> Floats:
        if stream not in streams:
            return uniforms(seed, realization, stream, count)
        if count not in points:
            from scipy.stats.qmc import Sobol

            scramble = np.random.Generator(_philox(seed, realization, _SPREAD))
            sequence = Sobol(len(streams), bits=_BITS, rng=scramble)
            whole = sequence.random_base2((count - 1).bit_length())[:count]  # of any other number scipy warns
            points[count] = np.ascontiguousarray(whole.T) + SMALLEST_UNIFORM
        coordinate: Floats = points[count][streams.index(stream)]
        return coordinate

    return draw


def _philox(seed: int, realization: int, stream: int) -> np.random.Philox:
    return np.random.Philox(np.random.SeedSequence(seed, spawn_key=(realization, stream)))

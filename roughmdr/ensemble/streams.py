"""Random numbers of an ensemble: a numbered stream of uniform numbers for each quantity that is drawn.

Seed, realisation and number determine a stream, so that one quantity never changes what another draws. Streams are
never renumbered: the numbers below decide the results of every seed.
"""

from collections.abc import Callable
from functools import cache

import numpy as np

from roughmdr.numerics.arguments import Floats

HEIGHT, POSITION, PARAMETER = 0, 1, 2  # PARAMETER is the first shape parameter; those of further parameters follow
COUNT, POPULATION = 100, 101  # the number of asperities, and the population that each belongs to
WAVES = 200  # the amplitudes of the waves of a map, two numbers each
_SCRAMBLE = 1000  # stream for the scrambling of stratified numbers

_BITS = 52
SMALLEST_UNIFORM = 0.5 * 2.0**-_BITS

Streams = Callable[[int, int], Floats]
"""(stream, count) -> the first ``count`` numbers of the stream, in (0, 1), never 0 or 1."""


def _philox(seed: int, realization: int, stream: int) -> np.random.Philox:
    return np.random.Philox(np.random.SeedSequence(seed, spawn_key=(realization, stream)))


def uniforms(seed: int, realization: int, stream: int, count: int) -> Floats:
    """Return the first ``count`` numbers, in (0, 1), never 0 or 1, of one stream of one realisation.

    The raw bits of Philox are the same in every version of numpy; a longer draw begins with the shorter one.
    """
    leading: Floats = (_philox(seed, realization, stream).random_raw(count) >> np.uint64(64 - _BITS)).astype(np.float64)
    return (leading + 0.5) * 2.0**-_BITS


def make_streams(seed: int, realization: int, stratified: tuple[int, ...] = ()) -> Streams:
    """Return streams of independent numbers, but for those in ``stratified``, which cover the unit cube evenly.

    They are a Sobol sequence, scrambled anew in each realisation (A. B. Owen, J. Complexity 14 (1998) 466).
    """

    @cache
    def points(count: int) -> Floats:
        from scipy.stats.qmc import Sobol

        scramble = np.random.Generator(_philox(seed, realization, _SCRAMBLE))
        sequence = Sobol(len(stratified), bits=_BITS, rng=scramble)
        sobol = sequence.random_base2((count - 1).bit_length())[:count]  # scipy warns unless the count is a power of 2
        return np.ascontiguousarray(sobol.T) + SMALLEST_UNIFORM

    def draw(stream: int, count: int) -> Floats:
        if stream not in stratified:
            return uniforms(seed, realization, stream, count)
        coordinate: Floats = points(count)[stratified.index(stream)]
        return coordinate

    return draw


def poisson(streams: Streams, mean: float) -> int:
    """Draw the number of asperities of a realisation, where they are independent and ``mean`` on average."""
    from scipy.special import pdtr, pdtrik

    uniform = float(streams(COUNT, 1)[0])
    count = max(int(np.ceil(pdtrik(uniform, mean))), 0)
    return count - 1 if count > 0 and pdtr(count - 1, mean) >= uniform else count

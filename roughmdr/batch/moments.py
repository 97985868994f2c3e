"""Moments of many realisations in place of their curves, with the same bits in whatever order these come in.

Realisations are merged in twos, those in fours, and so on, always in the blocks [0, 2) [2, 4) [4, 8) ..., so that
the result does not depend on who computed which of them, or when.
"""

import math
from collections.abc import Iterator
from functools import reduce
from typing import Any, Generic, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from roughmdr.numerics.arguments import Floats

_AT_ONCE = 2**20  # most numbers that are merged at once, 8 MB, of which five copies stand in memory


class Moments(NamedTuple):
    """Number, mean, standard deviation (of these, not an estimate for all that could be drawn), minimum and maximum."""

    size: int
    mean: Floats
    spread: Floats
    minimum: Floats
    maximum: Floats

    @classmethod
    def of(cls, values: Floats) -> "Moments":
        """Return the moments of one realisation."""
        return cls(1, values, np.zeros_like(values), values, values)

    def merged(self, other: "Moments") -> "Moments":
        """Return the moments of both (T. F. Chan, G. H. Golub, R. J. LeVeque, Am. Stat. 37 (1983) 242, eq. 2.1).

        No square leaves the range of a float, and no difference does.
        """
        count = self.size + other.size
        mean, spread = _merged(self[1:3], other[1:3], self.size / count, other.size / count)
        extremes = np.minimum(self.minimum, other.minimum), np.maximum(self.maximum, other.maximum)
        return Moments(count, mean, spread, *extremes)

    def select(self, index: Any) -> "Moments":
        """Return the moments of a part of the arrays."""
        return Moments(self.size, *(array[index] for array in self[1:]))

    @property
    def standard_error(self) -> Floats:
        """Standard error of the mean; NaN for a single realisation."""
        if self.size < 2:
            return np.full_like(self.mean, math.nan)
        return np.asarray(self.spread / math.sqrt(self.size - 1))


ROWS = ("count", "mean", "spread", "minimum", "maximum")
COUNT, MEAN, SPREAD, MINIMUM, MAXIMUM = range(len(ROWS))


class KnownMoments(NamedTuple):
    """Moments of numbers that not every realisation has, such as its pull-off force: NaN stands for none."""

    size: int
    """Number of realisations, with the number or without."""
    table: Floats
    """[row of ROWS, number], over the realisations that have it; NaN but for the count where none has."""

    @classmethod
    def of(cls, values: Floats) -> "KnownMoments":
        """Return the moments of one realisation: [number]."""
        spread = np.where(np.isnan(values), np.nan, 0.0)
        return cls(1, np.array([np.where(np.isnan(values), 0.0, 1.0), values, spread, values, values]))

    def merged(self, other: "KnownMoments") -> "KnownMoments":
        """Return the moments of both, as ``Moments.merged`` does where every realisation counts."""
        one, two = self.table, other.table
        count = one[COUNT] + two[COUNT]
        weights = (each[COUNT] / np.maximum(count, 1.0) for each in (one, two))
        mean, spread = _merged((one[MEAN], one[SPREAD]), (two[MEAN], two[SPREAD]), *weights)
        extremes = np.fmin(one[MINIMUM], two[MINIMUM]), np.fmax(one[MAXIMUM], two[MAXIMUM])
        merged = np.array([count, mean, spread, *extremes])
        merged = np.where(one[COUNT] == 0.0, two, np.where(two[COUNT] == 0.0, one, merged))
        return KnownMoments(self.size + other.size, merged)


def _merged(
    one: tuple[Floats, ...], other: tuple[Floats, ...], weight: Floats | float, other_weight: Floats | float
) -> tuple[Floats, Floats]:
    """Return the mean and the spread of both from those of each and their shares of the number."""
    (mean, spread), (other_mean, other_spread) = one, other
    half = 0.5 * other_mean - 0.5 * mean
    within = np.hypot(np.sqrt(weight) * spread, np.sqrt(other_weight) * other_spread)
    return mean + (2.0 * other_weight) * half, np.hypot(within, (2.0 * np.sqrt(weight * other_weight)) * half)


def dyadic_blocks(first: int, last: int) -> Iterator[tuple[int, int]]:
    """Yield first realisation and size of the blocks in which the realisations first ... last - 1 are merged."""
    while first < last:
        size = 1 << (last - first).bit_length() - 1
        if first:
            size = min(size, first & -first)
        yield first, size
        first += size


def block_moments(first: int, values: Floats) -> Iterator[tuple[int, Moments]]:
    """Yield the first realisation and the moments of each block of ``values`` [realization, ...], from ``first`` on."""
    for begin, count in dyadic_blocks(first, first + len(values)):
        yield begin, _moments_of_block(values[begin - first : begin - first + count])


def _moments_of_block(values: Floats) -> Moments:
    """Merge neighbours, and those again; the halves of what would take much memory one after the other."""
    half = len(values) // 2
    if half and values.size > _AT_ONCE:
        return _moments_of_block(values[:half]).merged(_moments_of_block(values[half:]))
    moments = Moments.of(values)
    while len(moments.mean) > 1:
        moments = moments.select(np.s_[0::2]).merged(moments.select(np.s_[1::2]))
    return moments.select(0)


def moments_of(values: Floats) -> Moments:
    """Return the moments of the realisations along the first axis, of which there is at least one."""
    return reduce(Moments.merged, (moments for _, moments in block_moments(0, values)))


def mean_and_error(values: Floats, done: NDArray[np.bool_]) -> tuple[Floats, Floats]:
    """Return the mean and its standard error over the realisations that are ``done`` [..., realization], cell by cell.

    ``values`` lie over the same and, where there are more dimensions, over those too. NaN for the error of a single
    realisation, and for both where none is done.
    """
    mean, error, *_ = statistics_of(values, done)
    return mean, error


def statistics_of(values: Floats, done: NDArray[np.bool_]) -> tuple[Floats, ...]:
    """Return mean, standard error, minimum and maximum, as ``mean_and_error`` does the first two."""
    values = np.moveaxis(values, done.ndim - 1, 0)
    if done.all():
        return _statistics(values)
    found = tuple(np.full(values.shape[1:], math.nan) for _ in range(4))
    for cell in np.ndindex(done.shape[:-1]):
        kept = values[(done[cell], *cell)]
        for array, value in zip(found, _statistics(kept), strict=True) if len(kept) else ():
            array[cell] = value
    return found


def _statistics(values: Floats) -> tuple[Floats, ...]:
    moments = moments_of(values)
    return moments.mean, moments.standard_error, moments.minimum, moments.maximum


_Block = TypeVar("_Block", Moments, KnownMoments)


class MomentTree(Generic[_Block]):
    """Moments of one cell, merged as far as possible: as many blocks as their number has binary digits."""

    def __init__(self) -> None:
        self.blocks: dict[int, _Block] = {}
        """By the first realisation of each block."""

    def add(self, first: int, moments: _Block) -> None:
        """Add a block that begins at the realisation ``first``."""
        while (neighbour := self.blocks.get(first ^ moments.size)) and neighbour.size == moments.size:
            del self.blocks[first ^ moments.size]
            moments = moments.merged(neighbour) if not first & moments.size else neighbour.merged(moments)
            first &= ~(moments.size >> 1)
        self.blocks[first] = moments

    def total(self, count: int) -> _Block | None:
        """Return the moments of the first ``count`` realisations; None where some are missing."""
        sizes = dict(dyadic_blocks(0, count))
        if any(first not in self.blocks or self.blocks[first].size != size for first, size in sizes.items()):
            return None
        return reduce(lambda one, other: one.merged(other), (self.blocks[first] for first in sizes))

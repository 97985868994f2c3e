"""Moments of many realisations in place of their curves, with the same bits in whatever order these come in.

Realisations are merged in twos, those in fours, and so on, always in the blocks [0, 2) [2, 4) [4, 8) ..., so that
the result does not depend on who computed which of them, or when.
"""

import math
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from roughmdr.numerics.arguments import Floats


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
        weight, other_weight = self.size / count, other.size / count
        half = 0.5 * other.mean - 0.5 * self.mean
        within = np.hypot(math.sqrt(weight) * self.spread, math.sqrt(other_weight) * other.spread)
        return Moments(
            count,
            self.mean + (2.0 * other_weight) * half,
            np.hypot(within, (2.0 * math.sqrt(weight * other_weight)) * half),
            np.minimum(self.minimum, other.minimum),
            np.maximum(self.maximum, other.maximum),
        )

    def select(self, index: Any) -> "Moments":
        """Return the moments of a part of the arrays."""
        return Moments(self.size, *(array[index] for array in self[1:]))

    @property
    def standard_error(self) -> Floats:
        """Standard error of the mean; NaN for a single realisation."""
        if self.size < 2:
            return np.full_like(self.mean, math.nan)
        return np.asarray(self.spread / math.sqrt(self.size - 1))


def dyadic_blocks(first: int, last: int) -> Iterator[tuple[int, int]]:
    """Yield first realisation and size of the blocks in which the realisations first ... last - 1 are merged."""
    while first < last:
        size = 1 << (last - first).bit_length() - 1
        if first:
            size = min(size, first & -first)
        yield first, size
        first += size


def block_moments(first: int, values: Floats) -> Iterator[tuple[int, Moments]]:
    """Yield each block of the realisations ``first`` ..., whose ``values`` lie along the first axis: where it begins,
    and its moments.
    """
    for begin, count in dyadic_blocks(first, first + len(values)):
        moments = Moments.of(values[begin - first : begin - first + count])
        while len(moments.mean) > 1:
            moments = moments.select(np.s_[0::2]).merged(moments.select(np.s_[1::2]))
        yield begin, moments.select(0)


def moments_of(values: Floats) -> Moments:
    """Return the moments of the realisations along the first axis, of which there is at least one."""
    tree = MomentTree()
    tree.add_curves(0, values)
    total = tree.total(len(values))
    if total is None:
        raise AssertionError("there is at least one realisation")
    return total


class MomentTree:
    """Moments of one cell, merged as far as possible: as many blocks as their number has binary digits."""

    def __init__(self) -> None:
        self.blocks: dict[int, Moments] = {}
        """By the first realisation of each block."""

    def add(self, first: int, moments: Moments) -> None:
        """Add a block that begins at the realisation ``first``."""
        while (neighbour := self.blocks.get(first ^ moments.size)) and neighbour.size == moments.size:
            del self.blocks[first ^ moments.size]
            moments = moments.merged(neighbour) if not first & moments.size else neighbour.merged(moments)
            first &= ~(moments.size >> 1)
        self.blocks[first] = moments

    def add_curves(self, first: int, values: Floats) -> None:
        """Add single realisations along the first axis."""
        for begin, moments in block_moments(first, values):
            self.add(begin, moments)

    def total(self, count: int) -> Moments | None:
        """Return the moments of the first ``count`` realisations; None where some are missing."""
        total: Moments | None = None
        for first, size in dyadic_blocks(0, count):
            block = self.blocks.get(first)
            if block is None or block.size != size:
                return None
            total = block if total is None else total.merged(block)
        return total

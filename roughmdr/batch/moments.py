"""What is kept of many realisations instead of their curves, however they come in: the same bits for any order.

Realisations are put together in twos, those in fours, and so on: [0, 2) [2, 4) [4, 8) ..., always at the same places,
so that what comes out does not depend on who computed which of them, or when.
"""

import math
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from roughmdr.numerics.arguments import Floats


class Moments(NamedTuple):
    """How many, mean, standard deviation (of these, not of all that could be drawn), least and greatest."""

    size: int
    mean: Floats
    spread: Floats
    least: Floats
    greatest: Floats

    @classmethod
    def of(cls, values: Floats) -> "Moments":
        """Of one realisation."""
        return cls(1, values, np.zeros_like(values), values, values)

    def joined(self, other: "Moments") -> "Moments":
        """Of both together (T. F. Chan, G. H. Golub, R. J. LeVeque, Am. Stat. 37 (1983) 242, eq. 2.1).

        No square leaves the range of a float, and nor does a difference.
        """
        count = self.size + other.size
        own, others = self.size / count, other.size / count
        half = 0.5 * other.mean - 0.5 * self.mean
        within = np.hypot(math.sqrt(own) * self.spread, math.sqrt(others) * other.spread)
        return Moments(
            count,
            self.mean + (2.0 * others) * half,
            np.hypot(within, (2.0 * math.sqrt(own * others)) * half),
            np.minimum(self.least, other.least),
            np.maximum(self.greatest, other.greatest),
        )

    def picked(self, index: Any) -> "Moments":
        """The same of a part of the arrays."""
        return Moments(self.size, *(array[index] for array in self[1:]))

    @property
    def standard_error(self) -> Floats:
        """Of the mean; NaN for a single realisation, which has none."""
        if self.size < 2:
            return np.full_like(self.mean, math.nan)
        return np.asarray(self.spread / math.sqrt(self.size - 1))


def spans(first: int, last: int) -> Iterator[tuple[int, int]]:
    """The places at which the realisations first ... last - 1 are put together: where each begins, and how many."""
    while first < last:
        count = 1 << (last - first).bit_length() - 1
        if first:
            count = min(count, first & -first)
        yield first, count
        first += count


def moments_of(first: int, values: Floats) -> Iterator[tuple[int, Moments]]:
    """Tallies of the realisations ``first`` and so on, whose ``values`` lie along the first axis, with their places."""
    for begin, count in spans(first, first + len(values)):
        tally = Moments.of(values[begin - first : begin - first + count])
        while len(tally.mean) > 1:
            tally = tally.picked(np.s_[0::2]).joined(tally.picked(np.s_[1::2]))
        yield begin, tally.picked(0)


class MomentTree:
    """The tallies of one cell, put together as far as they go: as many are held as their number has binary digits."""

    def __init__(self) -> None:
        self.held: dict[int, Moments] = {}
        """By the place where each begins."""

    def add(self, first: int, tally: Moments) -> None:
        """Take in one more; ``first`` is where it begins."""
        while (neighbour := self.held.get(first ^ tally.size)) and neighbour.size == tally.size:
            del self.held[first ^ tally.size]
            tally = tally.joined(neighbour) if not first & tally.size else neighbour.joined(tally)
            first &= ~(tally.size >> 1)
        self.held[first] = tally

    def add_all(self, first: int, values: Floats) -> None:
        """Take in single realisations along the first axis."""
        for begin, tally in moments_of(first, values):
            self.add(begin, tally)

    def total(self, count: int) -> Moments | None:
        """Of the first ``count`` realisations; None where some are missing."""
        parts = [self.held.get(first) for first, _ in spans(0, count)]
        whole: Moments | None = None
        for part, (_, size) in zip(parts, spans(0, count), strict=True):
            if part is None or part.size != size:
                return None
            whole = part if whole is None else whole.joined(part)
        return whole

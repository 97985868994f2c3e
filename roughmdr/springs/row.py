"""Rows of springs, and how long a row has to be."""

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from roughmdr.errors import OutOfRange
from roughmdr.numerics.arguments import Floats
from roughmdr.springs.profile import MdrProfile

Ints = NDArray[np.int64]

_FINE = 8  # lengths that a row may have, from one to twice as long
_COARSE = 64  # springs that lengths are found with
_EXTREME = 498 * _FINE  # the longest is 2^498 m, the shortest 2^-498 m


class Row(NamedTuple):
    """The springs on one side of the axis at (i + 1/2) dx, and one more just outside."""

    spacing: float
    depth: Floats
    """g [m] at each."""
    stretch: Floats
    """dl [m] at each."""
    area: Floats
    """∫ g dx [m2] over those before it."""

    @property
    def grips(self) -> Floats:
        """The indentation [m] below which each lets go, when it is the outermost."""
        return self.depth - self.stretch

    @property
    def load(self) -> Floats:
        """The force over 2 E* [m2] below which each does, under dead load."""
        before = np.arange(self.depth.size)
        return self.spacing * (before * self.depth - (before + 1) * self.stretch) - self.area


class Rows(NamedTuple):
    """All rows of one profile, each with the same number of springs."""

    profile: MdrProfile
    tenacity: float
    """w/E* [m]."""
    springs: int

    def stretch(self, x: Floats) -> Floats:
        """dl(x) [m] = sqrt(2 pi x w/E*) (H 44)."""
        return np.asarray(np.sqrt(2.0 * math.pi * x) * math.sqrt(self.tenacity), dtype=np.float64)

    def row(self, length: float) -> Row:
        """The row of a length [m]."""
        spacing = length / self.springs
        depth = self.profile.row(spacing, self.springs + 1)
        stretch = self.stretch(spacing * np.arange(0.5, self.springs + 1.0))
        return Row(spacing, depth, stretch, spacing * np.append(0.0, np.cumsum(depth[:-1])))

    def fitted(self, targets: Floats, loaded: bool) -> Iterator[tuple[Row, Ints, Ints]]:
        """A row of fitting length for each group of targets: it, which they are, and how many springs each holds.

        Targets are indentations [m] or, if ``loaded``, forces over 2 E* [m2]. As on retraction the contact ends with
        the last spring that holds. Those of which no spring can hold are in no group.
        """
        numbers, waiting = self._numbers(targets, loaded)
        while waiting.any():
            number = int(numbers[waiting].min())
            some = np.flatnonzero(waiting & (numbers == number))
            row = self.row(min(2.0 ** (number / _FINE), self.profile.limit))
            thresholds = row.load if loaded else row.grips
            beyond = thresholds[-1] <= targets[some]  # the one outside would hold too
            numbers[some[beyond]] += 1
            some = some[~beyond]
            waiting[some] = False
            yield row, some, np.searchsorted(_least_from(thresholds[:-1]), targets[some], side="right")

    def _numbers(self, targets: Floats, loaded: bool) -> tuple[Ints, NDArray[np.bool_]]:
        """The numbers of lengths 2^(number/_FINE) [m] that no contact reaches beyond, and where there can be a contact.

        Where once the stretch dl does not reach up to the profile, it does not further out either.
        """
        low = math.floor(_FINE * math.log2(self.profile.start))
        bounds = self._bounds(low, low + _FINE, loaded)
        while not bounds[-1] > max(0.0, targets.max(initial=0.0)):
            bounds = np.append(bounds, self._bounds(low + bounds.size, low + bounds.size + _FINE, loaded))
        while True:
            place = np.searchsorted(_least_from(bounds), targets, side="right")
            pull = self._pull(np.array(2.0 ** (low / _FINE)), loaded)
            if ((place > 0) | (pull <= -targets)).all():
                return low + place, place > 0
            bounds = np.append(self._bounds(low - 4 * _FINE, low, loaded), bounds)
            low -= 4 * _FINE

    def _bounds(self, low: int, high: int, loaded: bool) -> Floats:
        """Between each length and the next, no contact ends at less than this."""
        if not -_EXTREME <= low < high <= _EXTREME:
            raise OutOfRange("the contact radius is not representable, or the contact grows without end")
        x: Floats = 2.0 ** (np.arange(low, high + 1.0) / _FINE)
        g, G = self.profile.at(x[:-1], _COARSE)
        return (x[:-1] * g - G if loaded else g) - self._pull(x[1:], loaded)

    def _pull(self, x: Floats, loaded: bool) -> Floats:
        """What adhesion takes from the control at each contact radius [m]."""
        return x * self.stretch(x) if loaded else self.stretch(x)


def _least_from(values: Floats) -> Floats:
    """The least of each and all after it."""
    return np.minimum.accumulate(values[::-1])[::-1]

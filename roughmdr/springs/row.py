"""Rows of springs, and the length that a row needs."""

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from roughmdr.errors import OutOfRange
from roughmdr.numerics.arguments import Floats, Ints
from roughmdr.springs.profile import FunctionProfile, ShapeProfile

_PER_OCTAVE = 8  # lengths that a row may have, from one to twice as long
_TRIAL_SPRINGS = 64  # with which lengths are estimated
_LENGTH_NUMBER_MAX = 498 * _PER_OCTAVE  # the longest is 2^498 m, the shortest 2^-498 m


class Row(NamedTuple):
    """The springs on one side of the axis at (i + 1/2) dx, and one more just outside."""

    spacing: float
    g: Floats
    """MDR profile [m] at each."""
    release_stretch: Floats
    """dl [m] at each."""
    area: Floats
    """∫ g dx [m2] over those before it."""

    @property
    def release_indentation(self) -> Floats:
        """The indentation [m] below which each detaches, when it is the outermost."""
        return self.g - self.release_stretch

    @property
    def release_load(self) -> Floats:
        """The force over 2 E* [m2] below which each detaches under dead load, when it is the outermost."""
        before = np.arange(self.g.size)
        return self.spacing * (before * self.g - (before + 1) * self.release_stretch) - self.area


class Rows(NamedTuple):
    """All rows of one profile, each with the same number of springs."""

    profile: ShapeProfile | FunctionProfile
    adhesion_length: float
    """w/E* [m]."""
    springs: int

    def release_stretch(self, x: Floats) -> Floats:
        """dl(x) [m] = sqrt(2 pi x w/E*) (H 44)."""
        return np.asarray(np.sqrt(2.0 * math.pi * x) * math.sqrt(self.adhesion_length), dtype=np.float64)

    def row(self, length: float) -> Row:
        """Return the row of a length [m]."""
        spacing = length / self.springs
        g = self.profile.row(spacing, self.springs + 1)
        release_stretch = self.release_stretch(spacing * np.arange(0.5, self.springs + 1.0))
        return Row(spacing, g, release_stretch, spacing * np.append(0.0, np.cumsum(g[:-1])))

    def fitted(self, targets: Floats, loaded: bool) -> Iterator[tuple[Row, Ints, Ints]]:
        """Yield a row of fitting length for each group of targets: it, their indices, and the springs in contact.

        Targets are indentations [m] or, if ``loaded``, forces over 2 E* [m2]. As on retraction the contact ends with
        the last spring that can be in contact. Targets under which none can are in no group.
        """
        numbers, waiting = self._length_numbers(targets, loaded)
        while waiting.any():
            number = int(numbers[waiting].min())
            group = np.flatnonzero(waiting & (numbers == number))
            row = self.row(min(2.0 ** (number / _PER_OCTAVE), self.profile.limit))
            thresholds = row.release_load if loaded else row.release_indentation
            too_short = thresholds[-1] <= targets[group]  # the one outside would be in contact too
            numbers[group[too_short]] += 1
            group = group[~too_short]
            waiting[group] = False
            yield row, group, np.searchsorted(_min_from(thresholds[:-1]), targets[group], side="right")

    def _length_numbers(self, targets: Floats, loaded: bool) -> tuple[Ints, NDArray[np.bool_]]:
        """Return numbers of lengths 2^(number/_PER_OCTAVE) [m] that no contact exceeds, and where there can be contact.

        Where once the stretch dl does not bridge the gap to the profile, it does not further out either.
        """
        low = math.floor(_PER_OCTAVE * math.log2(self.profile.start))
        bounds = self._lower_bounds(low, low + _PER_OCTAVE, loaded)
        while not bounds[-1] > max(0.0, targets.max(initial=0.0)):
            end = low + bounds.size
            bounds = np.append(bounds, self._lower_bounds(end, end + _PER_OCTAVE, loaded))
        while True:
            index = np.searchsorted(_min_from(bounds), targets, side="right")
            adhesive = self._adhesive_part(np.array(2.0 ** (low / _PER_OCTAVE)), loaded)
            if ((index > 0) | (adhesive <= -targets)).all():
                return low + index, index > 0
            bounds = np.append(self._lower_bounds(low - 4 * _PER_OCTAVE, low, loaded), bounds)
            low -= 4 * _PER_OCTAVE

    def _lower_bounds(self, low: int, high: int, loaded: bool) -> Floats:
        """Return for each length to the next a target below which no contact ends between them."""
        if not -_LENGTH_NUMBER_MAX <= low < high <= _LENGTH_NUMBER_MAX:
            raise OutOfRange("the contact radius is not representable, or the contact grows without end")
        x: Floats = 2.0 ** (np.arange(low, high + 1.0) / _PER_OCTAVE)
        g, G = self.profile.at(x[:-1], _TRIAL_SPRINGS)
        return (x[:-1] * g - G if loaded else g) - self._adhesive_part(x[1:], loaded)

    def _adhesive_part(self, x: Floats, loaded: bool) -> Floats:
        """Return by how much adhesion lowers the control at each contact radius [m]."""
        return x * self.release_stretch(x) if loaded else self.release_stretch(x)


def _min_from(values: Floats) -> Floats:
    """Return the minimum of each value and all after it."""
    return np.minimum.accumulate(values[::-1])[::-1]

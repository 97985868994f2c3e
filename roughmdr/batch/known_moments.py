"""Moments of numbers that not every realisation has, such as its pull-off force: NaN stands for none."""

from typing import NamedTuple

import numpy as np

from roughmdr.numerics.arguments import Floats

ROWS = ("count", "mean", "spread", "minimum", "maximum")
COUNT, MEAN, SPREAD, MINIMUM, MAXIMUM = range(len(ROWS))


class KnownMoments(NamedTuple):
    """Moments of some numbers over realisations, each over those that have it."""

    size: int
    """Number of realisations, with the number or without."""
    table: Floats
    """[row of ROWS, number]; NaN but for the count where no realisation has it."""

    @classmethod
    def of(cls, values: Floats) -> "KnownMoments":
        """Return the moments of one realisation: [number]."""
        spread = np.where(np.isnan(values), np.nan, 0.0)
        return cls(1, np.array([np.where(np.isnan(values), 0.0, 1.0), values, spread, values, values]))

    def merged(self, other: "KnownMoments") -> "KnownMoments":
        """Return the moments of both, as ``Moments.merged`` does where every realisation counts."""
        one, two = self.table, other.table
        count = one[COUNT] + two[COUNT]
        present = np.maximum(count, 1.0)
        weight, other_weight = one[COUNT] / present, two[COUNT] / present
        half = 0.5 * two[MEAN] - 0.5 * one[MEAN]
        within = np.hypot(np.sqrt(weight) * one[SPREAD], np.sqrt(other_weight) * two[SPREAD])
        merged = np.array(
            [
                count,
                one[MEAN] + (2.0 * other_weight) * half,
                np.hypot(within, (2.0 * np.sqrt(weight * other_weight)) * half),
                np.fmin(one[MINIMUM], two[MINIMUM]),
                np.fmax(one[MAXIMUM], two[MAXIMUM]),
            ]
        )
        merged = np.where(one[COUNT] == 0.0, two, np.where(two[COUNT] == 0.0, one, merged))
        return KnownMoments(self.size + other.size, merged)

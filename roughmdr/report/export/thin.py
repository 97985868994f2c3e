"""A curve thinned to the fewest of its points between which lines stay within a tolerance."""

import numpy as np
from numpy.typing import NDArray

from roughmdr.numerics.arguments import Floats

RELATIVE_FROM = 0.1
"""Of the largest value: from here on a tolerance is relative to the value itself, below to this part of the largest."""


def tolerances(y: Floats, error: float) -> Floats:
    """Return how far a table may be off at each point of a curve y.

    It is ``error`` of the value itself in the upper decade, and ``error`` of a tenth of the largest value below it.
    """
    size = np.abs(y)
    return np.asarray(error * np.maximum(size, RELATIVE_FROM * size.max()))


def knots(x: Floats, y: Floats, tolerance: Floats) -> NDArray[np.int64]:
    """Return the indices of the fewest points, first and last among them, whose lines stay within ``tolerance``.

    x rises. From each point the slopes that pass all later points within their tolerance narrow down to none; of the
    lines that these allow the shortest chain is taken.
    """
    n = x.size
    x, y, tolerance = x / np.abs(x).max(), *(part / np.abs(y).max() for part in (y, tolerance))
    count, before = np.full(n, n, dtype=np.int64), np.zeros(n, dtype=np.int64)
    count[0] = 0
    for i in range(n - 1):
        run, rise = x[i + 1 :] - x[i], y[i + 1 :] - y[i]
        least = np.maximum.accumulate((rise - tolerance[i + 1 :]) / run)
        most = np.minimum.accumulate((rise + tolerance[i + 1 :]) / run)
        slope = rise / run
        allowed = np.append(True, (least[:-1] <= slope[1:]) & (slope[1:] <= most[:-1]))
        better = np.flatnonzero(allowed & (count[i] + 1 < count[i + 1 :])) + i + 1
        count[better], before[better] = count[i] + 1, i
    kept = [n - 1]
    while kept[-1] > 0:
        kept.append(int(before[kept[-1]]))
    return np.array(kept[::-1])

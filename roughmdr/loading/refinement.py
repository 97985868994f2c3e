"""Where to look for the lowest force of a rise of the flat, between separations at which it is known.

In an interval without detachments the force lies above the chords of its neighbours, carried on, since it is convex
there. In one with detachments, or between two of them, it is taken to fall no further below its ends than twice what
it changes from one end to the other, here or next to here.
"""

import math

import numpy as np
from numpy.typing import NDArray

from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.jit import njit

_TOLERANCE = 1e-7  # of the lowest force
_NEGLIGIBLE = 1e-12  # of the largest force: it may be compression, and cancels where the lowest is
_SAFETY = 2.0  # on how much the force changes beside an interval with detachments
_INTERVALS, _POINTS = 12, 24  # refined at a time, and points in all of them
_MIN_POINTS, _MAX_POINTS = 2, 6  # in an interval
BESIDE = 4.0  # roundings from a detachment to either side
_NARROW = 4.0  # of that: an interval across a detachment


@njit
def _bound(h: Floats, force: Floats, smooth: Floats, k: int) -> float:
    """Return how low the force may be in the interval k."""
    low, high = force[k], force[k + 1]
    least = min(low, high)
    before, after = k > 0, k + 2 < h.size
    from_left, from_right = before and smooth[k - 1] > 0.0, after and smooth[k + 1] > 0.0
    if smooth[k] > 0.0 and (from_left or from_right):
        width = h[k + 1] - h[k]
        left = (low - force[k - 1]) / (h[k] - h[k - 1]) if from_left else 0.0
        right = (force[k + 2] - high) / (h[k + 2] - h[k + 1]) if from_right else 0.0
        if not from_right:
            return float(min(least, low + left * width))
        if not from_left:
            return float(min(least, high - right * width))
        if left < 0.0 < right:
            return float(min(least, low + left * (high - right * width - low) / (left - right)))
        return float(least)
    change = abs(high - low)
    if before:
        change = max(change, abs(low - force[k - 1]))
    if after:
        change = max(change, abs(force[k + 2] - high))
    return float(least - _SAFETY * change)


@njit
def _lowest_intervals(bounds: Floats, limit: float) -> NDArray[np.int64]:
    """Return the intervals, at most ``_INTERVALS`` and ascending, whose bounds are the lowest, and below a limit."""
    chosen, size = np.empty(_INTERVALS, dtype=np.int64), 0
    for k in range(bounds.size):
        if bounds[k] >= limit:
            continue
        if size == _INTERVALS:
            worst = 0
            for i in range(1, size):
                worst = i if bounds[chosen[i]] >= bounds[chosen[worst]] else worst
            if bounds[chosen[worst]] <= bounds[k]:
                continue
            for i in range(worst, size - 1):
                chosen[i] = chosen[i + 1]
            size -= 1
        chosen[size] = k
        size += 1
    return chosen[:size]


def next_separations(h: Floats, force: Floats, detachments: Floats, lowest: float, beside: float) -> Floats:
    """Return more separations [m], ascending, where the force may be below ``lowest`` [N]; none where it cannot be.

    h [m] ascends with the force there [N], and so do the ``detachments``, which are met ``beside`` [m] them.
    """
    return _next(h, force, np.searchsorted(detachments, h), detachments, lowest, beside)


@njit
def _next(
    h: Floats, force: Floats, count: NDArray[np.int64], detachments: Floats, lowest: float, beside: float
) -> Floats:
    """Do so; ``count`` says how many detachments lie below each separation."""
    smooth, bounds, largest = np.empty(h.size - 1), np.empty(h.size - 1), 0.0
    for k in range(h.size - 1):  # a slope across a few roundings is none
        smooth[k] = 1.0 if count[k] == count[k + 1] and h[k + 1] - h[k] > _NARROW * beside else 0.0
    for k in range(h.size):
        largest = max(largest, abs(force[k]))
    limit = lowest - max(_TOLERANCE * abs(lowest), _NEGLIGIBLE * largest)
    for k in range(h.size - 1):
        wide = h[k + 1] - h[k] > _NARROW * beside
        bounds[k] = _bound(h, force, smooth, k) if wide else math.inf
    chosen = _lowest_intervals(bounds, limit)
    points = min(max(_POINTS // max(chosen.size, 1), _MIN_POINTS), _MAX_POINTS)
    found, filled = np.empty(2 * points * chosen.size), 0
    for number in range(chosen.size):
        k = chosen[number]
        last, inside = h[k], count[k + 1] - count[k]
        used = min(inside, points) if inside > 0 else points
        for j in range(used):
            if inside > 0:
                at = detachments[count[k] + ((2 * j + 1) * inside) // (2 * used)]
                sides = (at - beside, at + beside)
            else:  # denser towards the end, where a contact may be about to detach
                part = (used - j) / (used + 1.0)
                at = h[k + 1] - (h[k + 1] - h[k]) * part * part
                sides = (at, at)
            for side in sides:
                if last < side < h[k + 1]:
                    found[filled] = last = side
                    filled += 1
    return found[:filled]


def merged(h: Floats, force: Floats, more: Floats, more_force: Floats) -> tuple[Floats, Floats]:
    """Return two tables of the force [N] over ascending separations [m] as one."""
    both = np.concatenate([h, more])
    order = np.argsort(both, kind="stable")
    return both[order], np.concatenate([force, more_force])[order]

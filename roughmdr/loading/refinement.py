"""The separations at which the lowest force of a rise is sought next, between those at which it is known.

In an interval without detachments the force is convex, and so lies above the extended chords of the neighbours. In one
with detachments, or between two of them, it is taken to fall below its ends by no more than twice its change over this
interval or a neighbour.
"""

import math

import numpy as np
from numpy.typing import NDArray

from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.jit import njit

_TOLERANCE = 1e-7  # error of the lowest force, over it
_NEGLIGIBLE = 1e-12  # error of the lowest force, over the largest, which may be compression and cancels there
_SAFETY = 2.0  # safety factor on the change of the force beside an interval with detachments
_INTERVALS, _POINTS = 12, 24  # intervals refined at a time, and points in all of them
_MIN_POINTS, _MAX_POINTS = 2, 6  # points in an interval
BESIDE = 4.0  # distance from a detachment to either side [rounding]
_NARROW = 4.0  # width of an interval across a detachment, over that distance


@njit
def _fill_bounds(h: Floats, force: Floats, smooth: NDArray[np.bool_], bounds: Floats) -> None:
    """Fill in a lower bound of the force in each interval."""
    for k in range(bounds.size):
        low, high, width = force[k], force[k + 1], h[k + 1] - h[k]
        least, change = min(low, high), abs(high - low)
        before, after = k > 0, k + 1 < bounds.size
        from_left, from_right = before and smooth[k - 1], after and smooth[k + 1]
        if smooth[k] and (from_left or from_right):
            left = (low - force[k - 1]) / (h[k] - h[k - 1]) if from_left else 0.0
            right = (force[k + 2] - high) / (h[k + 2] - h[k + 1]) if from_right else 0.0
            if not from_right:
                least = min(least, low + left * width)
            elif not from_left:
                least = min(least, high - right * width)
            elif left < 0.0 < right:
                least = min(least, low + left * (high - right * width - low) / (left - right))
            bounds[k] = least
        else:
            if before:
                change = max(change, abs(low - force[k - 1]))
            if after:
                change = max(change, abs(force[k + 2] - high))
            bounds[k] = least - _SAFETY * change


def _lowest_intervals(bounds: Floats, limit: float) -> NDArray[np.int64]:
    """Return the intervals, at most ``_INTERVALS`` and ascending, whose bounds are the lowest, and below a limit."""
    below = np.flatnonzero(bounds < limit)
    if below.size > _INTERVALS:
        below = np.sort(below[np.argsort(bounds[below], kind="stable")[:_INTERVALS]])
    return below


def next_separations(h: Floats, force: Floats, detachments: Floats, lowest: float, beside: float) -> Floats:
    """Return more separations [m], ascending, where the force may be below ``lowest`` [N]; none where it cannot be.

    h [m] ascends with the force there [N], and so do the ``detachments``, which are met ``beside`` [m] them.
    """
    count = np.searchsorted(detachments, h)
    wide = h[1:] - h[:-1] > _NARROW * beside  # across a few roundings there is no meaningful slope
    bounds = np.empty(wide.size)
    _fill_bounds(h, force, wide & (count[1:] == count[:-1]), bounds)
    bounds[~wide] = math.inf
    limit = lowest - max(_TOLERANCE * abs(lowest), _NEGLIGIBLE * float(np.abs(force).max()))
    intervals, found = _lowest_intervals(bounds, limit), np.empty(2 * _INTERVALS * _MAX_POINTS)
    return found[: _fill_points(h, count, detachments, beside, intervals, found)]


@njit
def _fill_points(
    h: Floats,
    count: NDArray[np.int64],
    detachments: Floats,
    beside: float,
    intervals: NDArray[np.int64],
    found: Floats,
) -> int:
    """Fill in the points within the intervals, of ``count`` detachments below each separation; return how many."""
    points = min(max(_POINTS // max(intervals.size, 1), _MIN_POINTS), _MAX_POINTS)
    filled = 0
    for number in range(intervals.size):
        k = intervals[number]
        last, inside = h[k], count[k + 1] - count[k]
        used = min(inside, points) if inside > 0 else points
        for j in range(2 * used):
            if inside > 0:  # before and after a detachment
                at = detachments[count[k] + ((j - j % 2 + 1) * inside) // (2 * used)]
                side = at - beside if j % 2 == 0 else at + beside
            else:  # denser towards the end, where a contact may be about to detach
                part = (used - j // 2) / (used + 1.0)
                side = h[k + 1] - (h[k + 1] - h[k]) * part * part
            if last < side < h[k + 1]:
                found[filled] = last = side
                filled += 1
    return filled


def merged(h: Floats, force: Floats, more: Floats, more_force: Floats) -> tuple[Floats, Floats]:
    """Return two tables of the force [N] over ascending separations [m] as one."""
    both = np.concatenate([h, more])
    order = np.argsort(both, kind="stable")
    return both[order], np.concatenate([force, more_force])[order]

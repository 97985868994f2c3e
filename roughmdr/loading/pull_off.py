"""The pull-off: the largest tension of the unloadings of a path, located between its steps.

While the flat rises, the force of an ensemble is smooth and mostly convex between the detachments of its contacts, and
jumps towards zero at each. Intervals between known separations are refined where a lower force is possible, and known
detachments are met from both sides. In an interval without detachments the force is taken to be convex, and so lies
above the extended chords of the neighbours. In one with detachments, or between two of them, it is taken to fall below
its ends by no more than twice its change over this interval or a neighbour.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from roughmdr.loading.path import LoadingPath
from roughmdr.loading.staircase import risen
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.jit import njit

_MAX_ROUNDS = 24
_COARSE = 16  # least number of intervals of a rise: fewer may miss its largest tension
_NONE = np.zeros(0)
_TOLERANCE = 1e-7  # error of the lowest force, over it
_NEGLIGIBLE = 1e-12  # error of the lowest force, over the largest, which may be compression and cancels there
_SAFETY = 2.0  # safety factor on the change of the force beside an interval with detachments
_INTERVALS, _POINTS = 12, 24  # intervals refined at a time, and points in all of them
_MIN_POINTS, _MAX_POINTS = 2, 6  # points in an interval
_BESIDE = 4.0  # distance from a detachment to either side [rounding]
_NARROW = 4.0  # width of an interval across a detachment, over that distance

ForceAlong = Callable[[LoadingPath], Floats]
"""Returns the force [N] at each step of a path."""


class PullOff(NamedTuple):
    """The largest tension of the unloadings of a path; NaN where they end in contact."""

    force: float = math.nan
    """Force [N], negative; 0 where contacts part without tension."""
    separation: float = math.nan
    """Separation there [m]; NaN without tension, as the next two."""
    contacts: float = math.nan
    """Number of contacts that carry it."""
    contact_area: float = math.nan
    """Their area [m2]."""


WITHOUT_TENSION = PullOff(0.0)


class LargestTension(NamedTuple):
    """The largest tension, and a path to it."""

    force: float
    """[N], negative."""
    path: LoadingPath
    """A path that ends there."""


class Unloading(NamedTuple):
    """A rise of the flat, with the force at its separations."""

    turns: Floats
    """Turning points of the path up to the rise, its lowest included [m]."""
    separation: Floats
    force: Floats
    last: int
    """The step at which it ends."""

    def path(self, separation: Floats) -> LoadingPath:
        """Return the path by the turning points to ascending separations [m] of the rise."""
        return LoadingPath(np.concatenate([self.turns, separation]), risen(self.turns, separation))


def unloadings(separation: Floats, force: Floats) -> list[Unloading]:
    """Return the rises of a path with its force [N] at each step."""
    rises = np.concatenate([[False], np.diff(separation) > 0.0, [False]]).astype(int)
    first, last = (np.flatnonzero(np.diff(rises) == sign) for sign in (1, -1))
    return [
        Unloading(turning_points(separation[: begin + 1]), separation[begin : end + 1], force[begin : end + 1], end)
        for begin, end in zip(first.tolist(), last.tolist(), strict=True)
    ]


def turning_points(separation: Floats) -> Floats:
    """Return the lowest and highest points of a path in turn, all that contacts remember of it.

    It comes from infinity and ends in one of them.
    """
    distinct = separation[np.append(True, np.diff(separation) != 0.0)]
    down = np.append(True, np.diff(distinct) < 0.0)
    return np.asarray(distinct[np.append(down[1:] != down[:-1], True)])


def prepare() -> None:
    """Compile the functions that locate a pull-off."""
    next_separations(np.arange(3.0), np.zeros(3), np.zeros(1), 0.0, 0.0)


def locate(rises: list[Unloading], force_along: ForceAlong, detachments: Floats = _NONE) -> LargestTension | None:
    """Return the largest tension of unloadings; None where there is none.

    ``detachments`` [m] ascend: the separations at which contacts are lost.
    """
    largest = None
    for rise in sorted(rises, key=lambda each: float(each.force.min())):
        limit = 0.0 if largest is None else largest.force
        largest = _locate(rise, force_along, detachments, limit) or largest
    return largest


def _locate(rise: Unloading, force_along: ForceAlong, detachments: Floats, limit: float) -> LargestTension | None:
    """Return the largest tension of one unloading; None unless its force is below ``limit`` [N]."""
    h, force = rise.separation, rise.force
    farthest = max(float(np.abs(h).max()), float(np.abs(detachments[[0, -1]]).max()) if detachments.size else 0.0)
    beside = _BESIDE * float(np.spacing(farthest))
    for number in range(_MAX_ROUNDS):
        if number == 0 and h.size <= _COARSE:
            parts = -(-_COARSE // (h.size - 1))
            added = (h[:-1, None] + np.diff(h)[:, None] * (np.arange(1, parts) / parts)).ravel()
        else:
            added = next_separations(h, force, detachments, min(limit, float(force.min())), beside)
        if not added.size:
            break
        h, force = merged(h, force, added, force_along(rise.path(added))[rise.turns.size :])
    at = int(np.argmin(force))
    return LargestTension(float(force[at]), rise.path(h[at : at + 1])) if force[at] < limit else None


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

"""The pull-off: the largest tension of the unloadings of a path, located between its steps.

While the flat rises, the force of an ensemble is smooth and mostly convex between the detachments of its contacts, and
jumps towards zero at each. Intervals between known separations are refined where a lower force is possible
(``refinement.py``), and known detachments are met from both sides.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from roughmdr.loading.path import LoadingPath
from roughmdr.loading.refinement import BESIDE, merged, next_separations
from roughmdr.loading.staircase import risen
from roughmdr.numerics.arguments import Floats

_MAX_ROUNDS = 24
_COARSE = 16  # least number of intervals of a rise: fewer may miss its largest tension
_NONE = np.zeros(0)

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
    beside = BESIDE * float(np.spacing(farthest))
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

"""The pull-off: the largest tension of the unloadings of a path, located between its steps.

While the flat rises, the force of an ensemble is smooth and mostly convex between the detachments of its contacts, and
jumps towards zero at each. Intervals between known separations are refined where a lower force is possible: in a smooth
one the force lies above the chords of its neighbours, carried on; in one with detachments it is taken to fall no
further below its ends than it varies there. Detachments are met from both sides.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from roughmdr.loading.path import LoadingPath
from roughmdr.numerics.arguments import Floats

_TOLERANCE = 1e-8  # of the largest tension
_MAX_ROUNDS = 24
_MAX_INTERVALS, _POINTS = 16, 24  # refined in a round, and points in all of them
_MIN_POINTS, _MAX_POINTS = 2, 6  # in an interval
_BESIDE = 4.0  # roundings from a detachment to either side
_EMPTY = np.zeros(0)

Evaluate = Callable[[LoadingPath], tuple[Floats, Floats]]
"""Returns the force [N] and the number of contacts at each step of a path."""


class PullOff(NamedTuple):
    """The largest tension of the unloadings of a path; NaN where they end in contact."""

    force: float = math.nan
    """[N], negative; 0 where contacts part without tension."""
    separation: float = math.nan
    """Where it is [m]; NaN without tension, as the next."""
    contacts: float = math.nan
    """How many contacts carry it."""


WITHOUT_TENSION = PullOff(0.0)


class Unloading:
    """The force along one rise of the flat, as far as it is known."""

    def __init__(self, turns: Floats, separation: Floats, force: Floats) -> None:
        self.turns = turns
        """Turning points of the path up to the rise, its lowest included [m]."""
        self.separation, self.force = separation, force
        self.contacts = np.full_like(force, math.nan)

    def refine(self, evaluate: Evaluate, added: Floats) -> None:
        """Evaluate the force at more separations [m]."""
        path = LoadingPath.along(np.concatenate([self.turns, added]), unload=False, adhesive=True)
        force, contacts = (values[self.turns.size :] for values in evaluate(path))
        separation = np.concatenate([self.separation, added])
        order = np.argsort(separation, kind="stable")
        self.separation = separation[order]
        self.force = np.concatenate([self.force, force])[order]
        self.contacts = np.concatenate([self.contacts, contacts])[order]

    @property
    def lowest(self) -> int:
        """Index of the lowest force."""
        return int(np.argmin(self.force))


def unloadings(separation: Floats, force: Floats) -> list[Unloading]:
    """Return the rises of a path with its force [N] at each step."""
    direction = np.sign(np.diff(separation))
    found, first = [], 0
    while first < direction.size:
        if direction[first] <= 0.0:
            first += 1
            continue
        last = first
        while last < direction.size and direction[last] > 0.0:
            last += 1
        before = separation[: first + 1]
        moves = np.sign(np.diff(before[np.append(True, np.diff(before) != 0.0)]))
        distinct = before[np.append(True, np.diff(before) != 0.0)]
        turning = np.append(moves[1:] != moves[:-1], True) if moves.size else np.zeros(0, dtype=bool)
        turns = distinct[1:][turning] if moves.size else distinct
        found.append(Unloading(turns, separation[first : last + 1], force[first : last + 1]))
        first = last
    return found


def locate(rises: list[Unloading], evaluate: Evaluate, detachments: Floats = _EMPTY) -> PullOff:
    """Return the largest tension of unloadings, refined until no interval promises more.

    ``detachments`` [m] ascend: the separations at which contacts are lost.
    """
    farthest = max(float(np.abs(rise.separation).max()) for rise in rises)
    beside = _BESIDE * float(np.spacing(max(farthest, float(np.abs(detachments).max(initial=0.0)))))
    for _ in range(_MAX_ROUNDS):
        lowest = min(float(rise.force.min()) for rise in rises)
        bounds = [_bounds(rise, detachments, 4.0 * beside) for rise in rises]
        limit = lowest - _TOLERANCE * max(abs(lowest), max(float(np.abs(rise.force).max()) for rise in rises) * 1e-6)
        promising = sorted(
            (float(bound[k]), number, int(k))
            for number, bound in enumerate(bounds)
            for k in np.flatnonzero(bound < limit)
        )[:_MAX_INTERVALS]
        if not promising:
            break
        points = min(max(_POINTS // len(promising), _MIN_POINTS), _MAX_POINTS)
        for number, rise in enumerate(rises):
            chosen = sorted(k for _, own, k in promising if own == number)
            if chosen:
                added = [_points_between(rise.separation, k, detachments, points, beside) for k in chosen]
                rise.refine(evaluate, np.concatenate(added))
    deepest = min(rises, key=lambda rise: float(rise.force.min()))
    at = deepest.lowest
    if not deepest.force[at] < 0.0:
        return WITHOUT_TENSION
    if math.isnan(deepest.contacts[at]):
        path = LoadingPath.along(np.append(deepest.turns, deepest.separation[at]), unload=False, adhesive=True)
        deepest.contacts[at] = evaluate(path)[1][-1]
    return PullOff(float(deepest.force[at]), float(deepest.separation[at]), float(deepest.contacts[at]))


def _bounds(rise: Unloading, detachments: Floats, narrow: float) -> Floats:
    """Return how low the force may be between known separations: [interval]; inf in ``narrow`` ones."""
    h, force = rise.separation, rise.force
    width, change = np.diff(h), np.diff(force)
    ends = np.minimum(force[:-1], force[1:])
    smooth = np.diff(np.searchsorted(detachments, h)) == 0
    size = np.abs(change)
    padded = np.concatenate([[0.0], size, [0.0]])
    bounds = ends - np.maximum(size, np.maximum(padded[:-2], padded[2:]))
    slope = change / width
    left, right = np.full_like(slope, -math.inf), np.full_like(slope, math.inf)
    left[1:][smooth[:-1]] = slope[:-1][smooth[:-1]]
    right[:-1][smooth[1:]] = slope[1:][smooth[1:]]
    known = smooth & (np.isfinite(left) | np.isfinite(right))
    from_left = force[:-1] + np.where(np.isfinite(left), left * width, -math.inf)  # at the right end
    from_right = force[1:] - np.where(np.isfinite(right), right * width, math.inf)  # at the left end
    both = known & np.isfinite(left) & np.isfinite(right)
    with np.errstate(invalid="ignore", divide="ignore"):
        crossing = np.where(both & (left < 0.0) & (right > 0.0), (from_right - force[:-1]) / (left - right), 0.0)
        meeting = force[:-1] + np.where(both, left, 0.0) * crossing
    chords = np.where(both, np.minimum(ends, meeting), np.minimum(ends, np.where(np.isfinite(left), from_left, from_right)))
    return np.where(width <= narrow, math.inf, np.where(known, chords, bounds))


def _points_between(h: Floats, k: int, detachments: Floats, points: int, beside: float) -> Floats:
    """Return separations inside the interval k: beside detachments, if it has any, else spread towards its end."""
    low, high = h[k], h[k + 1]
    inside = detachments[(detachments > low) & (detachments <= high)]
    if inside.size > points:
        inside = inside[np.linspace(0, inside.size - 1, points + 2).astype(int)[1:-1]]
    if inside.size:
        found = np.concatenate([inside - beside, inside + beside])
    else:
        part = np.arange(1, points + 1) / (points + 1)
        found = high - (high - low) * part * part
    found = np.unique(found)
    return found[(found > low) & (found < high)]

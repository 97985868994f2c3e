"""Least squares of a law whose contact jumps, interval by interval.

As a jump of the law passes a measured step, the sum of squares jumps as well. An interval is the set of parameters that
have each contact made, and lost, between the same two steps, for each population of one height. Within it the sum is
smooth, and its minimum is found by Gauss and Newton's method with the edges of the interval as constraints; then
neighbouring intervals are tried.
"""

from collections.abc import Iterator

import numpy as np

from roughmdr.fitting.model import Model, Point
from roughmdr.fitting.slopes import slopes_of, slopes_of_jumps
from roughmdr.numerics.arguments import Floats

Interval = tuple[int, ...]
"""The steps after which the contact is made or lost."""

_FLAT = 1e-6  # least slope over the largest: smaller ones give no standard error
_INSIDE = 1e-6  # margin at the edges of an interval, over the step
_NEWTON, _ITERATIONS, _HALVINGS = 4, 20, 8
_LONGEST = 1.0  # longest change of x in an iteration
_LESS = 1e-11  # relative decrease of the sum of squares below which iterations end
_LEAST_GAIN = 1e-7  # relative decrease of the sum of squares by which another interval is better
_FARTHEST = 2  # steps to the neighbours of an interval
_UNCERTAIN = 4.0  # error of a load that is taken for that of the next step, over its change from step to step


def with_measured_jumps(model: Model, x: Floats) -> Floats:
    """Return the x nearest to one whose law jumps where the measured load changes most, or x where there is none."""
    point = model.point(x)
    return (nearest_in(model, point, _measured(model, point.jumps), slopes_of_jumps(model, x)) or point).x


def least_squares_between(model: Model, x: Floats) -> Floats:
    """Return the parameters of least squares from some x, in the best interval.

    The first two intervals are those of x and of the measured jumps; then neighbours of the best, until none is better.
    """
    starts = (x, with_measured_jumps(model, x))
    best = min((_least(model, model.point(each)) for each in starts), key=lambda each: each.cost)
    tried = {best.jumps, model.point(x).jumps}
    while True:
        better, slopes = best, slopes_of(model, best.x)
        by_each = slopes_of_jumps(model, best.x)
        new = [each for each in _neighbours(best.jumps) if each not in tried]
        tried.update(new)
        for interval in new:
            if foreseen(model, best, slopes, interval) < better.cost:
                point = nearest_in(model, best, interval, by_each)
                if point is not None and least_cost(slopes, point.deviations) < better.cost:
                    better = min(better, _least(model, point), key=lambda each: each.cost)
        if better.cost > (1.0 - _LEAST_GAIN) * best.cost:
            return best.x
        best = better


def least_cost(slopes: Floats, deviations: Floats) -> float:
    """Return the least sum of squares of deviations that are linear in x, with slopes [step, parameter]."""
    left = np.linalg.svd(slopes, full_matrices=False)[0]
    return float(np.sum(np.square(deviations)) - np.sum(np.square(left.T @ deviations)))


def foreseen(model: Model, point: Point, slopes: Floats, interval: Interval) -> float:
    """Return about the least sum of squares in a neighbouring interval, too small rather than too large.

    Steps that a jump passes take the law of the step before it, or behind it, as far as that is certain.
    """
    load, weight = point.law.force, model.curve.weight
    deviations, slopes = point.deviations.copy(), slopes.copy()
    for begin, end in zip(point.jumps, interval, strict=True):
        later = end > begin
        passed = np.arange(begin + 1, end + 1) if later else np.arange(end + 1, begin + 1)
        beside, before = (begin, begin - 1) if later else (begin + 1, begin + 2)
        if not passed.size or not 0 <= before < load.size or not 0 <= passed[0] <= passed[-1] < load.size:
            continue
        change = _UNCERTAIN * passed.size * abs(load[beside] - load[before])
        off = deviations[passed] + (load[beside] - load[passed]) / weight[passed]
        deviations[passed] = np.sign(off) * np.maximum(np.abs(off) - change / weight[passed], 0.0)
        slopes[passed] = slopes[beside] * (weight[beside] / weight[passed])[:, None]
    return least_cost(slopes, deviations)


def _measured(model: Model, jumps: Interval) -> Interval:
    """Return the steps at which the measured load changes most, in the directions of the jumps of the law."""
    turns = np.sign(np.diff(model.curve.values))
    way = np.cumsum(np.diff(turns, prepend=turns[0]) != 0.0)
    change = np.abs(np.diff(model.curve.load))
    found = list[int]()
    for each, count in zip(*np.unique(way[list(jumps)], return_counts=True), strict=True):
        found += np.sort(np.argsort(np.where(way == each, change, -1.0))[-count:]).tolist()
    return tuple(found)


def _neighbours(interval: Interval) -> Iterator[Interval]:
    """Yield the intervals with one jump some steps on, or with two jumps one step on."""
    each = np.eye(len(interval), dtype=int)
    pairs = [a * one + b * two for i, one in enumerate(each) for two in each[:i] for a in (-1, 1) for b in (-1, 1)]
    singles = [steps * one for one in each for steps in range(-_FARTHEST, _FARTHEST + 1) if steps]
    for change in [*singles, *pairs]:
        yield tuple((np.array(interval) + change).tolist())


def nearest_in(model: Model, point: Point, interval: Interval, by_each: Floats | None) -> Point | None:
    """Return the point of an interval that is nearest by Newton's method, with the slopes of jumps that the first point
    has; None where it finds none.
    """
    (low, high), widths = model.bounds, np.diff(model.curve.values)
    if not all(0 <= step < widths.size and widths[step] for step in interval):
        return None
    for _ in range(_NEWTON):
        if by_each is None or point.law.changes.control.size != len(interval):
            return None
        places, slopes = places_of(model, interval, point, by_each)
        sides, ends = np.concatenate([slopes, -slopes]), np.concatenate([1.0 - places, places]) - 2.0 * _INSIDE
        step = projected(np.zeros(point.x.size), sides, ends)
        if not (sides @ step < ends + _INSIDE).all():
            return None
        point = model.point(np.clip(point.x + step, low, high))
        if point.jumps == interval:
            return point
    return None


def places_of(model: Model, interval: Interval, point: Point, by_each: Floats) -> tuple[Floats, Floats]:
    """Return the positions of jumps, from 0 to 1 in an interval, and their derivatives [jump, parameter]."""
    begin, width = model.curve.values[list(interval)], np.diff(model.curve.values)[list(interval)]
    return (point.law.changes.control - begin) / width, by_each / width[:, None]


def _least(model: Model, point: Point) -> Point:
    """Return the least squares in the interval of a point."""
    for _ in range(_ITERATIONS):
        before, trial = point.cost, _improved(model, point)
        if trial is None:
            return point
        point = trial
        if point.cost > (1.0 - _LESS) * before:
            break
    return point


def _improved(model: Model, point: Point) -> Point | None:
    """Return a better point of the same interval, by linearisation; None where there is none."""
    left, sizes, right = np.linalg.svd(slopes_of(model, point.x), full_matrices=False)
    if not sizes[0] > 0.0:  # no contact along the path
        return None
    axes, goal = right.T / np.maximum(sizes, _FLAT * sizes[0]), -left.T @ point.deviations
    low, high = model.bounds
    sides, ends = [np.eye(point.x.size), -np.eye(point.x.size)], [high - point.x, point.x - low]
    if (by_each := slopes_of_jumps(model, point.x)) is not None:
        places, slopes = places_of(model, point.jumps, point, by_each)
        sides, ends = [*sides, slopes, -slopes], [*ends, 1.0 - _INSIDE - places, places - _INSIDE]
    u = projected(goal, np.concatenate(sides) @ axes, np.maximum(np.concatenate(ends), 0.0))
    if point.cost * _LESS > goal @ goal - (goal - u) @ (goal - u):
        return None
    ahead = axes @ u
    ahead /= max(np.abs(ahead).max() / _LONGEST, 1.0)
    for _ in range(_HALVINGS):
        trial = model.point(np.clip(point.x + ahead, low, high))
        if trial.jumps != point.jumps:
            trial = nearest_in(model, trial, point.jumps, slopes_of_jumps(model, trial.x)) or point
        if trial.jumps == point.jumps and trial.cost < point.cost:
            return trial
        ahead = 0.5 * ahead
    return None


def projected(goal: Floats, sides: Floats, ends: Floats) -> Floats:
    """Return the point nearest to ``goal`` with side . u <= end for each edge.

    C. L. Lawson, R. J. Hanson, Solving Least Squares Problems (1974), chapter 23: least distance programming.
    """
    from scipy.optimize import nnls

    lengths = np.linalg.norm(sides, axis=1)
    sides, ends = sides[lengths > 0.0] / lengths[lengths > 0.0, None], ends[lengths > 0.0] / lengths[lengths > 0.0]
    excess = sides @ goal - ends
    if np.max(excess, initial=0.0) <= 0.0:
        return goal
    size = float(np.abs(excess).max())
    last = np.zeros(goal.size + 1)
    last[-1] = 1.0
    multipliers, _ = nnls(np.vstack([-sides.T, excess / size]), last)
    rest = np.append(-sides.T @ multipliers, float(excess @ multipliers) / size - 1.0)
    return np.asarray(goal - size * rest[:-1] / (rest[-1] or -np.inf))

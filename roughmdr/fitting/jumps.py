"""Least squares of a law whose contact jumps, interval by interval.

As a jump of the law passes a measured step, the sum of squares jumps as well. Between, it is smooth, and has a minimum
for each interval: the pair of steps between which contact is made, and that between which it is lost. It is found by
Gauss and Newton's method with the edges of the interval as constraints, and neighbouring intervals are tried from it.
"""

from collections.abc import Iterator

import numpy as np

from roughmdr.fitting.model import Model, Point
from roughmdr.numerics.arguments import Floats

Interval = tuple[int, ...]
"""The steps after which the contact is made or lost."""

_FLAT = 1e-6  # of the largest slope: smaller ones tell no standard error
_INSIDE = 1e-5  # of a step, from the edges of an interval to where it ends here
_CHANGE = 1e-5  # of x, in differences of the places of jumps
_NEWTON, _ITERATIONS, _HALVINGS = 8, 20, 8
_LONGEST = 1.0  # of x, in an iteration
_LESS = 1e-8  # of the sum of squares: a smaller decrease ends the iterations
_LEAST_GAIN = 1e-7  # of the sum of squares, by which another interval is better
_FARTHEST = 2  # steps to the neighbours of an interval


def least_squares_between(model: Model, starts: list[Floats]) -> Floats:
    """Return the parameters of least squares, from the best interval of some starts to the best of its neighbours.

    The first of the intervals is that in which the largest changes of the measured load lie.
    """
    points = [model.point(x) for x in starts]
    found = [_least(model, point) for point in points]
    found += [_least(model, point) for each in points for point in _moved(model, each, _measured(model, each.jumps))]
    best = min(found, key=_cost)
    tried = {each.jumps for each in found}
    while True:
        left = np.linalg.svd(model.slopes(best.x), full_matrices=False)[0]
        better = None
        for interval in _neighbours(best.jumps):
            for point in _moved(model, best, interval) if interval not in tried else ():
                within_reach = _cost(point) - float(np.sum(np.square(left.T @ point.deviations)))
                if within_reach < _cost(best):
                    point = _least(model, point)
                    better = min(better or point, point, key=_cost)
            tried.add(interval)
        if better is None or _cost(better) > (1.0 - _LEAST_GAIN) * _cost(best):
            return best.x
        best = better


def _cost(point: Point) -> float:
    return float(np.sum(np.square(point.deviations)))


def _measured(model: Model, jumps: Interval) -> Interval:
    """Return the steps at which the measured load changes most, where the law jumps on the same ways."""
    turns = np.sign(np.diff(model.curve.values))
    way = np.cumsum(np.diff(turns, prepend=turns[0]) != 0.0)
    change = np.abs(np.diff(model.curve.load))
    return tuple(int(np.argmax(np.where(way == way[jump], change, -1.0))) for jump in jumps)


def _neighbours(interval: Interval) -> Iterator[Interval]:
    """Yield the intervals with one jump some steps on, or with two jumps one step on."""
    each = np.eye(len(interval), dtype=int)
    pairs = [a * first + b * second for i, first in enumerate(each) for second in each[:i] for a in (-1, 1) for b in (-1, 1)]
    singles = [sign * far * one for far in range(1, _FARTHEST + 1) for one in each for sign in (-1, 1)]
    for change in [*singles, *pairs]:
        yield tuple((np.array(interval) + change).tolist())


def _moved(model: Model, point: Point, interval: Interval) -> Iterator[Point]:
    """Yield the point of an interval that is nearest by Newton's method, if it finds one."""
    if not interval or min(interval) < 0 or max(interval) > model.curve.values.size - 2:
        return
    low, high = model.bounds
    for _ in range(_NEWTON):
        if point.jumps == interval:
            yield point
            return
        edges = _places(model, point.x, interval)
        if edges is None:
            return
        places, slopes = edges
        change = np.clip(places, 2.0 * _INSIDE, 1.0 - 2.0 * _INSIDE) - places
        point = model.point(np.clip(point.x + np.linalg.pinv(slopes) @ change, low, high))


def _places(model: Model, x: Floats, interval: Interval) -> tuple[Floats, Floats] | None:
    """Return where the jumps lie, 0 to 1 in the interval, and the slopes [jump, parameter]; None where there are not
    as many.
    """
    values = model.curve.values
    begin, width = values[list(interval)], np.diff(values)[list(interval)]
    low, high = model.bounds
    changes = np.where(x + _CHANGE > high, -_CHANGE, _CHANGE)
    found = [model.jumps_at(each) for each in [x, *(x + np.diag(changes))]]
    if any(each.size != len(interval) for each in found) or not width.all():
        return None
    places = (np.array(found) - begin) / width
    return places[0], (places[1:] - places[0]).T / changes


def _least(model: Model, point: Point) -> Point:
    """Return the least squares in the interval of a point."""
    for _ in range(_ITERATIONS):
        before, ahead = _cost(point), _step(model, point)
        for _ in range(_HALVINGS):
            trials = _moved(model, model.point(point.x + ahead), point.jumps) if point.jumps else [model.point(point.x + ahead)]
            trial = next(iter(trials), point)
            if _cost(trial) < before:
                break
            ahead = 0.5 * ahead
        else:
            return point
        point = trial
        if _cost(point) > (1.0 - _LESS) * before:
            break
    return point


def _step(model: Model, point: Point) -> Floats:
    """Return the step to the least squares of the linear law, between the edges and the bounds."""
    left, sizes, right = np.linalg.svd(model.slopes(point.x), full_matrices=False)
    sizes = np.maximum(sizes, _FLAT * sizes[0])
    axes, goal = right.T / sizes, -left.T @ point.deviations
    low, high = model.bounds
    sides, ends = [np.eye(point.x.size), -np.eye(point.x.size)], [high - point.x, point.x - low]
    edges = _places(model, point.x, point.jumps)
    if edges is not None and point.jumps:
        places, slopes = edges
        sides += [slopes, -slopes]
        ends += [1.0 - _INSIDE - places, places - _INSIDE]
    ahead = axes @ _projected(goal, np.concatenate(sides) @ axes, np.maximum(np.concatenate(ends), 0.0))
    return np.asarray(ahead / max(np.abs(ahead).max() / _LONGEST, 1.0))


def _projected(goal: Floats, sides: Floats, ends: Floats) -> Floats:
    """Return the point nearest to ``goal`` with side . u <= end for each edge.

    C. L. Lawson, R. J. Hanson, Solving Least Squares Problems (1974), chapter 23: least distance programming.
    """
    from scipy.optimize import nnls

    lengths = np.linalg.norm(sides, axis=1)
    sides, ends = sides[lengths > 0.0] / lengths[lengths > 0.0, None], ends[lengths > 0.0] / lengths[lengths > 0.0]
    excess = sides @ goal - ends
    if excess.max() <= 0.0:
        return goal
    size = float(excess.max())
    last = np.zeros(goal.size + 1)
    last[-1] = 1.0
    multipliers, _ = nnls(np.vstack([-sides.T, excess / size]), last)
    rest = np.append(-sides.T @ multipliers, float(excess @ multipliers) / size - 1.0)
    return np.asarray(goal - size * rest[:-1] / rest[-1])

"""The law of a surface by boundary elements on a grid that is fine enough for an error."""

import math

import numpy as np

from roughmdr.elements.path import GridPath, solve_on_grid
from roughmdr.elements.surface import Surface, grid_shape
from roughmdr.interaction.totals import Step
from roughmdr.numerics.arguments import Floats

LARGEST_GRID = 1024
"""Most points along the side of a square: a step takes some 10 s."""
LIGHT = 0.01
"""Least force, over the largest of the path, that a relative error is taken of: below, errors are relative to this."""
_PER_SUMMIT, _FIRST_ERROR = 9.0, 0.02
"""Points along the mean distance of summits that mostly give a force to that error, on maps and of asperities."""
_FEWEST, _FASTEST, _ORDER = 1.2, 2.0, 2.0  # refinement of a grid, and the order of the error in its cells
_BEST_ORDER = 3.0  # the highest order that was found on maps
BUDGET = 6e8
"""Iterations times points that may be spent on the question whether an error is in reach, and on a path where it is not
(about a minute on one core, at 0.1 us each). A count, so that results do not depend on the machine."""
_COARSE, _MOST_LOOKS, _CLOSE = 0.1, 12, 0.05
"""Search for a load: error of the force [1] on the first grid, most separations that are tried on a grid, and error
that the load is met to, over that of the grid."""
_WORK_ORDER = 2.5  # order of that number in the points along a side: more iterations on finer grids


def first_points(summits: float, error: float) -> float:
    """Return the points along a side that a force to ``error`` [1] is expected to take."""
    return min(_PER_SUMMIT * math.sqrt(summits * _FIRST_ERROR / error), LARGEST_GRID)


def solve_to_error(
    surface: Surface,
    separation: Floats,
    effective_modulus: float,
    error: float,
    *,
    stiffness: bool,
    points: float = 0.0,
) -> GridPath:
    """Return the totals at separations [m], on a grid by which the force is off by at most ``error`` [1].

    The first grid has at least so many ``points`` along a side. Finer ones are tried at the step with the largest error
    and at the lowest separation before the whole path is solved again. If they show that ``LARGEST_GRID`` misses the
    error, or exhaust ``BUDGET`` before they show the opposite, the path is solved on the finest grid that the budget
    allows.
    """

    def on(points: float, separation: Floats, *, stiffness: bool) -> GridPath:
        shape = grid_shape(surface.sides, points)
        return solve_on_grid(surface, separation, effective_modulus, shape, stiffness=stiffness)

    points = max(points, first_points(surface.tops.size, error))
    found = on(points, separation, stiffness=stiffness)
    spent = found.work
    while (off := errors(found)).max() > error and points < LARGEST_GRID:
        tried = separation[[int(np.argmax(off)), int(np.argmin(separation))]]
        solved, share, reaches = points, tried.size / separation.size, True
        cost = found.work * share
        while off.max() > error and reaches:
            with np.errstate(over="ignore"):
                finer = np.clip((off.max() / error) ** (1.0 / _ORDER), _FEWEST, _FASTEST)
            refined = min(float(finer) * points, LARGEST_GRID)
            foreseen = cost * (refined / points) ** _WORK_ORDER
            reaches = points < LARGEST_GRID and _may_reach(off.max(), points, error) and spent + foreseen <= BUDGET
            if reaches:
                trial = on(refined, tried, stiffness=False)
                points, off, cost, spent = refined, errors(trial), trial.work, spent + trial.work
        if not reaches:
            growth = (max(BUDGET - spent, 0.0) / max(found.work, 1.0)) ** (1.0 / _WORK_ORDER)
            points = min(solved * growth, LARGEST_GRID)
            return found if points < _FEWEST * solved else on(points, separation, stiffness=stiffness)
        found = on(points, separation, stiffness=stiffness)
    return found


def least_error(summits: float) -> float:
    """Return the least error of the force [1] that the largest grid is expected to have."""
    return _PER_SUMMIT**2 * summits * _FIRST_ERROR / LARGEST_GRID**2


def solve_under_loads(
    surface: Surface, separation: Floats, effective_modulus: float, error: float, load: Floats
) -> tuple[Floats, GridPath]:
    """Return the separations [m] at which boundary elements bear loads [N], and the totals there.

    The search begins at ``separation`` and on a coarse grid, and stays there without a load. What is left between force
    and load counts as an error.
    """
    separation, top = separation.copy(), float(surface.tops.max())
    steps = [Step(error=0.0 if math.isfinite(h) else math.inf) for h in separation.tolist()]
    pressed = np.flatnonzero(np.isfinite(separation) & (load > 0.0))
    if not pressed.size:
        return separation, GridPath(steps, (0, 0))
    sought, h = load[pressed], separation[pressed]
    for level in sorted({max(error, _COARSE), error}, reverse=True):
        points = 0.0
        for look in range(_MOST_LOOKS):
            found = solve_to_error(surface, h, effective_modulus, level, stiffness=True, points=points)
            points = math.sqrt(math.prod(found.shape))
            numbers = [(step.force, step.stiffness, step.error) for step in found.steps]
            force, stiffness, off = np.array(numbers).T
            bears, solved = (force > 0.0) & (stiffness > 0.0), np.isfinite(off)
            ratio = np.log(np.divide(force, sought, out=np.ones(h.size), where=bears))
            if (bears & solved & (np.abs(ratio) <= _CLOSE * level)).all() or look == _MOST_LOOKS - 1:
                break
            way = np.divide(force, stiffness, out=np.zeros(h.size), where=bears) * ratio  # Newton for log F
            way = np.where(bears, way, 0.5 * (h - top))  # the grid has missed what bears it
            h = h + np.where(solved, way, 0.5 * (top - h))  # below the mean height there is no equilibrium
    for number, step, asked in zip(pressed.tolist(), found.steps, sought.tolist(), strict=True):
        steps[number] = step._replace(error=max(step.error, abs(step.force - asked)))
    separation[pressed] = h
    return separation, found._replace(steps=steps)


def _may_reach(off: float, points: float, error: float) -> bool:
    """Return whether the largest grid may reach an error, given the error ``off`` with so many points a side."""
    return not math.isfinite(off) or off * (points / LARGEST_GRID) ** _BEST_ORDER <= error


def errors(found: GridPath) -> Floats:
    """Return the error of the force at each step of a path, over the force, or over ``LIGHT`` of the largest one.

    It is infinite where the grid finds no force along the path but may have missed one, and 0 where there is no
    equilibrium.
    """
    error = np.array([step.error for step in found.steps])
    force = np.where(np.isfinite(error), [step.force for step in found.steps], 0.0)
    error = np.where(np.isfinite(error), error, 0.0)
    scale = np.maximum(force, LIGHT * float(force.max(initial=0.0)))
    return np.asarray(np.divide(error, scale, out=np.where(error > 0.0, np.inf, 0.0), where=scale > 0.0))

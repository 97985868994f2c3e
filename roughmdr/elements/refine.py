"""The law of a surface by boundary elements on a grid as fine as an error asks for."""

import math

import numpy as np

from roughmdr.elements.path import GridPath, solve_on_grid
from roughmdr.elements.surface import Surface, grid_shape
from roughmdr.numerics.arguments import Floats

LARGEST_GRID = 2048
"""Points along the side of a square: some 20 s a step."""
LIGHT = 0.01
"""Of the largest force of the path: forces below count as so much where errors are held against the one asked for."""
_PER_SUMMIT, _FIRST_ERROR = 9.0, 0.02
"""Points along the mean distance of summits that mostly give a force to that error, on maps and of asperities."""
_FEWEST, _FASTEST, _ORDER = 1.2, 2.0, 2.0  # refinement of a grid, and the order of the error in its cells


def first_points(summits: float, error: float) -> float:
    """Return the points along a side that a force to ``error`` [1] is expected to take."""
    return min(_PER_SUMMIT * math.sqrt(summits * _FIRST_ERROR / error), LARGEST_GRID)


def solve_to_error(
    surface: Surface, separation: Floats, effective_modulus: float, error: float, *, stiffness: bool
) -> GridPath:
    """Return the totals at separations [m], on a grid by which the force is off by at most ``error`` [1].

    It ends with ``LARGEST_GRID`` whatever the error.
    """
    points = first_points(surface.tops.size, error)
    while True:
        shape = grid_shape(surface.sides, points)
        found = solve_on_grid(surface, separation, effective_modulus, shape, stiffness=stiffness)
        off = largest_error(found)
        if off <= error or points >= LARGEST_GRID:
            return found
        finer = min(max((off / error) ** (1.0 / _ORDER), _FEWEST), _FASTEST)
        points = min(finer * points, LARGEST_GRID)


def largest_error(found: GridPath) -> float:
    """Return the largest error of the force along a path, over the force, or over ``LIGHT`` of the largest one."""
    solved = [step for step in found.steps if math.isfinite(step.error)]
    force, error = (np.array([getattr(step, name) for step in solved]) for name in ("force", "error"))
    largest = float(force.max(initial=0.0))
    return float(np.max(error / np.maximum(force, LIGHT * largest))) if largest > 0.0 else 0.0

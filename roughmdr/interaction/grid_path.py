"""Asperities pressed together as the height map that they make, along a path of the flat, by boundary elements."""

import math
from typing import NamedTuple

import numpy as np

from roughmdr.ensemble.ensemble import Ensemble
from roughmdr.errors import SceneError
from roughmdr.interaction.boundary_elements import BoundaryElements, Patches
from roughmdr.interaction.placed import sides_of
from roughmdr.interaction.totals import Step
from roughmdr.interaction.union_map import POINTS, grid_shape, union_map
from roughmdr.numerics.arguments import Floats

_CELL_ERROR = 0.12
"""Largest error of the force of a paraboloid anywhere on a grid, over the square of cell over contact radius."""
_HERTZ = 4.0 / 3.0  # of the force over E*, contact radius and depth of a paraboloid
_DEEPER = 2.0  # so much farther below the lowest flat a map reaches, where the surface rises to its rim


class GridPath(NamedTuple):
    """Totals along a path, and the grid that they were computed on."""

    steps: list[Step]
    """``error`` is inf where boundary elements do not converge; no overlaps."""
    shape: tuple[int, int]


def solve_on_grid(
    ensemble: Ensemble, separation: Floats, effective_modulus: float, stiffness: bool, points: int = POINTS
) -> GridPath:
    """Return the totals at separations [m] on a grid over the patch; ``stiffness`` only where it is asked for.

    Contacts are the connected patches under pressure. The error is that of the grid: the relative difference of the
    force on every other point of it where the flat is closest, and at least what a cell is off for contacts of the mean
    radius. Without contact on the grid it is the force of summits that stand between its points.
    """
    sides = sides_of(ensemble)
    if sides is None:
        raise SceneError("ensemble: boundary elements need the patch; give patch, patch_x and patch_y, or nominal_area")
    length, shape = sides[0], grid_shape(np.array(sides), points)
    highest = float(ensemble.height.max(initial=-math.inf))
    distinct, index = np.unique(-separation, return_inverse=True)
    downwards = [-h for h in distinct.tolist()]
    if downwards[-1] >= highest:
        return GridPath([Step()] * separation.size, shape)
    depth = highest - downwards[-1]
    while True:
        floor = downwards[-1] - depth
        grid = BoundaryElements(
            union_map(ensemble, np.array(sides), shape, floor) / length, np.array([1.0, sides[1] / length])
        )
        steps, error = _along(grid, ensemble.height / length, [h / length for h in downwards], stiffness)
        if not _surface_below(grid, floor / length, [h / length for h in downwards], steps):
            break
        depth *= _DEEPER
    in_si = [_in_si(step, length, effective_modulus, error) for step in steps]
    return GridPath([in_si[i] for i in index.ravel()], shape)


def _along(
    grid: BoundaryElements, summits: Floats, downwards: list[float], stiffness: bool
) -> tuple[list[Step], float]:
    """Return the totals in units of the side and E*, with the error by the size of its cells, and that by the grid."""
    steps, of_grid = list[Step](), 0.0
    for h in downwards:
        force = grid.press(h)
        if not math.isfinite(force):
            steps.append(Step(error=math.inf))
            continue
        patches = grid.patches()
        rigidity = grid.stiffness(h) if stiffness else 0.0
        error = _cell_error(grid, summits, h, force, patches) if math.isfinite(rigidity) else math.inf
        steps.append(Step(force, patches.radius_sum, patches.area, rigidity, patches.contacts, error))
    solved = [h for h, step in zip(downwards, steps, strict=True) if math.isfinite(step.error)]
    if solved:
        fine = steps[downwards.index(solved[-1])].force
        coarse = BoundaryElements(grid.height[::2, ::2], grid.sides).press(solved[-1])
        of_grid = abs(coarse / fine - 1.0) if fine > 0.0 and math.isfinite(coarse) else 1.0
    return steps, of_grid


def _cell_error(grid: BoundaryElements, summits: Floats, h: float, force: float, patches: Patches) -> float:
    """Return the error of the force by the places of the contacts between the points of the grid."""
    cell = math.sqrt(grid.cell_area)
    if force > 0.0:
        return force * min(_CELL_ERROR * (cell * patches.contacts / patches.radius_sum) ** 2, 1.0)
    missed = summits[summits > h] - h
    return _HERTZ * cell * math.fsum(missed.tolist())  # of contacts smaller than a cell


def _surface_below(grid: BoundaryElements, floor: float, downwards: list[float], steps: list[Step]) -> bool:
    """Return whether the surface rises to where the map was cut off, at the last separation with an equilibrium."""
    empty = np.isneginf(grid.height)
    solved = [h for h, step in zip(downwards, steps, strict=True) if math.isfinite(step.error)]
    if not solved or not empty.any():
        return False
    return bool((solved[-1] + grid.displacement()[empty]).min() < floor)


def _in_si(step: Step, length: float, modulus: float, error: float) -> Step:
    """Return the totals of a step, with the error of the grid."""
    if not math.isfinite(step.error):
        return Step(error=math.inf)
    force = modulus * length * length * step.force
    return Step(
        force,
        length * step.radius_sum,
        length * length * step.area,
        modulus * length * step.stiffness,
        step.contacts,
        max(error * force, modulus * length * length * step.error),
    )

"""A surface pressed along a path of the flat by boundary elements, with the error of the grid."""

import math
from typing import NamedTuple

import numpy as np

from roughmdr.elements.half_space import BoundaryElements, Patches
from roughmdr.elements.surface import Surface
from roughmdr.interaction.totals import Step
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.underway import each_step

_OF_COARSER = 0.5
"""Error of the force on a grid over the change to every other point of it: that is order 1.6 in the cell size. On maps
the order was 2 to 3, but a single change may be small by chance."""
_CELL_ERROR = 0.12
"""Largest error of the force of a paraboloid anywhere on a grid, over the square of cell over contact radius; for many
it is divided by the root of their number."""
_HERTZ = 4.0 / 3.0  # force of a paraboloid over E* times contact radius times depth (Hertz)
_DEEPER = 2.0  # factor on the depth of the map below the lowest flat, where the half-space rises to the cut


class GridPath(NamedTuple):
    """Totals along a path, and the grid that they were computed on."""

    steps: list[Step]
    """``error`` [N] is inf where boundary elements do not converge; no overlaps."""
    shape: tuple[int, int]
    work: float = 0.0
    """Iterations times points of the grids, with those around a surface that stands alone."""


def solve_on_grid(
    surface: Surface, separation: Floats, effective_modulus: float, shape: tuple[int, int], *, stiffness: bool
) -> GridPath:
    """Return the totals at separations [m] on a grid with ``shape``; ``stiffness`` only where it is asked for.

    Contacts are the connected patches under pressure. The error is that of the grid: from the change to every other
    point of it, there or closer, and at least that of a cell for contacts of the mean radius. Without contact on the
    grid it is the force of summits between its points.
    """
    length = float(surface.sides[0])
    highest = float(surface.tops.max(initial=-math.inf))
    distinct, index = np.unique(-separation, return_inverse=True)
    downwards = [-h for h in distinct.tolist()]
    if downwards[-1] >= highest:
        return GridPath([Step()] * separation.size, shape)
    depth, reduced = highest - downwards[-1], [h / length for h in downwards]
    work = 0.0
    while True:
        floor = downwards[-1] - depth
        height = surface.on_grid(shape, floor) / length
        grid = BoundaryElements(height, surface.sides / length, periodic=surface.periodic)
        coarser = BoundaryElements(grid.height[::2, ::2], grid.sides, periodic=grid.periodic)
        steps = _along(grid, coarser, surface.tops / length, reduced, stiffness)
        work += grid.work + coarser.work
        if not (surface.has_floor and _surface_below(grid, floor / length, reduced, steps)):
            break
        depth *= _DEEPER
    in_si = [_in_si(step, length, effective_modulus) for step in steps]
    return GridPath([in_si[i] for i in index.ravel()], shape, work)


def _along(
    grid: BoundaryElements, coarser: BoundaryElements, summits: Floats, downwards: list[float], stiffness: bool
) -> list[Step]:
    """Return the totals in units of the side and E*, with the error by comparison with a coarser grid."""
    steps, changes = list[Step](), list[float]()
    for h in each_step(downwards):
        force, coarse = grid.press(h), coarser.press(h)
        rigidity = grid.stiffness(h) if stiffness and math.isfinite(force) else 0.0
        changes.append(abs(coarse / force - 1.0) if force > 0.0 and math.isfinite(coarse + force) else 0.0)
        if not math.isfinite(force + rigidity):
            steps.append(Step(error=math.inf))
            continue
        patches = grid.patches()
        error = _cell_error(grid, summits, h, force, patches)
        totals = force, patches.radius_sum, patches.area, rigidity, patches.contacts, error
        steps.append(Step(*totals, area_error=patches.area_error))
    farther = np.minimum(_OF_COARSER * np.maximum.accumulate(changes[::-1])[::-1], 1.0).tolist()
    return [
        step._replace(error=max(step.error, change * step.force)) for step, change in zip(steps, farther, strict=True)
    ]


def _cell_error(grid: BoundaryElements, summits: Floats, h: float, force: float, patches: Patches) -> float:
    """Return the error of the force by the positions of the contacts relative to the points of the grid."""
    cell = math.sqrt(grid.cell_area)
    if force > 0.0:
        of_one = _CELL_ERROR * (cell * patches.contacts / patches.radius_sum) ** 2
        return force * min(of_one / math.sqrt(patches.contacts), 1.0)
    missed = summits[summits > h] - h
    return _HERTZ * cell * math.fsum(missed.tolist())  # force of contacts smaller than a cell


def _surface_below(grid: BoundaryElements, floor: float, downwards: list[float], steps: list[Step]) -> bool:
    """Return whether the half-space rises to where the map was cut off, at the last separation with an equilibrium."""
    empty = np.isneginf(grid.height)
    solved = [h for h, step in zip(downwards, steps, strict=True) if math.isfinite(step.error)]
    if not solved or not empty.any():
        return False
    return bool((solved[-1] + grid.displacement()[empty]).min() < floor)


def _in_si(step: Step, length: float, modulus: float) -> Step:
    """Return the totals of a step in SI."""
    if not math.isfinite(step.error):
        return Step(error=math.inf)
    area = length * length
    return Step(
        modulus * area * step.force,
        length * step.radius_sum,
        area * step.area,
        modulus * length * step.stiffness,
        step.contacts,
        modulus * area * step.error,
        area_error=area * step.area_error,
    )

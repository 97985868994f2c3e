"""The energies of loops of a path: the work of loading, what unloading gives back, and the loss."""

import math
from collections.abc import Iterator
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from roughmdr.batch.moments import mean_and_error
from roughmdr.numerics.arguments import Floats
from roughmdr.result.view import ResultView
from roughmdr.variables import SEPARATION

_CLOSED = 1e-9  # difference of separations that are equal, over the largest on the path
_FEWEST = 4  # steps of a leg that tell the error of its work


class Loop(NamedTuple):
    """A loading with the unloading back to where it began, in the mean of one cell."""

    steps: slice
    """Steps of the path from its start back to there."""
    start: float
    """Separation where the loading begins [m]."""
    closest: float
    """Separation where the loop turns [m]."""
    energy_lost: float
    """Work of the loading less what the unloading gives back [J]."""
    error: float
    """How far ``energy_lost`` may be off [J], by the trapezoid rule and by contacts at the ends of the loop; NaN of
    fewer than four steps a leg.
    """
    work_of_loading: float
    """Work done on the asperities from the start to the turning point [J]."""


def loops_of(result: ResultView, cell: tuple[int, ...]) -> Iterator[Loop]:
    """Yield the loops of a cell over the separation; energies are NaN where the force is not known at all steps.

    A loop begins at the turning point before its loading. Contacts that are there at its ends hold energy, of which the
    error counts the force times the way.
    """
    separation, force = result.over_steps(SEPARATION.name)[cell], result.mean("force")[0][cell].reshape(-1)
    margin = _CLOSED * float(np.nanmax(np.abs(separation)))
    for there, back in pairwise(result.legs):
        first, turn = max(int(there.steps[0]) - 1, 0), int(there.steps[-1])
        within = back.steps[separation[back.steps] <= separation[first] + margin]
        closed = separation[back.steps[-1]] >= separation[first] - margin
        if there.branch == "loading" and turn > first and within.size and closed:
            steps = slice(first, int(within[-1]) + 1)
            inward = np.arange(first, steps.stop - 1) < turn
            h, load = separation[steps], force[steps]
            work, _, _, _, lost, error = map(float, loop_energies(load, h, loading=inward, unloading=~inward))
            error += float((abs(load[0]) + abs(load[-1])) * (h[0] - h.min()))
            if min(inward.sum(), (~inward).sum()) < _FEWEST - 1:
                error = math.nan
            if -error <= lost <= 0.0:  # none, to the error
                lost = 0.0
            yield Loop(steps, float(h[0]), float(h.min()), lost, error, 0.0 + work)


def standard_error_of(result: ResultView, cell: tuple[int, ...], loop: Loop) -> float:
    """Return the standard error [J] of the energy lost, over the realisations; NaN of one, and of statistics.

    The energy of each is a weighted sum of its forces along the loop.
    """
    if "force" not in result.variables:
        return math.nan
    runs, known = result.variables["force"].values[cell], result.done[cell]
    run = np.pad(np.diff(result.over_steps(SEPARATION.name)[cell][loop.steps]), 1)
    losses = runs[..., loop.steps] @ (-0.5 * (run[1:] + run[:-1]))
    return float(mean_and_error(losses[..., None], known)[1].item())


def loop_energies(
    force: Floats, separation: Floats, *, loading: NDArray[np.bool_], unloading: NDArray[np.bool_]
) -> tuple[Floats, ...]:
    """Return the work of loading, of unloading, and their difference, each followed by its error.

    By the trapezoid rule. To leave a step out takes away the triangle that it makes with its neighbours. The error is
    a third of the larger change where every other step is left out, as that of smooth curves is, and the root of the
    sum of the squares of the triangles, for jumps: one between two steps makes a triangle of at least its own error.
    """
    force, separation = np.broadcast_arrays(force, separation)
    work = 0.5 * (force[..., 1:] + force[..., :-1]) * np.diff(separation, axis=-1)
    rise, run = np.diff(force, axis=-1), np.diff(separation, axis=-1)
    triangle = 0.5 * (run[..., :-1] * rise[..., 1:] - run[..., 1:] * rise[..., :-1])
    inner = [branch[:-1] & branch[1:] for branch in (loading, unloading)]
    even = np.arange(triangle.shape[-1]) % 2 == 0

    def error(steps: NDArray[np.bool_]) -> Floats:
        changes = (np.abs(_sum(triangle, steps & every_other)) for every_other in (even, ~even))
        return np.asarray(np.maximum(*changes) / 3.0 + np.sqrt(_sum(triangle * triangle, steps)))

    done, regained = -_sum(work, loading), _sum(work, unloading)
    return done, error(inner[0]), regained, error(inner[1]), done - regained, error(inner[0] | inner[1])


def _sum(values: Floats, chosen: NDArray[np.bool_]) -> Floats:
    return np.asarray(values[..., chosen].sum(axis=-1))

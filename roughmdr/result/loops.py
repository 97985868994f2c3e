"""The energies of loops of a path: the work of loading, what unloading gives back, and the loss."""

from collections.abc import Iterator
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from roughmdr.batch.moments import mean_and_error
from roughmdr.numerics.arguments import Floats
from roughmdr.result.view import ResultView
from roughmdr.variables import SEPARATION


class Loop(NamedTuple):
    """A loading with the unloading that undoes it, in the mean of one cell."""

    closest: float
    """Separation at which it turns [m]."""
    lost: float
    """Work of the loading less what the unloading gives back [J], at least 0."""
    error: float
    """How far the trapezoid rule may be off in ``lost`` [J]."""
    standard_error: float
    """Standard error of ``lost`` over the realisations [J]; NaN of one, and of a result of statistics."""
    work: float
    """Work of the loading [J]."""


def loops_of(result: ResultView, cell: tuple[int, ...] = ()) -> Iterator[Loop]:
    """Yield the loops of a cell, over the separation, whose unloading goes back to where the loading began, or beyond.

    NaN where the force is not known at all of its steps.
    """
    separation, force = result.over_steps(SEPARATION.name)[cell], result.mean("force")[0][cell].reshape(-1)
    for there, back in pairwise(result.legs):
        returns = separation[back.steps[-1]] >= separation[there.steps[0]]
        steps = slice(there.steps[0], back.steps[-1] + 1)
        if (there.branch, back.branch) == ("loading", "unloading") and returns:
            inward = np.arange(steps.stop - steps.start - 1) < there.steps.size - 1
            branches = {"loading": inward, "unloading": ~inward}
            work, _, _, _, lost, error = map(float, loop_energies(force[steps], separation[steps], **branches))
            spread = _standard_error(result, cell, steps)
            yield Loop(float(separation[steps].min()), max(lost, 0.0), error, spread, work)


def _standard_error(result: ResultView, cell: tuple[int, ...], steps: slice) -> float:
    """Return the standard error of the energy lost along ``steps``, a sum of the forces of each realisation."""
    if "force" not in result.variables:
        return float("nan")
    runs, known = result.variables["force"].values[cell], result.done[cell]
    run = np.pad(np.diff(result.over_steps(SEPARATION.name)[cell][steps]), 1)
    weights = -0.5 * (run[1:] + run[:-1])
    return float(mean_and_error((runs[..., steps] @ weights)[..., None], known)[1].item())


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

"""Adhesive contacts in equilibrium at one separation, by Newton's method on their radii and loads."""

import math

import numpy as np
from numpy.typing import NDArray

from roughmdr.interaction.jkr.equilibrium import Problem, State, evaluate
from roughmdr.interaction.jkr.tangent import Drive, Factors, Step, Tangent

_PATIENCE = 3  # steps, in which the residual has to halve
_LARGEST_STEP = 0.3  # of a state
_ROUNDING = 16.0 * np.finfo(np.float64).eps
_ERROR = 1e-13  # of the natural depth
_AT_REST = 1e3  # times the error: where rounding lets no step go further


def tolerance(problem: Problem, state: State) -> float:
    """Return the residual over the natural depth that rounding leaves."""
    on = state.inside
    size = np.abs(problem.asperities.height - state.separation) + np.abs(state.potential) + np.abs(state.contacts.depth)
    return float(np.max(_ERROR + _ROUNDING * (size / problem.natural)[on], initial=_ERROR))


@np.errstate(all="ignore")  # a guess that no float holds leads nowhere
def newton(
    problem: Problem, state: State, drive: Drive, factors: Factors, along: float = 0.0, lead: int | None = None
) -> tuple[State, float]:
    """Return the equilibrium from a guess, and the place along the path, which changes only with a leading radius.

    Its error is inf where there is none to be found.
    """
    errors = [math.inf] * _PATIENCE
    while state.inside.any():
        limit = tolerance(problem, state)
        if state.error <= limit or (state.error > 0.5 * errors[-1] and errors[-1] <= _AT_REST * limit):
            break
        if not state.error < 0.5 * errors[-_PATIENCE] and math.isfinite(errors[-_PATIENCE]):
            return state._replace(error=math.inf), along
        if not math.isfinite(state.error):
            break
        errors.append(state.error)
        tangent = Tangent(problem, state, drive, factors, lead)
        on = tangent.on
        edge = -state.edge[on] * 2.0 * np.sqrt(2.0 * math.pi * problem.work * state.contacts.radius[on])
        step = tangent.solve(edge, -state.gap[on])
        if not (np.isfinite(step.radius).all() and np.isfinite(step.load).all() and math.isfinite(step.along)):
            return state._replace(error=math.inf), along
        largest = 0.0 if tangent.pinned else float(np.max(np.abs(step.radius) / (state.contacts.slope * state.t)[on]))
        part = min(1.0, _LARGEST_STEP / largest) if largest > 0.0 else 1.0
        state, along = moved(problem, state, on, step, part, drive, along)
    return state, along


def moved(
    problem: Problem, state: State, on: NDArray[np.int64], step: Step, part: float, drive: Drive, along: float
) -> tuple[State, float]:
    """Return the state moved by a part of a step, and its place along the path."""
    t, load = state.t.copy(), state.load.copy()
    if not problem.kernels.pinned:
        t[on] = np.maximum(t[on] + part * step.radius / state.contacts.slope[on], 0.1 * t[on])
    load[on] += part * step.load
    change = part * step.along
    outer = state.outer + drive.outer * change
    return evaluate(problem, state.inside, t, load, state.separation + drive.separation * change, outer), along + change

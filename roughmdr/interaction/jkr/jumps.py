"""Jumps of adhesive contacts at one separation: one after the other, until all are at rest."""

from typing import NamedTuple

import numpy as np

from roughmdr.interaction.jkr.branch import Event, NoEquilibriumError, advance
from roughmdr.interaction.jkr.equilibrium import Problem, State, energy, evaluate
from roughmdr.interaction.jkr.newton import newton
from roughmdr.interaction.jkr.tangent import Drive, Factors

_UNMOVED = 1e-11  # of the natural depth, by which the others are out of equilibrium after a jump
_MAX_JUMPS = 100  # times the number of asperities


class Avalanche(NamedTuple):
    """Contacts that changed at one separation."""

    separation: float
    size: int
    """Number of jumps."""
    dissipated: float
    """[E* L^3]."""


def jump(problem: Problem, state: State, event: Event) -> State:
    """Return the state after a jump of one contact, of which all others have felt nothing yet.

    What they would feel is put into the outer field.
    """
    kernels, i = problem.kernels, event.asperity
    inside, t, load = state.inside.copy(), state.t.copy(), state.load.copy()
    contacts = state.contacts
    if event.kind == "made":
        depth, begin, upwards = max(float(state.gap[i]), 0.0), 0.0, True
    else:
        field = state.field[:, i] + state.outer[:, i]
        displaced = 0.5 * contacts.lift[i] * (field[1] ** 2 + field[2] ** 2) - 0.5 * field[3] * contacts.radius[i] ** 2
        depth, begin, upwards = float(contacts.depth[i] + displaced), float(t[i]), event.upwards
    found = kernels.next_state(begin, upwards, depth, problem.work, i, problem.asperities)
    inside[i] = found > 0.0
    t[i] = found
    load[i] = kernels.lone_load(found, depth, problem.work, i, problem.asperities) if found > 0.0 else 0.0
    new = evaluate(problem, inside, t, load, state.separation, state.outer)
    shed = state.field - new.field
    shed[0] = state.potential - new.potential
    new = evaluate(problem, inside, t, load, state.separation, state.outer + shed)
    if new.error <= _UNMOVED:  # at a fold, where others may be about to follow, no step is sure
        return new
    rest, _ = newton(problem, new, Drive(0.0, np.zeros_like(shed)), Factors(problem, new))
    if not np.isfinite(rest.error):
        raise NoEquilibriumError
    return rest


def avalanche(problem: Problem, state: State, event: Event) -> tuple[State, Avalanche]:
    """Return the state at rest after a jump and all that it sets off, one jump at a time.

    The load that a jump sheds is handed to the others little by little; at the next fold another contact jumps.
    """
    before, size = energy(problem, state), 0
    next_event: Event | None = event
    while next_event is not None:
        if size > _MAX_JUMPS * state.t.size:
            raise NoEquilibriumError
        state, size = jump(problem, state, next_event), size + 1
        state, next_event = advance(problem, state, Drive(0.0, -state.outer))
    nothing = np.zeros_like(state.outer)
    rest = evaluate(problem, state.inside, state.t, state.load, state.separation, nothing)
    rest, _ = newton(problem, rest, Drive(0.0, nothing), Factors(problem, rest))
    if not np.isfinite(rest.error):
        raise NoEquilibriumError
    return rest, Avalanche(rest.separation, size, before - energy(problem, rest))

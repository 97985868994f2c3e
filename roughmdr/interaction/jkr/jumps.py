"""Jumps of adhesive contacts at one separation: one after the other, until all are at rest."""

import math
from typing import NamedTuple

import numpy as np

from roughmdr.interaction.coupling import field_of
from roughmdr.interaction.jkr.branch import LEAST_STATE, NoEquilibriumError
from roughmdr.interaction.jkr.equilibrium import Drive, PairProblem, State, energy, evaluate
from roughmdr.interaction.jkr.events import Event, advance
from roughmdr.interaction.jkr.lone import Surface
from roughmdr.interaction.jkr.newton import at_rest

_MAX_JUMPS = 10  # jumps of an avalanche over the number of asperities: more come to no rest
_SAME = 1e-9  # relative difference of two sums of loads, below which contacts come back to where they have been


class Recurrence:
    """Events on a way of the flat, with the sum of the loads at each, to find one that comes back."""

    def __init__(self) -> None:
        self._loads: dict[Event, float] = {}

    def note(self, event: Event, state: State) -> None:
        """Note an event; NoEquilibriumError where it was met in the same state before.

        Each jump loses energy, so that a state comes back only where contacts that overlap make and lose each other
        without end.
        """
        load = float(state.load.sum())
        if abs(load - self._loads.get(event, math.inf)) <= _SAME * abs(load):
            raise NoEquilibriumError
        self._loads[event] = load


class Avalanche(NamedTuple):
    """Contacts that changed at one separation."""

    separation: float
    size: int
    """Number of jumps."""
    dissipated: float
    """[E* L^3]."""


def jump(problem: PairProblem, state: State, event: Event) -> State:
    """Return the state after a jump of one contact, of which all others have felt nothing yet.

    What they would feel is put into the outer field. NoEquilibriumError where it widens without end.
    """
    kernels, i = problem.kernels, event.asperity
    inside, t, load = state.inside.copy(), state.t.copy(), state.load.copy()
    contacts = state.contacts
    field = state.field[:, i] + state.outer[:4, i]
    square = float(field[1] ** 2 + field[2] ** 2)
    if event.kind == "made":
        depth, begin, upwards = float(state.gap[i] - contacts.lift[i]), 0.0, True
    else:
        depth, begin, upwards = float(contacts.depth[i]), float(t[i]), event.upwards
    surface = Surface(depth, 0.25 * float(field[3]), square)
    found = kernels.next_state(begin, upwards, surface, problem.work, i, problem.asperities)
    if upwards and not found:
        raise NoEquilibriumError
    if kernels.flat and found < LEAST_STATE:
        found = 0.0
    inside[i], t[i], load[i] = found > 0.0, found, 0.0
    if found > 0.0:
        load[i] = kernels.lone_load(found, surface, problem.work, i, problem.asperities)
    outer = state.outer.copy()
    outer[1:4] += field_of(problem.coupling, state.overlap.pairs, problem.order, state.load - load)[1:]
    new = evaluate(problem, inside, t, load, state.separation, outer)
    outer[0] += np.where(inside, new.gap, state.potential - new.potential)
    outer[4] -= 2.0 * new.release * new.edge
    return evaluate(problem, inside, t, load, state.separation, outer)


def avalanche(problem: PairProblem, state: State, event: Event) -> tuple[State, Avalanche]:
    """Return the state at rest after a jump and all that it sets off, one jump at a time.

    The load that a jump sheds is handed to the others little by little; at the next fold another contact jumps.
    NoEquilibriumError where they come to no rest.
    """
    before, size, met = energy(problem, state), 0, Recurrence()
    next_event: Event | None = event
    while next_event is not None:
        met.note(next_event, state)
        if size > _MAX_JUMPS * state.t.size:
            raise NoEquilibriumError
        state, size = jump(problem, state, next_event), size + 1
        state, next_event = advance(problem, state, Drive(0.0, -state.outer))
    rest = at_rest(problem, state)
    if not np.isfinite(rest.error):
        raise NoEquilibriumError
    return rest, Avalanche(rest.separation, size, before - energy(problem, rest))

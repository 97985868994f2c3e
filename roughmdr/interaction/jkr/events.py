"""A stable path of asperities near contact, up to where the next contact is made or lost."""

import math
from typing import Literal, NamedTuple

import numpy as np

from roughmdr.interaction.jkr.bracket import Bracket
from roughmdr.interaction.jkr.branch import NoEquilibriumError, Place, between, piece
from roughmdr.interaction.jkr.equilibrium import Drive, PairProblem, State, alone, among
from roughmdr.interaction.jkr.factors import Factors
from roughmdr.interaction.jkr.newton import newton
from roughmdr.numerics.arguments import Floats

_MAX_PIECES, _MAX_ROUNDS = 2000, 40
_SAME = 1e-12  # distance of two events, over the natural depth, below which they are one


class Event(NamedTuple):
    """A contact that is made or lost, or that jumps."""

    kind: Literal["made", "lost", "fold"]
    asperity: int
    upwards: bool
    """Whether its radius grows."""


def advance(problem: PairProblem, state: State, drive: Drive) -> tuple[State, Event | None]:
    """Follow the stable path from a state to its end, or to the first event.

    NoEquilibriumError where neither is found.
    """
    path = _Path(problem, state, drive)
    here, begun = path.begin, state
    if here.factors.unstable:  # one that jumped had held another
        return state, Event("fold", int(path.kept[here.factors.least_stable()]), upwards=False)
    for _ in range(_MAX_PIECES):
        there, fold = piece(path.few, here, path.drive)
        end = path.whole(there)
        if found := path.first_crossing(here, there, begun, end):
            return found
        if fold:
            return end, Event("fold", int(path.kept[fold.asperity]), fold.upwards)
        if there.along >= 1.0:
            return end, None
        here, begun = there, end
    raise NoEquilibriumError


def _opening(problem: PairProblem, state: State) -> Floats:
    """Return by how much each contact is beyond the point at which it is made or lost."""
    beyond = state.gap.copy()
    beyond[state.inside] = -math.inf
    if problem.kernels.pinned:
        on = state.inside
        beyond[on] = state.contacts.stretch[on] - state.release[on]
    return np.asarray(beyond / problem.natural)


class _Path:
    """Asperities, and the path of those alone that are in contact."""

    def __init__(self, problem: PairProblem, state: State, drive: Drive) -> None:
        self.problem, self.kept = problem, np.flatnonzero(state.inside)
        self.outer = state.outer, drive.outer
        self.drive = Drive(drive.separation, np.take(drive.outer, self.kept, axis=1))
        self.few, begin = alone(problem, state)
        self.begin = Place(begin, begin.factors or Factors(self.few, begin), 0.0)

    def whole(self, place: Place) -> State:
        """Return the state of all asperities at a place."""
        first, change = self.outer
        state = place.state._replace(factors=place.factors)
        return among(self.problem, self.kept, state, first + change * place.along)

    def first_crossing(self, here: Place, there: Place, begun: State, ended: State) -> tuple[State, Event] | None:
        """Return the first state between two places at which a contact is made or lost, but for folds."""
        problem = self.problem
        start, end = _opening(problem, begun), _opening(problem, ended)
        found, new = None, ended
        for _ in range(_MAX_ROUNDS):
            over = np.flatnonzero(end > _SAME)
            if not over.size:
                break
            due = over[start[over] >= -_SAME]
            if due.size:  # as soon as it sets out
                found, new = int(due[np.argmax(start[due])]), begun
                break
            found = int(over[np.argmin(start[over] / (start[over] - end[over]))])
            there, new = self._crossing(here, there, found, start[found], end[found])
            end = _opening(problem, new)
        if found is None:
            return None
        return new, Event("lost" if new.inside[found] else "made", found, not new.inside[found])

    def _crossing(self, here: Place, there: Place, asperity: int, start: float, end: float) -> tuple[Place, State]:
        """Return the place at which an asperity crosses, from its values at two others."""
        root, factors = Bracket((here.along, float(start)), (there.along, float(end))), here.factors
        for _ in range(_MAX_ROUNDS):
            middle = root.next
            guess = between(self.few, here, there, middle, self.drive)
            found = Place(newton(self.few, guess, self.drive, factors)[0], factors, middle)
            if not math.isfinite(found.state.error):
                raise NoEquilibriumError
            new = self.whole(found)
            value = float(_opening(self.problem, new)[asperity])
            root.narrow(middle, value)
            here, there = (found, there) if value < 0.0 else (here, found)
            if abs(value) <= _SAME or there.along - here.along <= 4.0 * np.spacing(1.0):
                break
        return found, new

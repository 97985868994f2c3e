"""The largest tension of adhesive contacts while the flat rises, between the steps of a path and at its jumps."""

import math
from typing import NamedTuple

import numpy as np

from roughmdr.interaction.jkr.bracket import Bracket
from roughmdr.interaction.jkr.equilibrium import Drive, PairProblem, State, alone, interpolated
from roughmdr.interaction.jkr.factors import Factors
from roughmdr.interaction.jkr.front import Piece
from roughmdr.interaction.jkr.newton import newton
from roughmdr.interaction.jkr.tangent import Tangent

_MAX_ROUNDS = 30
_SLOPE_RTOL = 1e-10  # error of the changes of loads of which the slope is the sum
_SIGN_RTOL = 1e-5  # error of these changes where the sign of the slope is enough: the force is off by its square
_RTOL = 1e-7  # slope of the force at its minimum, relative; the value there is off by its square


class Tension(NamedTuple):
    """A state under tension, in units of the patch."""

    force: float = 0.0
    separation: float = math.nan
    contacts: int = 0
    radius_squares: float = 0.0


def slope(problem: PairProblem, state: State, factors: Factors | None = None, rtol: float = _SLOPE_RTOL) -> float:
    """Return dF/dh of contacts."""
    if not state.t.size:
        return 0.0
    tangent = Tangent(problem, state, Drive(1.0, np.zeros_like(state.outer)))
    return math.fsum(tangent.rate(factors or Factors(problem, state), rtol).load.tolist())


def of_state(state: State) -> Tension:
    """Return the tension of a state."""
    squares = math.fsum((state.contacts.radius**2).tolist())
    return Tension(math.fsum(state.load.tolist()), state.separation, int(state.inside.sum()), squares)


class LargestTension:
    """The largest tension while the flat rises, looked for within those pieces of the way alone that may have it.

    Within a piece it is taken to be above that at both ends by no more than these differ.
    """

    def __init__(self) -> None:
        self._at_ends = Tension()  # the largest at the ends of pieces so far
        self._pieces = list[tuple[float, Piece]]()

    def pass_over(self, piece: Piece) -> None:
        """Add a piece on which the flat rises."""
        first, last = of_state(piece.begin), of_state(piece.end)
        self._at_ends = min(self._at_ends, first, last)
        if first.contacts:
            least = min(first.force, last.force) - abs(last.force - first.force)
            self._pieces = [each for each in [*self._pieces, (least, piece)] if each[0] < self._at_ends.force]

    def found(self) -> Tension:
        """Return the largest of all pieces so far."""
        best = self._at_ends
        for least, piece in sorted(self._pieces, key=lambda each: each[0]):
            if least < best.force:
                best = min(best, largest_within(piece))
        return best


def largest_within(piece: Piece) -> Tension:
    """Return the largest tension on a piece on which the flat rises.

    No contact is made or lost on it. Where the force has its least value within, that is found by its slope.
    """
    best, (few, state) = min(of_state(piece.begin), of_state(piece.end)), alone(piece.problem, piece.begin)
    factors = Factors(few, state)
    low = slope(few, state, factors, _SIGN_RTOL)
    if not low < 0.0:
        return best
    new = alone(piece.problem, piece.end)[1]
    fold = piece.event is not None and piece.event.kind == "fold"
    high = abs(low) if fold else slope(few, new, factors, _SIGN_RTOL)  # at a fold it is infinite
    if not high > 0.0:
        return best
    scale, still = max(-low, high), Drive(0.0, np.zeros_like(state.outer))
    root = Bracket((state.separation, low), (new.separation, high))
    for _ in range(_MAX_ROUNDS):
        h = root.next
        if not state.separation < h < new.separation:
            break
        part = (h - state.separation) / (new.separation - state.separation)
        middle, _ = newton(few, interpolated(few, state, new, part, h, state.outer), still, factors)
        if not math.isfinite(middle.error):
            return best
        best = min(best, of_state(middle))
        rate = slope(few, middle, factors)
        if abs(rate) <= _RTOL * scale:
            break
        root.narrow(h, rate)
        state, new = (middle, new) if rate < 0.0 else (state, middle)
    return best

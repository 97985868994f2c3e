"""The largest tension of adhesive contacts while the flat rises, between the steps of a path and at its jumps."""

import math
from typing import NamedTuple

import numpy as np

from roughmdr.interaction.jkr.bracket import Bracket
from roughmdr.interaction.jkr.equilibrium import Problem, State, evaluate
from roughmdr.interaction.jkr.newton import newton
from roughmdr.interaction.jkr.tangent import Drive, Factors, Tangent

_MAX_ROUNDS = 30
_SLOPE_RTOL = 1e-10
_RTOL = 1e-7  # of the slope of the force at its least, which is off by the square of that


class Tension(NamedTuple):
    """A state under tension, in units of the patch."""

    force: float = 0.0
    separation: float = math.nan
    contacts: int = 0
    radius_squares: float = 0.0


def slope(problem: Problem, state: State, factors: Factors | None = None) -> float:
    """Return dF/dh."""
    if not state.inside.any():
        return 0.0
    factors = factors or Factors(problem, state)
    tangent = Tangent(problem, state, Drive(1.0, np.zeros_like(state.outer)), factors)
    return math.fsum(tangent.rate(_SLOPE_RTOL).load.tolist())


def of_state(state: State) -> Tension:
    """Return the tension of a state."""
    squares = math.fsum((state.contacts.radius**2).tolist())
    return Tension(math.fsum(state.load.tolist()), state.separation, int(state.inside.sum()), squares)


def largest_between(problem: Problem, state: State, new: State, best: Tension, *, fold: bool) -> Tension:
    """Return the largest tension on the path from a state to another with larger separation, or ``best``.

    No contact is made or lost on it. Where the force has its least value within, that is found by its slope.
    """
    first, last = of_state(state), of_state(new)
    best = min(best, last)
    if not first.contacts or min(first.force, last.force) - abs(last.force - first.force) > best.force:
        return best
    factors = Factors(problem, state)
    low = slope(problem, state, factors)
    high = abs(low) if fold else slope(problem, new, factors)  # at a fold it is infinite
    if not low < 0.0 < high:
        return best
    scale = max(-low, high)
    root = Bracket((state.separation, low), (new.separation, high))
    for _ in range(_MAX_ROUNDS):
        on, h = state.inside, root.next
        part = (h - state.separation) / (new.separation - state.separation)
        t, load = state.t.copy(), state.load.copy()
        t[on] += part * (new.t[on] - state.t[on])
        load[on] += part * (new.load[on] - state.load[on])
        guess = evaluate(problem, on, t, load, h, state.outer)
        middle, _ = newton(problem, guess, Drive(0.0, np.zeros_like(state.outer)), factors)
        if not math.isfinite(middle.error):
            return best
        best = min(best, of_state(middle))
        rate = slope(problem, middle, factors)
        if abs(rate) <= _RTOL * scale:
            break
        root.narrow(h, rate)
        state, new = (middle, new) if rate < 0.0 else (state, middle)
    return best

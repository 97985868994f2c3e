"""Adhesive contacts in equilibrium, from a guess, by steps with the factors of a near state.

Each step is improved by those before, and the tangent is factored again where steps go too slowly.
"""

import math

import numpy as np

from roughmdr.interaction.jkr.equilibrium import Drive, PairProblem, State, Step, alone, among, evaluate, moved
from roughmdr.interaction.jkr.factors import Factors, Lead
from roughmdr.interaction.jkr.tangent import Mixing, leading

_SLOW = 0.12  # share of the error that a step leaves, above which the tangent is factored again
_PATIENCE = 8  # steps with factors of their own, in which the residual has to halve
_LARGEST_STEP = 0.3  # largest relative change of a state in one step
_AT_REST = 1e3  # residual over that of rounding that counts as rest where rounding lets no step go further


@np.errstate(all="ignore")  # a guess that no float holds leads nowhere
def newton(
    problem: PairProblem,
    state: State,
    drive: Drive,
    factors: Factors | None,
    along: float = 0.0,
    lead: Lead | None = None,
    error: float = 0.0,
) -> tuple[State, float]:
    """Return the equilibrium from a guess, and the place along the path, which changes only with a leading radius.

    Its error is inf where there is none to be found; ``error`` is one over the natural depth that is small enough.
    """
    mixing, errors, own = Mixing(), list[float](), False
    while state.t.size:
        if state.error <= max(state.limit, error):
            break
        slow = bool(errors) and not state.error < _SLOW * errors[-1]
        if slow and errors[-1] <= _AT_REST * state.limit:
            break
        if not math.isfinite(state.error) or (
            own and len(errors) >= _PATIENCE and not state.error < 0.5 * errors[-_PATIENCE]
        ):
            return state._replace(error=math.inf), along
        if slow and (not own or len(errors) >= _PATIENCE):
            factors = Factors(problem, state)
            lead = None if lead is None else leading(problem, state, drive, factors, lead.asperity)
            mixing, errors, own = Mixing(), [], True
        errors.append(state.error)
        factors = factors or Factors(problem, state)
        step = factors.solve(-state.edge * 2.0 * state.release, -state.gap, lead)
        change = factors.unknowns(step, lead)
        change = mixing.improved(change)
        if not np.isfinite(change).all():
            return state._replace(error=math.inf), along
        step = factors.step_of(change, lead)
        step = step._replace(radius=step.radius * (state.contacts.slope / factors.slope))  # even steps of the state t
        largest = 0.0 if factors.pinned else float(np.max(np.abs(step.radius) / (state.contacts.slope * state.t)))
        if largest > _LARGEST_STEP:
            part = _LARGEST_STEP / largest
            step, change = Step(part * step.radius, part * step.load, part * step.along), part * change
        mixing.go(change)
        state, along = moved(problem, state, step, drive), along + step.along
    return state, along


def at_rest(problem: PairProblem, state: State) -> State:
    """Return asperities with their contacts in equilibrium without an outer field; the error is inf if not found."""
    few, guess = alone(problem, state)
    nothing = np.zeros_like(guess.outer)
    begin = evaluate(few, guess.inside, guess.t, guess.load, guess.separation, nothing)
    rest, _ = newton(few, begin, Drive(0.0, nothing), guess.factors)
    whole = among(problem, np.flatnonzero(state.inside), rest)
    return whole._replace(error=rest.error, factors=guess.factors)

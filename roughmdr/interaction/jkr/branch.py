"""A stable path of adhesive contacts, up to where the next contact is made or lost.

Places along a path are numbers from 0 to 1. Where radii change too fast for steps along it, that which changes fastest
is given and the place follows: a path ends in a fold where that place turns back.
"""

import math
from typing import Literal, NamedTuple

import numpy as np

from roughmdr.interaction.jkr.bracket import Bracket
from roughmdr.interaction.jkr.equilibrium import Problem, State, evaluate
from roughmdr.interaction.jkr.newton import moved, newton
from roughmdr.interaction.jkr.tangent import Drive, Factors, Step, Tangent
from roughmdr.numerics.arguments import Floats

_LARGEST_CHANGE = 0.4  # of a state in a step
_LEAD_STEP, _LEAST_LEAD_STEP, _LARGEST_LEAD_STEP = 0.1, 1e-6, 0.3  # of the state that leads
_OVERSHOOT = 1.1
_NEAR_FLAT, _FLAT_STEP = 0.01, 0.5  # a state near the edge of a flat, and steps from there
_LEAST_STATE = 1e-7  # of the natural one: the contact is at the edge of its flat
_MAX_PIECES, _MAX_ROUNDS = 2000, 40
_FOLD_RTOL = 1e-6  # of the radius at a fold, where the place changes by its square
_SLOPE_RTOL = 1e-6
_SAME = 1e-12  # of the natural depth


class Event(NamedTuple):
    """A contact that is made or lost, or that jumps."""

    kind: Literal["made", "lost", "fold"]
    asperity: int
    upwards: bool
    """Whether its radius grows."""


class NoEquilibriumError(Exception):
    """No equilibrium is found along the path."""


class Place(NamedTuple):
    """A stable state, and where it lies along the path."""

    state: State
    factors: Factors
    along: float
    leads: "Lead | None" = None
    """The radius that led to it."""


class Lead(NamedTuple):
    """A radius that changes too fast for steps along the path."""

    asperity: int
    upwards: bool
    t: float
    """State of the contact, and the slope of the place over its radius, at a place before."""
    slope: float


def advance(problem: Problem, state: State, drive: Drive) -> tuple[State, Event | None]:
    """Follow the stable path from a state to its end, or to the first event.

    NoEquilibriumError where neither is found.
    """
    here = Place(state, Factors(problem, state), 0.0)
    for _ in range(_MAX_PIECES):
        there, event = _piece(problem, here, drive)
        if event is None and problem.kernels.flat:
            event = _at_corner(there.state)
        found = _first_crossing(problem, here, there, drive)
        if found is not None:
            return found
        if event is not None or there.along >= 1.0:
            return there.state, event
        here = there
    raise NoEquilibriumError


def _at_corner(state: State) -> Event | None:
    """Return the event of a contact that has shrunk to the edge of its flat, where it is lost."""
    on = np.flatnonzero(state.inside & (state.t < _LEAST_STATE))
    return Event("fold", int(on[np.argmin(state.t[on])]), upwards=False) if on.size else None


def _at(problem: Problem, here: Place, drive: Drive, change: float, rate: Step) -> State:
    """Return the guess at a place further on, by the rate of change."""
    step = Step(change * rate.radius, change * rate.load, change)
    return moved(problem, here.state, here.factors.on, step, 1.0, drive, 0.0)[0]


def _piece(problem: Problem, here: Place, drive: Drive) -> tuple[Place, Event | None]:
    """Return a place further along the path, or the fold before it."""
    state, factors, along, leads = here
    rest = 1.0 - along
    if leads is not None:
        return _led(problem, here, drive, leads)
    if not state.inside.any():
        nothing = Step(np.zeros(0), np.zeros(0))
        return Place(_at(problem, here, drive, rest, nothing), factors, 1.0), None
    rate = Tangent(problem, state, drive, factors).rate()
    fastest = np.abs(rate.radius) / (state.contacts.slope * state.t)[factors.on]
    largest = float(fastest.max(initial=0.0))
    change = min(rest, _LARGEST_CHANGE / largest if largest > 0.0 else rest)
    new, _ = newton(problem, _at(problem, here, drive, change, rate), drive, factors)
    if there := _stable(problem, here, new, 1.0 if change == rest else along + change):
        return there, None
    lead = int(np.argmax(fastest))
    number = int(factors.on[lead])
    slope = abs(1.0 / rate.radius[lead])
    return _led(problem, here, drive, Lead(number, bool(rate.radius[lead] > 0.0), float(state.t[number]), slope))


def _stable(problem: Problem, here: Place, new: State, along: float) -> Place | None:
    """Return the place of a state that is stable and near the one before; None where it is not."""
    if not _near(here.state, new):
        return None
    factors = Factors(problem, new)
    return Place(new, factors, along) if factors.stable else None


def _near(state: State, new: State) -> bool:
    """Return whether a state is an equilibrium near another one."""
    on = state.inside
    with np.errstate(all="ignore"):
        ratio = np.abs(np.log(new.t[on] / state.t[on]))
    return math.isfinite(new.error) and bool((ratio < 2.0 * _LARGEST_CHANGE).all())


def _turning(problem: Problem, state: State, drive: Drive, factors: Factors, lead: int) -> float:
    """Return the slope of the place over the radius that leads."""
    tangent = Tangent(problem, state, drive, factors, lead)
    one = np.zeros(factors.on.size)
    one[tangent.lead] = 1.0
    edge, gap = tangent.product(Step(one, np.zeros_like(one)))
    return tangent.solve(-edge, -gap, _SLOPE_RTOL).along


def _led(problem: Problem, here: Place, drive: Drive, leads: Lead) -> tuple[Place, Event | None]:
    """Return a place further along the path, on which the radius of an asperity leads, or the fold."""
    state, factors, along, _ = here
    lead, sign = leads.asperity, 1.0 if leads.upwards else -1.0
    at = state.t[lead]
    slope = leads.slope if at == leads.t else sign * _turning(problem, state, drive, factors, lead)
    size = _LEAD_STEP
    if leads.slope > slope > 0.0:  # the fold, were the slope a straight line, and a little further
        size = min(max(_OVERSHOOT * abs(at - leads.t) / at * slope / (leads.slope - slope), size), _LARGEST_LEAD_STEP)
    elif problem.kernels.flat and at < _NEAR_FLAT:
        size = _FLAT_STEP
    while size > _LEAST_LEAD_STEP:
        t = state.t.copy()
        t[lead] *= 1.0 + sign * size
        guess = evaluate(problem, state.inside, t, state.load, state.separation, state.outer)
        new, place = newton(problem, guess, drive, factors, along, lead)
        if not _near(state, new):
            size *= 0.5
            continue
        after = sign * _turning(problem, new, drive, factors, lead)
        if after <= 0.0:
            if slope <= 0.0:
                return here._replace(leads=None), Event("fold", lead, leads.upwards)
            known = (float(at), slope), (float(new.t[lead]), after)
            return _fold(problem, here, known, drive, lead, sign), Event("fold", lead, leads.upwards)
        if place >= 1.0:
            part = (1.0 - along) / (place - along)
            guess = _between(problem, state, new, part, drive, 1.0 - along)
            if there := _stable(problem, here, newton(problem, guess, drive, factors)[0], 1.0):
                return there, None
        elif place > along:
            there = Place(new, Factors(problem, new), place)
            change = np.abs(np.log(new.t[factors.on] / state.t[factors.on]))
            same = int(factors.on[np.argmax(change)]) == lead
            return there._replace(leads=leads._replace(t=float(at), slope=slope) if same else None), None
        size *= 0.5
    raise NoEquilibriumError


def _between(problem: Problem, state: State, new: State, part: float, drive: Drive, change: float) -> State:
    """Return a guess between two states, at a place ``change`` further than the first."""
    on = state.inside
    t, load = state.t.copy(), state.load.copy()
    t[on] += part * (new.t[on] - state.t[on])
    load[on] += part * (new.load[on] - state.load[on])
    separation, outer = state.separation + drive.separation * change, state.outer + drive.outer * change
    return evaluate(problem, state.inside, t, load, separation, outer)


def _fold(
    problem: Problem,
    here: Place,
    slopes: tuple[tuple[float, float], tuple[float, float]],
    drive: Drive,
    lead: int,
    sign: float,
) -> Place:
    """Return where the place turns back, between two states of a contact with known slopes."""
    factors, best = here.factors, here
    root = Bracket(*slopes)
    for _ in range(_MAX_ROUNDS):
        state = best.state
        t = state.t.copy()
        t[lead] = root.next
        guess = evaluate(problem, state.inside, t, state.load, state.separation, state.outer)
        found, place = newton(problem, guess, drive, factors, best.along, lead)
        if not math.isfinite(found.error):
            found, place = newton(problem, guess, drive, Factors(problem, state), best.along, lead)
        if not math.isfinite(found.error):
            raise NoEquilibriumError
        shift = abs(found.t[lead] - state.t[lead])
        best = Place(found, factors, place)
        if shift < _FOLD_RTOL * found.t[lead]:
            break
        root.narrow(found.t[lead], sign * _turning(problem, found, drive, factors, lead))
    return best


def _opening(problem: Problem, state: State) -> Floats:
    """Return by how much each contact is beyond the point at which it is made or lost."""
    beyond = state.gap.copy()
    beyond[state.inside] = -math.inf
    if problem.kernels.pinned:
        on = state.inside
        release = np.sqrt(2.0 * math.pi * problem.work * state.contacts.radius[on])
        beyond[on] = state.contacts.stretch[on] - release
    return np.asarray(beyond / problem.natural)


def _first_crossing(problem: Problem, here: Place, there: Place, drive: Drive) -> tuple[State, Event] | None:
    """Return the first state between two places at which a contact is made or lost, but for folds."""
    start, end = _opening(problem, here.state), _opening(problem, there.state)
    found, new = None, there.state
    for _ in range(_MAX_ROUNDS):
        over = np.flatnonzero(end > _SAME)
        if not over.size:
            break
        due = over[start[over] >= -_SAME]
        if due.size:  # as soon as it sets out
            found, new = int(due[np.argmax(start[due])]), here.state
            break
        found = int(over[np.argmin(start[over] / (start[over] - end[over]))])
        there = _crossing(problem, here, there, drive, found)
        new = there.state
        end = _opening(problem, new)
    if found is None:
        return None
    return new, Event("lost" if new.inside[found] else "made", found, not new.inside[found])


def _crossing(problem: Problem, here: Place, there: Place, drive: Drive, asperity: int) -> Place:
    """Return the place at which an asperity crosses."""
    values = [float(_opening(problem, each.state)[asperity]) for each in (here, there)]
    root, factors = Bracket((here.along, values[0]), (there.along, values[1])), here.factors
    for _ in range(_MAX_ROUNDS):
        middle, length = root.next, there.along - here.along
        guess = _between(problem, here.state, there.state, (middle - here.along) / length, drive, middle - here.along)
        found = Place(newton(problem, guess, drive, factors)[0], factors, middle)
        if not math.isfinite(found.state.error):
            raise NoEquilibriumError
        value = float(_opening(problem, found.state)[asperity])
        root.narrow(middle, value)
        here, there = (found, there) if value < 0.0 else (here, found)
        if abs(value) <= _SAME or there.along - here.along <= 4.0 * np.spacing(1.0):
            break
    return found

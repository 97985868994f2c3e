"""A stable path of adhesive contacts, up to where the next contact is made or lost.

Places along a path are numbers from 0 to 1. Where radii change too fast for steps along it, that which changes fastest
is given and the place follows: a path ends in a fold where that place turns back.
"""

import math
from typing import Literal, NamedTuple

import numpy as np

from roughmdr.interaction.jkr.equilibrium import Drive, Problem, State, Step, Tangent, evaluate, moved, newton
from roughmdr.numerics.arguments import Floats

_LARGEST_CHANGE = 0.4  # of a radius in a step
_LEAD_STEP, _LEAST_LEAD_STEP = 0.1, 1e-6  # of the state that leads
_LEAST_STATE = 1e-7  # of the natural one: the contact is at the edge of its flat
_MAX_PIECES, _MAX_ROUNDS = 2000, 40
_FOLD_RTOL = 1e-8  # of the radius at a fold, where the place changes by its square
_SAME = 1e-12  # of the natural depth


class Event(NamedTuple):
    """A contact that is made or lost, or that jumps."""

    kind: Literal["made", "lost", "fold"]
    asperity: int
    upwards: bool
    """Whether its radius grows."""


class NoEquilibriumError(Exception):
    """No equilibrium is found along the path."""


def advance(problem: Problem, state: State, drive: Drive) -> tuple[State, Event | None]:
    """Follow the stable path from a state to its end, or to the first event.

    NoEquilibriumError where neither is found.
    """
    along = 0.0
    for _ in range(_MAX_PIECES):
        new, place, event = _piece(problem, state, drive, along)
        found = _first_crossing(problem, (state, along), (new, place), drive)
        if found is not None:
            return found
        if event is not None or place >= 1.0:
            return new, event
        state, along = new, place
    raise NoEquilibriumError


def _at(problem: Problem, state: State, drive: Drive, change: float, radius: Floats, load: Floats) -> State:
    """Return the guess at a place further on, with radii and loads changed."""
    on = np.flatnonzero(state.inside)
    return moved(problem, state, on, Step(radius, load, change), 1.0, drive, 0.0)[0]


def _piece(problem: Problem, state: State, drive: Drive, along: float) -> tuple[State, float, Event | None]:
    """Return a state further along the path with its place, or at the fold before it."""
    rest = 1.0 - along
    if not state.inside.any():
        return _at(problem, state, drive, rest, np.zeros(0), np.zeros(0)), 1.0, None
    tangent = Tangent(problem, state, drive)
    edge, gap = tangent.along()
    rate = tangent.solve(-edge, -gap)
    a = state.contacts.radius[tangent.on]
    fastest = np.abs(rate.radius) / a
    largest = float(fastest.max(initial=0.0))
    change = min(rest, _LARGEST_CHANGE / largest if largest > 0.0 else rest)
    new, _ = newton(problem, _at(problem, state, drive, change, change * rate.radius, change * rate.load), drive, 0.0)
    if math.isfinite(new.error) and _continues(problem, state, new, drive):
        return new, 1.0 if change == rest else along + change, None
    lead = int(np.argmax(fastest))
    return _led(problem, state, drive, along, int(tangent.on[lead]), rate.radius[lead] > 0.0)


def _continues(problem: Problem, state: State, new: State, drive: Drive) -> bool:
    """Return whether a state is stable and near the one before."""
    on = state.inside
    ratio = new.contacts.radius[on] / state.contacts.radius[on]
    near = bool((np.abs(np.log(ratio)) < 2.0 * _LARGEST_CHANGE).all())
    return near and Tangent(problem, new, drive).stable


def _turning(problem: Problem, state: State, drive: Drive, lead: int) -> float:
    """Return the slope of the place over the radius that leads."""
    tangent = Tangent(problem, state, drive, lead)
    one = np.zeros(tangent.on.size)
    one[tangent.lead] = 1.0
    edge, gap = tangent.product(Step(one, np.zeros_like(one)))
    return tangent.solve(-edge, -gap, 1e-9).along


def _led(
    problem: Problem, state: State, drive: Drive, along: float, lead: int, upwards: bool
) -> tuple[State, float, Event | None]:
    """Return a state further along the path, on which the radius of an asperity leads, or the fold."""
    sign = 1.0 if upwards else -1.0
    size = _LEAD_STEP
    while size > _LEAST_LEAD_STEP:
        t = state.t.copy()
        t[lead] *= 1.0 + sign * size
        guess = evaluate(problem, state.inside, t, state.load, state.separation, state.outer)
        new, place = newton(problem, guess, drive, along, lead)
        if not math.isfinite(new.error) or not _near(state, new):
            size *= 0.5
            continue
        if sign * _turning(problem, new, drive, lead) <= 0.0:
            return *_fold(problem, (state, along), (new, place), drive, lead, sign), Event("fold", lead, upwards)
        if place >= 1.0:
            part = (1.0 - along) / (place - along)
            end, _ = newton(problem, _between(problem, state, new, part, drive, 1.0 - along), drive, 0.0)
            if math.isfinite(end.error) and _continues(problem, state, end, drive):
                return end, 1.0, None
            size *= 0.5
            continue
        if place > along:
            if problem.kernels.flat and new.t[lead] < _LEAST_STATE:
                return new, place, Event("fold", lead, upwards)
            return new, place, None
        size *= 0.5
    raise NoEquilibriumError


def _near(state: State, new: State) -> bool:
    on = state.inside
    return bool((np.abs(np.log(new.contacts.radius[on] / state.contacts.radius[on])) < 2.0 * _LARGEST_CHANGE).all())


def _between(problem: Problem, state: State, new: State, part: float, drive: Drive, change: float) -> State:
    """Return a guess between two states, at a place ``change`` further than the first."""
    on = state.inside
    t, load = state.t.copy(), state.load.copy()
    t[on] += part * (new.t[on] - state.t[on])
    load[on] += part * (new.load[on] - state.load[on])
    separation, outer = state.separation + drive.separation * change, state.outer + drive.outer * change
    return evaluate(problem, state.inside, t, load, separation, outer)


def _fold(
    problem: Problem, before: tuple[State, float], after: tuple[State, float], drive: Drive, lead: int, sign: float
) -> tuple[State, float]:
    """Return the state and the place at which the place turns back, between two states, by regula falsi."""
    (state, along), (new, place) = before, after
    low, high = state.t[lead], new.t[lead]
    slope_low, slope_high = (sign * _turning(problem, each, drive, lead) for each in (state, new))
    if slope_low <= 0.0:
        return state, along
    best, at = new, place
    nearest, nearest_at = state, along
    for _ in range(_MAX_ROUNDS):
        part = slope_low / (slope_low - slope_high)
        middle = low + min(max(part, 0.01), 0.99) * (high - low)
        t = nearest.t.copy()
        t[lead] = middle
        guess = evaluate(problem, state.inside, t, nearest.load, nearest.separation, nearest.outer)
        best, at = newton(problem, guess, drive, nearest_at, lead)
        if not math.isfinite(best.error):
            raise NoEquilibriumError
        slope = sign * _turning(problem, best, drive, lead)
        nearest, nearest_at = best, at
        shift = abs(middle - (low if slope > 0.0 else high)) / middle
        if slope > 0.0:
            low, slope_low, slope_high = middle, slope, 0.5 * slope_high
        else:
            high, slope_high, slope_low = middle, slope, 0.5 * slope_low
        if slope == 0.0 or shift < _FOLD_RTOL or abs(high - low) < _FOLD_RTOL * middle:
            break
    return best, at


def _opening(problem: Problem, state: State) -> Floats:
    """Return by how much each contact is beyond the point at which it is made or lost."""
    beyond = state.gap.copy()
    beyond[state.inside] = -math.inf
    if problem.kernels.pinned:
        on = state.inside
        release = np.sqrt(2.0 * math.pi * problem.work * state.contacts.radius[on])
        beyond[on] = state.contacts.stretch[on] - release
    return np.asarray(beyond / problem.natural)


def _first_crossing(
    problem: Problem, before: tuple[State, float], after: tuple[State, float], drive: Drive
) -> tuple[State, Event] | None:
    """Return the first state between two at which a contact is made or lost, but for folds."""
    (state, along), (new, place) = before, after
    start, end = _opening(problem, state), _opening(problem, new)
    found: int | None = None
    for _ in range(_MAX_ROUNDS):
        if not (end > _SAME).any():
            break
        over = np.flatnonzero(end > _SAME)
        due = over[start[over] >= -_SAME]
        if due.size:  # as soon as it sets out
            found, new = int(due[np.argmax(start[due])]), state
            break
        part = start[over] / (start[over] - end[over])
        found = int(over[np.argmin(part)])
        new, place = _crossing(problem, (state, along), (new, place), drive, found)
        end = _opening(problem, new)
    if found is None:
        return None
    return new, Event("lost" if new.inside[found] else "made", found, not new.inside[found])


def _crossing(
    problem: Problem, before: tuple[State, float], after: tuple[State, float], drive: Drive, asperity: int
) -> tuple[State, float]:
    """Return the state at which an asperity crosses, by regula falsi."""
    (state, along), (new, place) = before, after
    low, high = along, place
    value_low, value_high = _opening(problem, state)[asperity], _opening(problem, new)[asperity]
    other, base, base_at, middle = new, state, along, place
    for _ in range(_MAX_ROUNDS):
        part = value_low / (value_low - value_high)
        middle = low + part * (high - low)
        weight = (middle - base_at) / (place - base_at) if place > base_at else 0.0
        guess = _between(problem, base, new, weight, drive, middle - base_at)
        other, _ = newton(problem, guess, drive, 0.0)
        if not math.isfinite(other.error):
            raise NoEquilibriumError
        value = _opening(problem, other)[asperity]
        if abs(value) <= _SAME or high - low <= 4.0 * np.spacing(1.0):
            break
        if value < 0.0:
            low, value_low, value_high = middle, value, 0.5 * value_high
            base, base_at = other, middle
        else:
            high, value_high, value_low = middle, value, 0.5 * value_low
            new, place = other, middle
    return other, middle

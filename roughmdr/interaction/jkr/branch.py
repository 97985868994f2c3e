"""A stable path of adhesive contacts, up to a fold.

Places along a path are numbers from 0 to 1. Where radii change too fast for steps along it, that which changes fastest
is given and the place follows: a path ends in a fold where that place turns back.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from roughmdr.interaction.jkr.bracket import Bracket
from roughmdr.interaction.jkr.equilibrium import Drive, PairProblem, State, Step, interpolated, moved
from roughmdr.interaction.jkr.factors import Factors, Lead
from roughmdr.interaction.jkr.newton import newton
from roughmdr.interaction.jkr.tangent import Tangent, leading
from roughmdr.numerics.arguments import Floats

_LARGEST_CHANGE = 0.2  # largest relative change of a state in one continuation step
_NEAR = 0.8  # change of the logarithm of a state on one path
_LEAD_STEP, _LEAST_LEAD_STEP, _LARGEST_LEAD_STEP = 0.1, 1e-6, 0.3  # relative steps of the leading state
_OVERSHOOT = 1.1
_NEAR_FLAT, _FLAT_STEP = 0.01, 0.5  # a state near the edge of a flat, and steps from there
LEAST_STATE = 1e-7  # state over the natural one, below which the contact is at the edge of its flat
_MAX_ROUNDS = 200
_ROUGH = 1e-8  # error of states on the way, over the natural depth
_KINK = 1e-9  # relative distance of two states between which the slope before a fold jumps
_FOLD_RTOL = 1e-6  # slope before a fold, relative, below which the position changes by its square
_SLOPE_RTOL = 1e-5
_AT_FOLD = 1e-6  # distance to a fold, over the path, within which the stable state may not be found
_SIGN_RTOL = 1e-2


class NoEquilibriumError(Exception):
    """No equilibrium is found along the path."""


class Place(NamedTuple):
    """A stable state, and where it lies along the path."""

    state: State
    factors: Factors
    along: float
    leads: "Fast | None" = None
    """The radius that led to it."""


class Fast(NamedTuple):
    """A radius that changes too fast for steps along the path."""

    asperity: int
    upwards: bool
    t: float
    """State of the contact, and the slope of the place over its radius, at a place before."""
    slope: float


class Fold(NamedTuple):
    """A contact that jumps, as the path has no stable state further on."""

    asperity: int
    upwards: bool
    """Whether its radius grows."""


def piece(problem: PairProblem, here: Place, drive: Drive) -> tuple[Place, Fold | None]:
    """Return a place further along the path, or the fold before it; all asperities are in contact.

    NoEquilibriumError where neither is found.
    """
    state, factors, along, leads = here
    rest = 1.0 - along
    if not state.t.size:
        nothing = Step(np.zeros(0), np.zeros(0), rest)
        return Place(moved(problem, state, nothing, drive), factors, 1.0), None
    if leads is not None:
        return _led(problem, here, drive, leads)
    tangent = Tangent(problem, state, drive)
    edge, gap = tangent.along()
    rate = factors.solve(-edge, -gap)
    if float(_speeds(state, rate).max()) * rest <= _LARGEST_CHANGE:
        new, _ = newton(problem, _further(problem, here, rate, rest, drive), drive, factors)
        if there := _stable(problem, here, new, 1.0):
            corner = _at_corner(new) if problem.kernels.flat else None
            return there, corner
    whole = tangent.solve(-edge, -gap, factors, _SIGN_RTOL)  # near a fold another contact may be the fastest with it
    rate = whole if np.isfinite(whole.radius).all() else rate
    lead = int(np.argmax(_speeds(state, rate)))
    slope = abs(1.0 / rate.radius[lead])
    return _led(problem, here, drive, Fast(lead, bool(rate.radius[lead] > 0.0), float(state.t[lead]), slope))


def _speeds(state: State, rate: Step) -> Floats:
    """Return the relative changes of the states of contacts along the path."""
    return np.asarray(np.abs(rate.radius) / (state.contacts.slope * state.t))


def _further(problem: PairProblem, here: Place, rate: Step, change: float, drive: Drive) -> State:
    """Return the guess at a place further on, by the rate of change."""
    return moved(problem, here.state, Step(change * rate.radius, change * rate.load, change), drive)


def _to(problem: PairProblem, here: Place, lead: Lead, t: float, drive: Drive) -> tuple[State, float]:
    """Return the guess where the contact that leads has a state, and its place."""
    state, number, rate = here.state, lead.asperity, lead.by_place
    change = (t - state.t[number]) * state.contacts.slope[number] / rate.radius[number]
    return _further(problem, here, rate, float(change), drive), here.along + float(change)


def _at_corner(state: State) -> Fold | None:
    """Return the contact that has shrunk to the edge of its flat, where it is lost."""
    least = int(np.argmin(state.t))
    return Fold(least, upwards=False) if state.t[least] < LEAST_STATE else None


def _stable(problem: PairProblem, here: Place, new: State, along: float) -> Place | None:
    """Return the place of a state that is stable and near the one before; None where it is not."""
    if not is_near(here.state, new):
        return None
    factors = Factors(problem, new)
    return None if factors.unstable or not _yields(problem, new, factors) else Place(new, factors, along)


def _yields(problem: PairProblem, state: State, factors: Factors) -> bool:
    """Return whether the contact of the least stable mode gives way to a force on its edge, with the whole tangent."""
    if factors.pinned:
        return True
    edge, least = np.zeros_like(state.t), factors.least_stable()
    edge[least] = 1.0
    tangent = Tangent(problem, state, Drive(0.0, np.zeros_like(state.outer)))
    return bool(tangent.solve(edge, np.zeros_like(edge), factors, _SIGN_RTOL).radius[least] > 0.0)


def is_near(state: State, new: State) -> bool:
    """Return whether a state is an equilibrium near another one."""
    with np.errstate(all="ignore"):
        ratio = np.abs(np.log(new.t / state.t))
    return math.isfinite(new.error) and bool((ratio < _NEAR).all())


def _led(problem: PairProblem, here: Place, drive: Drive, fast: Fast) -> tuple[Place, Fold | None]:
    """Return a place further along the path, on which the radius of an asperity leads, or the fold."""
    state, factors, along, _ = here
    number, sign = fast.asperity, 1.0 if fast.upwards else -1.0
    lead = leading(problem, state, drive, factors, number)
    at = state.t[number]

    def turning(state: State, factors: Factors) -> float | None:
        """Return the slope of the place over the radius that leads; None where the others are not stable."""
        lead = leading(problem, state, drive, factors, number)
        if factors.unstable != (0 if sign * lead.by_place.radius[number] > 0.0 else 1):
            return None
        return sign * Tangent(problem, state, drive).rate(factors, _SLOPE_RTOL, lead).along

    slope = fast.slope if at == fast.t else turning(state, factors) or 0.0
    size = _lead_step(problem, fast, float(at), slope)
    while size > _LEAST_LEAD_STEP:
        guess, place = _to(problem, here, lead, at * (1.0 + sign * size), drive)
        new, place = newton(problem, guess, drive, factors, place, lead, _ROUGH)
        size, near = 0.5 * size, is_near(state, new)
        own = Factors(problem, new) if near else factors
        after = turning(new, own) if near else None
        if after is None:
            if near and here.leads is not None:  # another radius may lead
                break
            continue
        if after <= 0.0:
            fold = Fold(number, fast.upwards)
            if slope <= 0.0:
                return here._replace(leads=None), fold
            root = Bracket((at, slope), (float(new.t[number]), after))
            end = _fold(problem, Place(new, own, place), root, drive, number, turning)
            if end and (found := _to_fold(problem, here, end, drive, fold)):
                return found
        elif place >= 1.0:
            if there := _at_end(problem, here, Place(new, factors, place), drive):
                return there, None
        elif place > along:
            there = Place(new, own, place)
            if problem.kernels.flat and (corner := _at_corner(new)):
                return there, corner
            same = int(np.argmax(np.abs(np.log(new.t / state.t)))) == number
            return there._replace(leads=fast._replace(t=float(at), slope=slope) if same else None), None
    if here.leads is None:
        raise NoEquilibriumError
    return here._replace(leads=None), None


def _to_fold(
    problem: PairProblem, here: Place, end: Place, drive: Drive, fold: Fold
) -> tuple[Place, Fold | None] | None:
    """Return the fold at ``end`` or, if the path ends before it, the end of the path; None where that is not found."""
    if end.along > 1.0 and (there := _at_end(problem, here, end, drive, fold=True)):
        return there, None
    return (end, fold) if end.along <= 1.0 + _AT_FOLD else None


def _at_end(problem: PairProblem, here: Place, beyond: Place, drive: Drive, *, fold: bool = False) -> Place | None:
    """Return the end of the path, between two places, the second of which may be a fold; None where it is not found."""
    part = (1.0 - here.along) / (beyond.along - here.along)
    guess = between(problem, here, beyond, 1.0, drive, 1.0 - math.sqrt(1.0 - part) if fold else part)
    return _stable(problem, here, newton(problem, guess, drive, here.factors)[0], 1.0)


def _lead_step(problem: PairProblem, fast: Fast, t: float, slope: float) -> float:
    """Return the first step of the radius that leads, over its state."""
    if fast.slope > slope > 0.0:  # the fold, were the slope a straight line, and a little further
        to_fold = abs(t - fast.t) / t * slope / (fast.slope - slope)
        return min(max(_OVERSHOOT * to_fold, _LEAD_STEP), _LARGEST_LEAD_STEP)
    return _FLAT_STEP if problem.kernels.flat and t < _NEAR_FLAT else _LEAD_STEP


def between(
    problem: PairProblem, here: Place, there: Place, along: float, drive: Drive, part: float | None = None
) -> State:
    """Return the guess at a place between two others or near them, a ``part`` of the way, else in proportion."""
    state, new, change = here.state, there.state, along - here.along
    part = change / (there.along - here.along) if part is None else part
    separation, outer = state.separation + drive.separation * change, state.outer + drive.outer * change
    return interpolated(problem, state, new, part, separation, outer)


def _fold(
    problem: PairProblem,
    best: Place,
    root: Bracket,
    drive: Drive,
    number: int,
    turning: Callable[[State, Factors], float | None],
) -> Place | None:
    """Return where the place turns back, from a place near it; None where that is not the first fold."""
    still = _FOLD_RTOL * root.scale
    for _ in range(_MAX_ROUNDS):
        lead = leading(problem, best.state, drive, best.factors, number)
        guess, place = _to(problem, best, lead, root.next, drive)
        found, place = newton(problem, guess, drive, best.factors, place, lead, _ROUGH)
        if not math.isfinite(found.error):
            return None
        own = Factors(problem, found)
        slope = turning(found, own)
        if slope is None:
            return None
        best = Place(found, own, place)
        if abs(slope) <= still or root.width <= _KINK * found.t[number]:
            found, place = newton(problem, found, drive, own, place, leading(problem, found, drive, own, number))
            return best._replace(state=found, along=place) if math.isfinite(found.error) else None
        root.narrow(found.t[number], slope)
    return None

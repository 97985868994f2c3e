"""The separations of a flat on a machine that is pressed against adhesive contacts which feel each other.

On each leg the stable path under fixed grips is followed, from one avalanche to the next, to the first separation at
which the demand w h - c F (``loading.machine``) has passed that of the machine. Between two avalanches the demand is
smooth: on the way down it falls, on the way up it may have a peak, where the stiffness of the contacts is minus that of
the machine. Where it turns back, the flat jumps to where it passes again.
"""

import math

import numpy as np

from roughmdr.ensemble.ensemble import Ensemble
from roughmdr.errors import OutOfRange
from roughmdr.interaction.jkr.bracket import Bracket
from roughmdr.interaction.jkr.branch import NoEquilibriumError
from roughmdr.interaction.jkr.equilibrium import State, alone
from roughmdr.interaction.jkr.followed import Followed
from roughmdr.interaction.jkr.tension import slope
from roughmdr.interaction.settings import Interaction
from roughmdr.loading.machine import Jump, Leg, Machine, legs_of
from roughmdr.numerics.arguments import Floats

_STEP = 0.5  # of the natural depth, at most from one state to the next
_BESIDE = 1e-11  # of it: on either side of an avalanche
_FURTHER = 4.0  # times that, where an avalanche comes on the other side
_RTOL = 1e-13  # of it: a shorter step of Newton's method is the last
_MAX_ROUNDS, _MAX_STATES = 60, 1_000_000
_PARTS = (1.0, 0.1, 0.01, 1e-3, 1e-4)  # of such a step, where no state is found
_SETTLED = 1e-12  # of the natural depth: error of the lowest separation
_LOWER, _MAX_FAILURES = 2.0, 3  # times as far below the highest summit, where no equilibrium is found; and how often


def separations_of(
    ensemble: Ensemble,
    machine: Machine,
    demand: Floats,
    material: tuple[float, float],
    interaction: Interaction,
    lowest: float,
) -> tuple[Floats, list[Jump]]:
    """Return the separation [m] at each demand of a machine, inf where it has pulled the flat off, and its jumps.

    ``material`` is E* [Pa] and w [J/m2]; ``lowest`` [m] is about the lowest separation. How pairs that overlap are
    taken depends on that, so that it is sought with them. OutOfRange where no equilibrium is found, or the contact of
    an asperity is not representable.
    """
    top, failures = float(ensemble.height.max()), 0
    followed = Followed(ensemble, *material, interaction, lowest)
    for _ in range(_MAX_ROUNDS):
        pairs, natural = followed.problem.pairs, float(followed.problem.natural.max()) * followed.placed.length
        try:
            separation, jumps = _Flat(followed, machine, material[0]).follow(demand)
            found = min(float(separation.min()), top)
        except NoEquilibriumError:
            failures += 1
            if failures > _MAX_FAILURES:
                break
            lowest = top - _LOWER * max(top - lowest, natural)
            followed = Followed(ensemble, *material, interaction, lowest)
            continue
        followed = Followed(ensemble, *material, interaction, found)
        now = followed.problem.pairs
        same = np.array_equal(pairs.members, now.members) and np.array_equal(pairs.share, now.share)
        if same or abs(found - lowest) <= _SETTLED * natural:
            return separation, jumps
        lowest = found
    raise OutOfRange("path: the contacts have no equilibrium on the way of this machine")


class _Flat:
    """A flat on its machine."""

    def __init__(self, followed: Followed, machine: Machine, modulus: float) -> None:
        self._followed, self._machine = followed, machine
        self._length = followed.placed.length
        self._unit = math.pi * modulus * self._length**2
        self._natural = float(followed.problem.natural.max())

    def follow(self, demand: Floats) -> tuple[Floats, list[Jump]]:
        """Return the separation [m] at each demand, and the jumps."""
        separation, jumps = np.empty(demand.size), list[Jump]()
        state: State | None = None  # none where the flat is far away
        for leg in legs_of(demand):
            for number, target in enumerate(leg.demand.tolist()):
                step = leg.first + number
                state = self._next(state, leg, target, step, jumps)
                separation[step] = self._place(state, target)
        return separation, jumps

    def _place(self, state: State | None, target: float) -> float:
        """Return the separation [m] of the flat; without contacts that of the far end, or inf under a dead load."""
        if state is None:
            return math.inf if self._machine.is_dead_load else target
        return state.separation * self._length

    def _next(self, state: State | None, leg: Leg, target: float, step: int, jumps: list[Jump]) -> State | None:
        """Return the state at a demand; none where there is no contact."""
        if state is None:
            state = self._arrival(leg, target, step, jumps)
            if state is None:
                return None
        return self._rise(state, target, step, jumps) if leg.rises else self._sink(state, target, step, jumps)

    def _arrival(self, leg: Leg, target: float, step: int, jumps: list[Jump]) -> State | None:
        """Return the state just above first touch, if the machine brings the flat there; below it, if that pulls."""
        state = self._followed.begin(-math.inf)
        touch = float(self._followed.problem.asperities.height.max())
        state, _, _ = self._followed.to(state, touch + _BESIDE * self._natural)
        away = target > 0.0 if self._machine.is_dead_load else target > touch * self._length
        if away or leg.rises:
            return None
        if self._demand(state) <= target:
            pulled = self._beyond(touch, state, -1.0)
            if self._demand(pulled) > target:
                after = self._sink(pulled, target, step, None)
                self._note(jumps, step, target, state, after)
                return after
        return state

    def _demand(self, state: State) -> float:
        """Return the demand of the machine [m] or [N]."""
        force = self._unit * math.fsum(state.load.tolist())
        return self._machine.weight * state.separation * self._length - self._machine.compliance * force

    def _slope(self, state: State) -> float:
        """Return by how much it grows with the separation."""
        stiffness = -slope(*alone(self._followed.problem, state)) * self._unit / self._length
        return (self._machine.weight + self._machine.compliance * stiffness) * self._length

    def _smooth(self, state: State, h: float) -> tuple[State, float | None]:
        """Return the state at h, or just before the first avalanche on the way, and the place of that."""
        for part in _PARTS:
            try:
                new, found, _ = self._followed.to(state, state.separation + part * (h - state.separation))
                break
            except NoEquilibriumError:  # beyond what is looked for there may be none
                if part == _PARTS[-1]:
                    raise
        if not found:
            return new, None
        event, side = found[0].separation, math.copysign(_BESIDE * self._natural, h - state.separation)
        while (event - side - state.separation) * side > 0.0:
            before, found, _ = self._followed.to(state, event - side)
            if not found:
                return before, event
            side *= _FURTHER  # a fold is met a little earlier on a shorter way
        return state, event

    def _beyond(self, event: float, end: State, side: float) -> State:
        """Return the state just after an avalanche that comes after ``end``, upwards where ``side`` is 1, else -1."""
        way = side * _BESIDE * self._natural
        for _ in range(_MAX_ROUNDS):
            beyond, found, _ = self._followed.to(end, event + way)
            if found:
                return beyond
            way *= _FURTHER
        raise NoEquilibriumError

    def _sink(self, state: State, target: float, step: int, jumps: list[Jump] | None) -> State:
        """Return the first state further down at which the demand is ``target``."""
        for _ in range(_MAX_STATES):
            here = self._demand(state)
            if here <= target:
                return state
            end, event = self._smooth(state, state.separation - _STEP * self._natural)
            there = self._demand(end)
            if there <= target:
                return self._root(end, state, target)
            state = end
            if event is not None:
                state = self._beyond(event, end, -1.0)
                if self._demand(state) > there:
                    after = self._sink(state, there, step, None)
                    self._note(jumps, step, there, end, after)
                    state = after
        raise NoEquilibriumError

    def _rise(self, state: State, target: float, step: int, jumps: list[Jump] | None) -> State | None:
        """Return the first state further up at which the demand is ``target``; none where there is no contact."""
        for _ in range(_MAX_STATES):
            if not state.inside.any():
                return None
            if self._demand(state) >= target:
                return state
            end, event = self._smooth(state, state.separation + _STEP * self._natural)
            peak = self._peak(state, end)
            top = self._demand(peak)
            if top >= target:
                return self._root(state, peak, target)
            beyond = end if event is None else self._beyond(event, end, 1.0)
            if self._demand(beyond) >= top:
                state = beyond
                continue
            after = self._rise(beyond, top, step, None)
            self._note(jumps, step, top, peak, after)
            if after is None:
                return None
            state = after
        raise NoEquilibriumError

    def _note(self, jumps: list[Jump] | None, step: int, demand: float, before: State, after: State | None) -> None:
        """Record a jump, but for those within another."""
        if jumps is not None:
            jumps.append(Jump(step, demand, before.separation * self._length, self._place(after, demand)))

    def _peak(self, low: State, high: State) -> State:
        """Return the state of the largest demand between two, of which the slope falls."""
        if not low.separation < high.separation:
            return high
        rising = self._slope(low)

        def slope_at(state: State) -> float:
            """Return the slope; next to a fold, where none is found, a negative one."""
            found = self._slope(state)
            return found if math.isfinite(found) else -abs(rising)

        falling = slope_at(high)
        if falling >= 0.0 or not rising > 0.0:
            return high if falling >= 0.0 else low
        # The slope falls like the inverse root of the distance to a fold: it is sought in that root.
        end = high.separation + _BESIDE * self._natural
        width = math.sqrt(end - low.separation), math.sqrt(end - high.separation)
        root = Bracket((width[0], rising * width[0]), (width[1], falling * width[1]))
        best = low
        for _ in range(_MAX_ROUNDS):
            at = root.next
            best = self._followed.to(low, end - at * at)[0]
            value = slope_at(best) * at
            root.narrow(at, value)
            if value == 0.0 or root.width * at <= 0.25 * _BESIDE * self._natural:
                break
        return best

    def _root(self, low: State, high: State, target: float) -> State:
        """Return the state with a demand, from the lower of two states on; the demand rises between them."""
        at, left, right = low, low.separation, high.separation
        for _ in range(_MAX_ROUNDS):
            rise = self._slope(at)
            h = at.separation + (target - self._demand(at)) / rise if rise > 0.0 else math.nan
            if abs(h - at.separation) <= max(_RTOL * self._natural, 2.0 * float(np.spacing(abs(at.separation)))):
                break
            if not left < h < right:
                h = 0.5 * (left + right)
                if not left < h < right:
                    break
            at = self._followed.to(at, h)[0]
            left, right = (h, right) if self._demand(at) <= target else (left, h)
        return at

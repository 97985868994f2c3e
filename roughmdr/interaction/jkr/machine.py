"""Adhesive contacts that feel each other, under a flat on a machine (``loading.machine``).

On each leg the flat is followed under fixed grips, piece by piece between the events at which contacts are made or
lost, to the first separation at which its demand has passed that of the machine.
"""

import math
from typing import NamedTuple

from roughmdr.ensemble.ensemble import Ensemble
from roughmdr.interaction.jkr.account import Account, Adhering
from roughmdr.interaction.jkr.branch import NoEquilibriumError
from roughmdr.interaction.jkr.equilibrium import State, energy
from roughmdr.interaction.jkr.front import Front, Piece
from roughmdr.interaction.jkr.section import Climb, Met, Section
from roughmdr.interaction.settings import Interaction
from roughmdr.loading.machine import DEAD_LOAD, Leg, Machine, MachinePath, legs_of
from roughmdr.numerics.underway import each_step

_LONGEST, _SHORTEST = 0.5, 1e-4  # way of the flat at a time, over the natural depth or its depth below first touch
_OVERSHOOT = 1.2  # step over the distance to where the demand would be met by the slope
_SHORTER, _MAX_SHORTER = 0.1, 4
_MAX_WAYS = 100_000


class _Stop(NamedTuple):
    """A state at which the demand is passed, or has its peak."""

    state: State
    beyond: State | None
    """At a peak the state after it, from where the demand has to grow again."""
    dissipated: float
    """By avalanches up to the state [J]."""


class Hanging:
    """The flat on a machine, which is in units of the patch, that of its demand being ``unit`` [m] or [N]."""

    def __init__(
        self, front: Front, account: Account, machine: Machine, unit: float, clear: float, *, lossy: bool
    ) -> None:
        self._front, self._account, self._machine, self._unit, self._lossy = front, account, machine, unit, lossy
        self._clear = clear
        self._state, self._flown = front.parted(front.top), True
        self._slope = 0.0

    def follow(self, leg: Leg) -> None:
        """Follow a leg, with its demand in SI, and account for its steps."""
        climb, last = Climb(self._machine, 1.0 if leg.rises else -1.0), math.nan
        for demand in each_step(leg.demand.tolist()):
            if demand != last:
                self._go(climb, climb.sign * demand / self._unit)
            last = demand
            self._account.stand(self._state, self._place(demand), rises=leg.rises)

    def _place(self, demand: float) -> float:
        """Return the separation [m] of the flat at a demand; without contacts that of the far end of the spring."""
        if self._flown:
            return math.inf
        if not self._machine.is_dead_load and not self._state.inside.any():
            return demand
        return self._state.separation * self._front.length

    def _go(self, climb: Climb, level: float) -> None:
        """Go to where the demand is first ``level``."""
        dead_load, rises = self._machine.is_dead_load, climb.sign > 0.0
        if self._state.inside.any():
            if climb.value(self._state) >= level:
                return
        elif rises or (-level > 0.0 if dead_load else -level > self._front.top):
            self._hold(climb, level)
            return
        else:
            self._state, self._flown = self._front.parted(self._front.top), False
        self._climb(climb, level)

    def _hold(self, climb: Climb, level: float) -> None:
        """Hold the flat without contacts where the machine has it."""
        if not self._machine.is_dead_load:
            self._state, self._flown = self._front.parted(climb.sign * level), False
        elif level > 0.0 or climb.sign < 0.0:
            self._state, self._flown = self._front.parted(max(self._clear, self._state.separation)), True

    def _climb(self, climb: Climb, level: float) -> None:
        """Go from contact, or from first touch, to where the demand is first ``level``."""
        while True:
            stop = self._walk(climb, self._state, level, peaks=self._lossy)
            self._state = stop.state
            if stop.beyond is None:
                return
            peak = climb.value(stop.state)
            end = self._walk(climb, stop.beyond, peak, peaks=False)
            self._account.machine_dissipated += self._loss(stop, end, climb.sign * peak)
            self._state = end.state
            if peak >= level:
                return
            if climb.sign > 0.0 and not self._state.inside.any():
                self._hold(climb, level)
                return

    def _loss(self, begin: _Stop, end: _Stop, demand: float) -> float:
        """Return the energy [J] that the machine loses in a jump at a demand."""
        problem = self._front.problem
        energies = [
            energy(problem, each.state) + math.pi * self._machine.energy(each.state.separation, demand)
            for each in (begin, end)
        ]
        return (energies[0] - energies[1]) * self._account.energy_unit - (end.dissipated - begin.dissipated)

    def _walk(self, climb: Climb, state: State, level: float, *, peaks: bool) -> _Stop:
        """Go from a state with a lower demand to where that is ``level``, or to a peak of it if they are asked for."""
        for _ in range(_MAX_WAYS):
            if climb.sign > 0.0 and not state.inside.any():
                self._state = state
                self._hold(climb, level)
                return self._stop(self._state)
            begin = state
            state, pieces = self._advanced(climb, state, self._way(climb, state, level))
            for piece in pieces:
                if stop := self._on_piece(climb, piece, level, peaks=peaks):
                    return stop
                if climb.sign > 0.0 and not piece.rest.inside.any():
                    state = self._front.parted(piece.rest.separation)
                    break
            if not any(piece.event for piece in pieces):
                change = climb.value(state) - climb.value(begin)
                self._slope = change / abs(state.separation - begin.separation)
        raise NoEquilibriumError

    def _advanced(self, climb: Climb, state: State, way: float) -> tuple[State, list[Piece]]:
        """Go so far, or less where there is no equilibrium further on."""
        for _ in range(_MAX_SHORTER):
            try:
                return self._front.go(state, state.separation + climb.sign * way)
            except NoEquilibriumError:
                way *= _SHORTER
        return self._front.go(state, state.separation + climb.sign * way)

    def _way(self, climb: Climb, state: State, level: float) -> float:
        """Return how far to go next."""
        depth = self._front.deepest
        longest = _LONGEST * max(depth, self._front.top - state.separation)
        if not (self._slope > 0.0 and state.inside.any()):
            return longest
        to_level = _OVERSHOOT * (level - climb.value(state)) / self._slope
        return min(max(to_level, _SHORTEST * depth), longest)

    def _on_piece(self, climb: Climb, piece: Piece, level: float, *, peaks: bool) -> _Stop | None:
        """Return where the demand is passed on a piece or by the avalanche at its end, or its peak; None if neither."""
        met: Met | None = None
        if piece.begin.inside.any():
            met = Section(piece, climb).meet(level, peaks=peaks)
        if met is not None and met.passed:
            self._slope = met.slope
            self._account.pass_over(piece._replace(end=met.state, event=None, avalanche=None, rest=met.state))
            return self._stop(self._front.whole(piece.kept, met.state))
        before = self._account.dissipated
        self._account.pass_over(piece)
        end, rest = climb.value(piece.end), climb.value(piece.rest)
        peak = met.state if met is not None else piece.end if peaks and rest < end else None
        if piece.event is not None:
            self._slope = 0.0
        if peak is not None:
            kept, whole = piece.kept, self._front.whole
            return _Stop(whole(kept, peak), whole(kept, piece.rest), before)
        if piece.event is not None and piece.rest.inside.any() and rest >= level:
            return self._stop(self._front.whole(piece.kept, piece.rest))
        return None

    def _stop(self, state: State) -> _Stop:
        return _Stop(state, None, self._account.dissipated)


def solve_on_machine(
    ensemble: Ensemble,
    path: MachinePath,
    effective_modulus: float,
    work: float,
    interaction: Interaction,
    names: set[str],
    clear: float,
    reach: float = 0.0,
) -> Adhering:
    """Return adhesive contacts at the demands of a machine, whose flat comes from infinity; w [J/m2].

    A flat that a dead load pulls off is followed up to ``clear`` [m], or to where its last contact parts. Otherwise as
    ``path.Descent``.
    """
    legs, front = legs_of(path.demand), Front(ensemble, effective_modulus, work, interaction)
    account = Account(front, names, rises=any(leg.rises for leg in legs), reach=reach)
    machine, unit = path.machine, front.length
    if machine.is_dead_load:
        machine, unit = DEAD_LOAD, front.force_unit
    else:
        machine = Machine(1.0, machine.compliance * front.force_unit / front.length)
    lossy = not {"dissipated_energy", "machine_dissipated_energy"}.isdisjoint(names)
    flat = Hanging(front, account, machine, unit, clear / front.length, lossy=lossy)
    try:
        for leg in legs:
            flat.follow(leg)
    except NoEquilibriumError:
        account.lose_rest(path.demand.size)
    return account.result()

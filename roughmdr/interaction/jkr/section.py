"""A smooth piece of the way of the flat, and where on it the demand of a machine is passed or turns back.

Along the way the demand changes by w + c k (``loading.machine``), where k goes to minus infinity at a fold. Near one
the contacts change with the root of the distance to it, so places on a piece are numbers u from 0 to 1: the way to one
is proportional to u, or to 1 - (1 - u)^2 where the piece ends in a fold.
"""

import math
from typing import NamedTuple

import numpy as np

from roughmdr.interaction.jkr.bracket import Bracket
from roughmdr.interaction.jkr.branch import LEAST_STATE, NoEquilibriumError, is_near
from roughmdr.interaction.jkr.equilibrium import Drive, State, alone, among, interpolated
from roughmdr.interaction.jkr.events import advance
from roughmdr.interaction.jkr.factors import Factors
from roughmdr.interaction.jkr.front import Piece
from roughmdr.interaction.jkr.newton import newton
from roughmdr.interaction.jkr.tension import slope
from roughmdr.loading.machine import Machine

_MAX_ROUNDS = 100
_RTOL = 1e-13  # length of the last step, over the natural depth
_PEAK_RTOL = 1e-8  # slope at a peak, relative; the value there is off by its square
_BEYOND = 2.0  # largest growth of the demand, over that by its slope at the beginning


class Climb(NamedTuple):
    """A machine on a leg: the demand, with the sign by which it grows."""

    machine: Machine
    """In units of the patch."""
    sign: float
    """1 where it withdraws, -1 where it approaches."""

    def value(self, state: State) -> float:
        """Return the demand of a state."""
        weight, compliance = self.machine
        return self.sign * (weight * state.separation - compliance * math.fsum(state.load.tolist()))


class Met(NamedTuple):
    """A state on a piece at which the demand is passed, or has its peak."""

    state: State
    passed: bool
    slope: float
    """By which the demand grows along the way."""


class Section:
    """A piece with contacts, alone without the asperities near them."""

    def __init__(self, piece: Piece, climb: Climb) -> None:
        self._piece, self._climb = piece, climb
        self._few, begin = alone(piece.problem, piece.begin)
        self._factors = Factors(self._few, begin)
        self._known = {0.0: begin, 1.0: alone(piece.problem, piece.end)[1]}
        self._width = abs(piece.end.separation - piece.begin.separation)
        event = piece.event
        self._fold = event is not None and event.kind == "fold"
        if event is not None and self._few.kernels.flat and piece.end.t[event.asperity] < LEAST_STATE:
            self._fold = False  # at the edge of a flat
        self._tolerance = _RTOL * float(self._few.natural.max())

    def meet(self, level: float, *, peaks: bool) -> Met | None:
        """Return where the demand is first ``level``; or, if ``peaks`` are asked for too, its peak within before that.

        None where there is neither. At the beginning the demand is below, but for rounding.
        """
        if self._width == 0.0:
            return None
        if self._value(0.0) >= level:
            return self._passed(0.0)
        if self._value(1.0) >= level:
            return self._root(0.0, 1.0, level)
        begin = self._slope(0.0)
        if begin <= 0.0:
            return Met(self._piece.begin, False, begin) if peaks else None
        if not peaks and self._value(0.0) + _BEYOND * begin * self._width < level:
            return None
        end = -begin if self._fold else self._slope(1.0)
        if end >= 0.0:
            return None
        place = self._peak(begin * self._by_place(0.0), end, level)
        if self._value(place) >= level:
            return self._root(0.0, place, level)
        return Met(self._whole(place), False, 0.0) if peaks else None

    def _peak(self, begin: float, end: float, level: float) -> float:
        """Return the place of the peak, or one before it where ``level`` is passed."""
        root, before = Bracket((0.0, begin), (1.0, end)), 0.0
        for _ in range(_MAX_ROUNDS):
            place = root.next
            change = self._slope(place) * self._by_place(place)
            if not math.isfinite(change) or (self._fold and Factors(self._few, self._at(place)).unstable):
                change = end  # so near the fold that another branch was found, or none
            elif self._value(place) >= level or abs(change) <= _PEAK_RTOL * begin:
                return place
            before = place if change > 0.0 else before
            root.narrow(place, change)
            if root.width <= _RTOL:
                break
        return before

    def _root(self, low: float, high: float, level: float) -> Met:
        """Return where the demand is passed between two places, by Newton's method."""
        below, above = self._value(low), self._value(high)
        place = low + (high - low) * (level - below) / (above - below) if above > level else high
        for _ in range(_MAX_ROUNDS):
            off, change = level - self._value(place), self._slope(place) * self._by_place(place)
            low, high = (place, high) if off > 0.0 else (low, place)
            step = off / change if change > 0.0 else math.inf
            if abs(step) * self._by_place(place) <= self._tolerance or abs(off) <= 0.0:
                break
            further = place + step
            if not low < further < high:
                further = low + 0.5 * (high - low)
                if not low < further < high:
                    break
            place = further
        return self._passed(place)

    def _passed(self, place: float) -> Met:
        """Return the state at a place as that where the demand is passed."""
        return Met(self._whole(place), True, self._slope(place))

    def _by_place(self, place: float) -> float:
        """Return the change of the way by the place."""
        return 2.0 * self._width * (1.0 - place) if self._fold else self._width

    def _value(self, place: float) -> float:
        return self._climb.value(self._at(place))

    def _slope(self, place: float) -> float:
        """Return by how much the demand grows along the way."""
        state = self._at(place)
        found = slope(self._few, state, self._factors)
        if math.isnan(found):
            found = slope(self._few, state, Factors(self._few, state))
        return self._climb.machine.slope(-found)

    def _at(self, place: float) -> State:
        """Return the contacts at a place, from those at the places on both sides."""
        if place in self._known:
            return self._known[place]
        low, high = max(u for u in self._known if u < place), min(u for u in self._known if u > place)
        first, last = self._known[low], self._known[high]
        part = (place - low) / (high - low)
        begin, end = self._piece.begin.separation, self._piece.end.separation
        left = (1.0 - place) ** 2 if self._fold else 1.0 - place
        h = begin + (1.0 - left) * (end - begin)
        guess = interpolated(self._few, first, last, part, h, first.outer)
        found, _ = newton(self._few, guess, Drive(0.0, np.zeros_like(first.outer)), self._factors)
        if not is_near(guess, found):
            found = self._followed(first, h)
        self._known[place] = found
        return found

    def _followed(self, state: State, h: float) -> State:
        """Return the contacts at a separation, step by step from a state before it."""
        found, event = advance(self._few, state, Drive(h - state.separation, np.zeros_like(state.outer)))
        if event is not None:
            raise NoEquilibriumError
        return found

    def _whole(self, place: float) -> State:
        """Return the asperities of the piece at a place, with the contacts in stable equilibrium."""
        state = self._at(place)
        factors = Factors(self._few, state)
        if factors.unstable:
            state = self._known[place] = self._followed(self._known[0.0], state.separation)
            factors = Factors(self._few, state)
        begin = self._piece.begin
        return among(self._piece.problem, np.flatnonzero(begin.inside), state._replace(factors=factors), begin.outer)

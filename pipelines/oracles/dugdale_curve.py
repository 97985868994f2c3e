"""The equilibrium curve of one asperity with adhesion of finite range: its folds, and how its states are reached."""

import itertools
from collections.abc import Iterator
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from oracles.dugdale import Cohesion, State
from oracles.multiprecision import Number, bracket, mp, radius_between, root
from oracles.profiles import Floats, Profile

WORKING = 55
DIGITS = 45  # digits of the integrals; the folds are right to a few less
CONTROLS = ("displacement", "force")
NEAREST = 1e-9  # a state closer to its fold is left out: a double does not distinguish it from the fold


class Fold(NamedTuple):
    """A fold: where a control begins to grow along the curve, or to fall."""

    rising: bool
    state: State


class Place(NamedTuple):
    """A point of the curve: at a contact radius [m], or lifted (a = 0) with a cohesive radius [m]."""

    radius: Any
    lifted: bool
    corner: Any = None
    """The cohesive radius [m] where it is at a corner of the profile, with the slope from ``inside`` or not."""
    inside: bool = False


def each_of(states: State) -> list[State]:
    """Return an array of states one by one."""
    return [State(*numbers) for numbers in zip(*states, strict=True)]


class Curve:
    """The curve from c = 0 outwards, for contacts with radii near ``size`` [m] and folds below ``reach`` [m]."""

    def __init__(
        self, profile: Profile, effective_modulus: Number, work: Number, strength: Number, size: float, reach: float
    ) -> None:
        self.reach = reach
        self.exact = Cohesion(profile, effective_modulus, work, strength, DIGITS)
        self.rough = Cohesion(profile, effective_modulus, work, strength, 0)
        self.size = mp.mpf(size)
        self.corners = [b for b, _ in profile.corners]

    @cached_property
    def touch(self) -> Number:
        """The cohesive radius [m] below which a = 0."""
        exact = self.exact

        def above(y: Number) -> Number:
            c = radius_between(0, exact.end, self.size, y)
            return mp.log((exact.height(c) + exact.beta * c * (1 - 2 / mp.pi)) / exact.range)

        return radius_between(0, exact.end, self.size, root(above, *bracket(above)))

    def state(self, place: Place) -> State:
        """Return the state at a place."""
        radius = np.array([mp.mpf(place.radius)])
        if place.lifted:
            return each_of(self.exact.lifted(radius, place.inside))[0]
        if place.corner is not None:
            m = np.array([mp.sqrt((place.corner - place.radius) * (place.corner + place.radius))])
            return each_of(self.exact.at(radius, m, np.array([place.corner]), place.inside))[0]
        m = self.exact.spread(radius, np.array([mp.mpf(float(self.roughly(radius.astype(np.float64))[0]))]))
        return each_of(self.exact.at(radius, m))[0]

    def roughly(self, a: Floats) -> Floats:
        """Return m [m] at contact radii ``a`` > 0 [m], in double precision."""
        touch = float(self.touch)
        return self.rough.spread(a, np.sqrt(touch * (touch + a)))

    @cached_property
    def places(self) -> list[tuple[Place, State]]:
        """Many places along the curve, in order and in double precision; corners exactly, on both sides."""
        touch, size = float(self.touch), float(self.size)
        c = np.geomspace(1e-9, 1.0, 300) * touch
        a = np.geomspace(1e-9 * min(size, touch), self.reach, 1500)
        lifted, pressed = self.rough.lifted(c), self.rough.at(a, self.roughly(a))
        found = [(Place(mp.mpf(radius), True), each) for radius, each in zip(c, each_of(lifted), strict=True)]
        found += [(Place(mp.mpf(radius), False), each) for radius, each in zip(a, each_of(pressed), strict=True)]
        for b in self.corners:
            for inside in (True, False):
                lifted = b < self.touch
                place = Place(b if lifted else self._under(b), lifted, b, inside)
                found.append((place, self.state(place)))
        return sorted(found, key=lambda pair: (not pair[0].lifted, pair[0].radius))

    def _under(self, c: Number) -> Number:
        """Return the contact radius [m] at a cohesive radius of ``c``, which is beyond ``touch``."""

        def above(y: Number) -> Number:
            a = np.array([radius_between(0, c, c, y)])
            return 1 - self.exact.excess(a, np.array([mp.sqrt((c - a[0]) * (c + a[0]))]))[0][0]

        return radius_between(0, c, c, root(above, *bracket(above)))

    @cached_property
    def folds(self) -> dict[str, list[Fold]]:
        """All folds of each control, outwards."""
        return {control: list(self._find_folds(control)) for control in CONTROLS}

    def _find_folds(self, control: str) -> Iterator[Fold]:
        if self.places[0][1].grows(control) > 0:
            zero = mp.mpf(0)
            yield Fold(True, State(zero, zero, -self.exact.range, zero, zero, zero, zero))
        for (place, state), (after, state_after) in itertools.pairwise(self.places):
            rising = bool(state_after.grows(control) > 0)
            if rising != (state.grows(control) > 0):
                at = after if place.radius == after.radius else self._between(place, after, control)
                yield Fold(rising, self.state(at))
        if self.places[-1][1].grows(control) <= 0:
            raise ArithmeticError("the outermost branch lies beyond the search")

    def _between(self, place: Place, after: Place, control: str) -> Place:
        lifted = after.lifted
        start = place.radius if place.lifted == lifted else after.radius * mp.mpf("1e-20")

        def growth(y: Number) -> Number:
            return self.state(Place(mp.exp(y), lifted)).grows(control)

        return Place(mp.exp(root(growth, mp.log(start), mp.log(after.radius))), lifted)

    def minima(self, control: str) -> list[State]:
        """Return where a control, "displacement" or "force", begins to grow, outwards."""
        return [fold.state for fold in self.folds[control] if fold.rising]

    def pull_off(self, control: str) -> State:
        """Return where a slow retraction ends."""
        return min(self.minima(control), key=lambda state: state.under(control))

    def answers(self, state: State) -> dict[str, Number]:
        """Return the controls under which a slow retraction passes ``state``: it is stable and below the outer folds.

        Each comes with the distance to the branch's fold over that of the pull-off to 0.
        """
        found = {}
        for control in CONTROLS:
            value, minima = state.under(control), self.minima(control)
            inner = [each.under(control) for each in minima if each.c <= state.c]
            outer = [each.under(control) for each in minima if each.c > state.c]
            if state.grows(control) > 0 and all(value < each for each in outer):
                distance = (value - inner[-1]) / abs(self.pull_off(control).under(control))
                if distance > NEAREST:
                    found[control] = distance
        return found

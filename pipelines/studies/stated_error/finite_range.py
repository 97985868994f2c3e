"""The force of one asperity with adhesion of finite range along a path of the flat, from the slope f' alone.

Where a contact is on its equilibrium curve is found in double precision; its state there has many digits, and the
tangent leads from it to the indentation itself.
"""

import itertools
import math

import numpy as np
from oracles.dugdale import Array, Cohesion, Integrals, State
from oracles.dugdale_curve import Curve, Place, each_of
from oracles.dugdale_punch import Punch
from oracles.multiprecision import Number, mp
from oracles.profiles import profile_of
from scipy.optimize import brentq
from studies.stated_error.contacts import ContactPath

from roughmdr.shapes import Paraboloid, Shape

DIGITS = 22
TANGENT_RANGE = 1e-8  # of the indentation above the start of a branch, where the tangent is right to its square
_BEYOND_FOLDS = 16.0  # times the largest contact radius
_MIN_RADIUS = 1e-20  # over the next: where contacts begin to touch


class CohesiveParaboloid(Cohesion):
    """A paraboloid, whose integrals have a closed form."""

    def integrals(self, a: Array, m: Array, c: Array, inside: bool = False) -> Integrals:
        """Return the integrals for arrays ``a`` > 0, ``m`` > 0 and ``c`` [m]."""
        curvature = self.slope(np.array([self.math.number(1)]))[0]
        theta = self.math.atan2(m, a)
        opening = ((c * c / 2 - a * a) * theta + a * m / 2) * curvature
        return Integrals(a * a * curvature, 2 * a**3 * curvature / 3, opening, (c * theta + a * m / c) * curvature)


class CohesivePunchPath(ContactPath):
    """A flat punch: all its contacts have c = b."""

    def __init__(self, radius: float, effective_modulus: float, work: float, strength: float) -> None:
        self.punch = Punch(radius, effective_modulus, work, strength)
        self.touch = -self.punch.work / self.punch.strength
        super().__init__([(self.punch.pull_off("displacement").delta, mp.inf)])

    def force(self, branch: int, delta: Number) -> Number:
        """Return the force [N]."""
        return self.punch.state(delta).force


class CohesivePath(ContactPath):
    """Any other shape, at indentations up to ``deepest`` [m]."""

    def __init__(self, shape: Shape, effective_modulus: float, work: float, strength: float, deepest: float) -> None:
        kind = CohesiveParaboloid if isinstance(shape, Paraboloid) else Cohesion
        profile = profile_of(shape.name, dict(shape.parameters))
        arguments = profile, mp.mpf(effective_modulus), mp.mpf(work), mp.mpf(strength)
        self.exact, self.rough = kind(*arguments, DIGITS), kind(*arguments, 0)
        self.curve = Curve(*arguments, float(shape.nondimensional()[0]), 1.0)
        self.curve.exact, self.curve.rough = self.exact, self.rough
        self.touch = -self.exact.range
        radius = float(self.curve.touch)
        while self._state(Place(radius, False)).delta < deepest:
            radius *= 2.0
        self.curve.reach = _BEYOND_FOLDS * radius
        self.branches = list(itertools.pairwise(self._turning_points()))[::2]
        super().__init__([(low.delta, high.delta) for (_, low), (_, high) in self.branches])

    def _state(self, place: Place) -> State:
        """Return the state at a place in double precision."""
        radius = np.array([float(place.radius)])
        states = self.rough.lifted(radius) if place.lifted else self.rough.at(radius, self.curve.roughly(radius))
        return each_of(states)[0]

    def _turning_points(self) -> list[tuple[int, State]]:
        """Return where the indentation begins to grow along the curve, ceases to, and so on: the next place, state."""
        places = self.curve.places
        nothing = State(0.0, 0.0, float(self.touch), 0.0, 0.0, 0.0, 0.0)
        found = [(0, nothing)] if places[0][1].growth > 0 else []
        for number, ((place, state), (after, state_after)) in enumerate(itertools.pairwise(places), start=1):
            if (state_after.growth > 0) != (state.growth > 0):
                corner = place.radius == after.radius
                found.append((number, state_after if corner else self._between(place, after, 0.0, "growth")))
        return [*found, (len(places) - 1, nothing._replace(delta=math.inf))]

    def _between(self, place: Place, after: Place, value: float, name: str) -> State:
        """Return the state between two places at which one of its numbers has a value."""
        start = float(place.radius) if place.lifted == after.lifted else float(after.radius) * _MIN_RADIUS

        def excess(y: float) -> float:
            return float(getattr(self._state(Place(math.exp(y), after.lifted)), name)) - value

        y = brentq(excess, math.log(start), math.log(float(after.radius)), xtol=1e-15)
        return self._state(Place(math.exp(y), after.lifted))

    def force(self, branch: int, delta: Number) -> Number:
        """Return the force [N]."""
        (first, low), (last, _) = self.branches[branch]
        places = self.curve.places
        after = next(n for n in range(first, last + 1) if places[n][1].delta >= delta)
        rough = self._between(places[after - 1][0], places[after][0], float(delta), "delta")
        a = np.array([mp.mpf(float(rough.a))])
        if rough.a == 0.0:
            state = each_of(self.exact.lifted(np.array([mp.mpf(float(rough.c))])))[0]
        else:
            m = self.exact.spread(a, np.array([mp.sqrt((mp.mpf(rough.c) - a[0]) * (mp.mpf(rough.c) + a[0]))]))
            state = each_of(self.exact.at(a, m))[0]
        rest = delta - state.delta
        if abs(rest) > TANGENT_RANGE * (delta - low.delta):
            raise ArithmeticError(f"{delta} was not met")
        return state.force + state.stiffness * rest

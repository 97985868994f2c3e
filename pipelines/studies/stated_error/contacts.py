"""The force of one asperity along a path of the flat, with many digits and from the slope f' of its profile alone.

A contact stays on the stable branches of its equilibrium curve: where one ends it jumps to the next, inwards or
outwards, or detaches; it begins at first touch.
"""

import math
from collections.abc import Callable, Iterable, Iterator
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from oracles.dugdale import Array, Cohesion, Integrals, Punch, State
from oracles.dugdale_curve import Curve, Place, each_of
from oracles.jkr import Asperity
from oracles.multiprecision import Number, mp
from oracles.profiles import closed_profile
from scipy.optimize import brentq

from roughmdr.kernels.adhesion import Adhesion
from roughmdr.shapes import FlatPunch, Paraboloid, Shape

_DIGITS = 22  # digits of the integrals with adhesion of finite range
_TANGENT_RANGE = 1e-8  # indentation above the start of a branch, relative, where the tangent is right to its square
_BEYOND_FOLDS = 16.0  # largest contact radius that is sought, over that at the last fold
_MIN_RADIUS = 1e-20  # smallest contact radius, over the next: where contacts begin to touch


def branch_numbers(indentations: Iterable[Number], ends: list[tuple[Number, Number]], touch: Number) -> Iterator[int]:
    """Yield the number of the stable branch that a contact is on at each indentation of a path, -1 for no contact.

    ``ends`` are the indentations between which each branch lies, from the innermost to the outermost; a contact begins
    at ``touch``.
    """
    branch = -1
    for delta in indentations:
        if branch < 0 and delta >= touch:
            branch = 0
        while branch >= 0 and delta < ends[branch][0]:
            branch -= 1
        while branch >= 0 and delta > ends[branch][1]:
            branch += 1
        yield branch


class ContactPath(NamedTuple):
    """One asperity on a half-space, loaded and unloaded."""

    ends: list[tuple[Number, Number]]  # indentations [m] between which each stable branch lies
    force: Callable[[int, Number], Number]  # return the force [N] on a branch at an indentation [m]
    touch: Number = 0  # the indentation [m] at which a contact begins

    def forces(self, indentations: list[Number]) -> list[Number]:
        """Return the force [N] at each indentation [m] of a path."""
        branches = branch_numbers(indentations, self.ends, self.touch)
        return [self.force(k, delta) if k >= 0 else mp.mpf(0) for k, delta in zip(branches, indentations, strict=True)]


def contact_path(shape: Shape, effective_modulus: float, adhesion: Adhesion, deepest: float) -> ContactPath:
    """Return the reference of one asperity at indentations up to ``deepest`` [m]."""
    if not isinstance(shape, FlatPunch):
        if adhesion.cohesive:
            return _CohesiveCurve(shape, effective_modulus, adhesion, deepest).path
        return _jkr_path(shape, effective_modulus, adhesion.work)
    if adhesion.cohesive:
        punch = Punch(shape.radius, effective_modulus, adhesion.work, adhesion.strength)
        ends = [(punch.pull_off("displacement").delta, mp.inf)]
        return ContactPath(ends, lambda _, delta: punch.state(delta).force, -punch.work / punch.strength)
    E, b = mp.mpf(effective_modulus), mp.mpf(shape.radius)
    return ContactPath([(-mp.sqrt(2 * mp.pi * b * adhesion.work / E), mp.inf)], lambda _, delta: 2 * E * b * delta)


def _jkr_path(shape: Shape, effective_modulus: float, work: float) -> ContactPath:
    """Return the path of a shape that is no flat punch, without adhesion or with JKR's."""
    asperity = Asperity(closed_profile(shape), effective_modulus, work, shape.nondimensional()[0])
    branches = asperity.branches("indentation")
    tops = [
        mp.inf if branch.hi in (None, asperity.profile.end) else asperity.state(branch.hi)["indentation"]
        for branch in branches
    ]

    def force(number: int, delta: Number) -> Number:
        branch = branches[number]
        if delta <= branch.value:
            return asperity.state(branch.lo)["force"] if branch.lo > 0 else mp.mpf(0)
        state = asperity.solve([branch], "indentation", delta)
        if state is None:
            raise ArithmeticError(f"no contact of {shape} at {delta}")
        return state["force"]

    return ContactPath([(branch.value, top) for branch, top in zip(branches, tops, strict=True)], force)


class _CohesiveParaboloid(Cohesion):
    """A paraboloid, whose integrals have a closed form."""

    def integrals(self, a: Array, m: Array, c: Array, inside: bool = False) -> Integrals:
        """Return the integrals for arrays ``a`` > 0, ``m`` > 0 and ``c`` [m]."""
        curvature = self.slope(np.array([self.math.number(1)]))[0]
        theta = self.math.atan2(m, a)
        opening = ((c * c / 2 - a * a) * theta + a * m / 2) * curvature
        return Integrals(a * a * curvature, 2 * a**3 * curvature / 3, opening, (c * theta + a * m / c) * curvature)


class _CohesiveCurve:
    """A shape that is no flat punch, with adhesion of finite range.

    Where a contact is on its equilibrium curve is found in double precision; its state there has many digits, and the
    tangent leads from it to the indentation itself.
    """

    def __init__(self, shape: Shape, effective_modulus: float, adhesion: Adhesion, deepest: float) -> None:
        kind = _CohesiveParaboloid if isinstance(shape, Paraboloid) else Cohesion
        E, work, strength = (mp.mpf(each) for each in (effective_modulus, adhesion.work, adhesion.strength))
        arguments = closed_profile(shape), E, work, strength
        self.curve = Curve(*arguments, float(shape.nondimensional()[0]), 1.0)
        self.curve.exact, self.curve.rough = kind(*arguments, _DIGITS), kind(*arguments, 0)
        radius = float(self.curve.touch)
        while self._state(Place(radius, False)).delta < deepest:
            radius *= 2.0
        self.curve.reach = _BEYOND_FOLDS * radius
        self.starts = self.curve.minima("displacement")
        tops = [fold.state.delta for fold in self.curve.folds["displacement"] if not fold.rising]
        ends = zip((start.delta for start in self.starts), [*tops, mp.inf], strict=True)
        self.path = ContactPath(list(ends), self._force, -self.curve.exact.range)

    def _state(self, place: Place) -> State:
        """Return the state at a place in double precision."""
        radius = np.array([float(place.radius)])
        rough = self.curve.rough
        return each_of(rough.lifted(radius) if place.lifted else rough.at(radius, self.curve.roughly(radius)))[0]

    def _force(self, branch: int, delta: Number) -> Number:
        """Return the force [N]."""
        start = self.starts[branch]
        steps = pairwise(self.curve.places)
        place, after = next(
            (one, other) for (one, _), (other, state) in steps if state.c > start.c and state.delta >= delta
        )
        low = float(place.radius) if place.lifted == after.lifted else float(after.radius) * _MIN_RADIUS

        def excess(y: float) -> float:
            return float(self._state(Place(math.exp(y), after.lifted)).delta - delta)

        y = brentq(excess, math.log(low), math.log(float(after.radius)), xtol=1e-15)
        state = self.curve.state(Place(math.exp(y), after.lifted))
        rest = delta - state.delta
        if abs(rest) > _TANGENT_RANGE * (delta - start.delta):
            raise ArithmeticError(f"{delta} was not met")
        return state.force + state.stiffness * rest

"""The rings along the path of the body, step by step."""

import math
from typing import NamedTuple

import numpy as np

from roughmdr.errors import OutOfRange
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.underway import each_step
from roughmdr.stages.curved.equilibrium import Half, State, equilibrium, linear_response
from roughmdr.stages.curved.rings import Rings


class Place(NamedTuple):
    """The rings in equilibrium at one separation of the body."""

    h: float
    """The separation of the body's apex from the datum plane [m]."""
    state: State
    memory: Floats
    """The lowest heights in contact [m]: [node, ring]."""
    response: Floats
    """ds/dh [1] of each ring."""


class Body(NamedTuple):
    """The curved body over rings on the half-space."""

    rings: Rings
    profile: Floats
    """f [m] on each ring."""
    half: Half

    def apart(self) -> Place:
        """Return the rings before the path begins, far apart."""
        h = self.half.law.highest + self.half.law.range
        s, none = h + self.profile, np.zeros_like(self.profile)
        memory = self.half.law.untouched(s.size)
        return Place(h, State(s, none, none, none), memory, np.ones_like(s))

    def moved(self, place: Place, h: float) -> Place:
        """Return the rings after the body has moved to h [m]; OutOfRange where no equilibrium is found."""
        rigid, towards = h + self.profile, place.state.s + (h - place.h) * place.response
        state = equilibrium(self.half, rigid, place.memory, towards, place.state.s)
        if state is None:
            raise OutOfRange(f"no equilibrium of the layer under the curved body is found at a separation of {h:.6g} m")
        response, _ = linear_response(self.half, state, np.ones_like(rigid))
        return Place(h, state, self.half.law.remember(state.s, place.memory), response)

    def along(self, separation: Floats, place: Place | None = None) -> list[Place]:
        """Return the rings at each separation [m] of a path from infinity, or from a known equilibrium."""
        places: list[Place] = []
        last = self.apart() if place is None else place
        for h in each_step(separation.tolist()):
            last = last if h == last.h and places else self.moved(last, h)
            places.append(last)
        return places

    def force(self, places: list[Place]) -> Floats:
        """Return the force [N] of each equilibrium."""
        return np.array([float((self.rings.area_weights * place.state.pressure).sum()) for place in places])

    def totals(self, place: Place) -> dict[int, float]:
        """Return the totals of ``ROWS`` over all rings."""
        found = self.half.law.totals(place.state.s, place.memory)
        return {row: float((self.rings.area_weights * values).sum()) for row, values in found.items()}

    def stiffness(self, place: Place) -> float:
        """Return -dF/dh [N/m] of bodies and asperities, with contacts that are made or lost."""
        return -float((self.rings.area_weights * place.state.slope * place.response).sum())

    def contact_radius(self, place: Place) -> float:
        """Return the effective radius of the nominal contact [m], 3 pi/4 ∫ r p dr / ∫ p dr; 0 without contact.

        p is the pressure of the contacts that push, so that the radius is defined at pull-off too. Without adhesion it
        is Greenwood and Tripp's, which under Hertz's pressure is Hertz's.
        """
        load = self.half.law.pushing(place.state.s, place.memory) * self.rings.weights
        whole = float(load.sum())
        return 0.75 * math.pi * float((self.rings.radius * load).sum()) / whole if whole > 0.0 else 0.0

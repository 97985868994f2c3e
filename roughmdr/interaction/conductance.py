"""The conductance of contacts on a half-space: the stiffness of coupled flat punches of their radii that stay level.

Pressure and displacement are to it as current and potential, with the contact areas as they are (J. R. Barber, Proc. R.
Soc. Lond. A 459 (2003) 53). A punch of radius a under the load P displaces others by P G and by its second moment,
P a^2/6 lap G; the displacement u by others that it bears is the mean under its own pressure, u + a^2/6 lap u; and where
they tilt the surface its pressure has a moment, 4/3 E* a^3 for a tilt of 1, which others feel. Left out is the fifth
order in radius over distance. Contacts that grow have other terms besides, as a curved surface changes their area.

Lengths are over the side L of the patch, loads over pi E* L^2.
"""

import math
from typing import NamedTuple

import numpy as np

from roughmdr.interaction import close
from roughmdr.interaction.dense import Dense
from roughmdr.interaction.newton import Coupling, State, System, first_order
from roughmdr.numerics.arguments import Floats

_RTOL = 0.01  # of a step
_MAX_STEPS = 20


class Punches(NamedTuple):
    """Flat punches that are coupled."""

    radius: Floats
    """0 of those that are not there."""
    coupling: Coupling
    tangent: Coupling
    """That of the steps, which are less accurate."""
    pairs: close.Pairs
    """Those that overlap."""
    order: int
    without_pairs: bool
    """Whether the coupling is without the expansion of the pairs already."""

    @classmethod
    def of(cls, system: System, state: State) -> "Punches":
        """Return the punches of contacts without adhesion."""
        contacts = state.contacts
        radius = np.where(contacts.load > 0.0, contacts.radius, 0.0)
        pairs = state.pairs._replace(share=np.zeros_like(state.pairs.share))
        close.update_shares(pairs, radius)
        return cls(radius, system.coupling, system.tangent, pairs, system.order, False)

    @classmethod
    def of_adhesive(cls, radius: Floats, coupling: Dense, pairs: close.Pairs, order: int) -> "Punches":
        """Return the punches of adhesive contacts, whose coupling is without the expansion of overlapping pairs."""
        return cls(radius, coupling, coupling, pairs, order, True)


def total_conductance(punches: Punches, error: float) -> float:
    """Return the conductance radius, half of pi times the total load for a displacement of 1, to a relative error.

    NaN where it is not found. The total is stationary at the loads: S = 1'P + P'r + r'A^-1 r with r = 1 - A P, of which
    the last is small of second order, and estimated by the next step.
    """
    stiffness = 2.0 / math.pi * punches.radius
    there = stiffness > 0.0
    if not there.any():
        return 0.0
    whole, added = _of_pairs(punches)

    def step(right: Floats) -> Floats:
        return first_order(punches.tangent, punches.pairs, added, stiffness, right, _RTOL)

    load = step(there.astype(np.float64))
    for _ in range(_MAX_STEPS):
        own = np.divide(load, stiffness, out=np.zeros_like(load), where=there)
        rest = np.where(there, 1.0 - own - _displacement(punches, load, whole, added), 0.0)
        change = step(rest)
        total, gain = math.fsum((load * (1.0 + rest)).tolist()), math.fsum((rest * change).tolist())
        if not math.isfinite(total + gain):
            break
        if abs(gain) * (_RTOL + math.sqrt(abs(gain / total))) <= error * total:
            return 0.5 * math.pi * (total + gain)
        load = load + change
    return math.nan


def _of_pairs(punches: Punches) -> tuple[Floats, Floats]:
    """Return how a load of each overlapping pair is felt by the other, and what that adds to the coupling."""
    pairs = punches.pairs
    expansion = pairs.share / pairs.apart[:, 2]
    beyond = np.zeros_like(expansion)
    close.tangent(pairs, punches.radius, beyond)
    whole = beyond + expansion
    return whole, whole if punches.without_pairs else beyond


def _displacement(punches: Punches, load: Floats, whole: Floats, added: Floats) -> Floats:
    """Return the displacement of each punch by all others."""
    pairs, coupling, a = punches.pairs, punches.coupling, punches.radius
    if punches.order == 1:
        displacement = coupling.potential(load)
        close.add_tangent(pairs, added, load, displacement)
        return displacement
    field = coupling.field(load)
    if not punches.without_pairs:
        close.take_from_field(pairs, load, field)
    spread, tilting = a * a / 6.0, 4.0 / (3.0 * math.pi) * a**3
    moments = spread * load, tilting * field[1], tilting * field[2]
    displacement = np.asarray(field[0] + spread * field[3] + coupling.of_moments(*moments))
    if not punches.without_pairs:
        close.take_from_moments(pairs, *moments, displacement)
    close.add_tangent(pairs, whole, load, displacement)
    return displacement

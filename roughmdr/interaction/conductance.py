"""The conductance of contacts on a half-space: the stiffness of coupled flat punches of their radii that stay level.

Pressure and displacement are to it as current and potential, with the contact areas as they are (J. R. Barber, Proc. R.
Soc. Lond. A 459 (2003) 53). To second order a punch of radius a under the load P displaces others by P G and by its
second moment, P a^2/6 lap G; the displacement u by others that it bears is the mean under its own pressure, u + a^2/6
lap u; where they tilt the surface its pressure has a moment, 4/3 E* a^3 for a tilt of 1, which others feel; and it
stands where the contact has slid to on the surface that the forces tilt. Left out is the fifth order in radius over
distance. A curved surface changes no area, as it does of contacts that grow.

Lengths are over the side L of the patch, loads over pi E* L^2.
"""

import math
from typing import NamedTuple

import numpy as np

from roughmdr.interaction import close
from roughmdr.interaction.coupling import Coupling, add_moments, field_of, first_order
from roughmdr.numerics.arguments import Floats

_RTOL = 0.01  # relative error of a Newton step
_MAX_STEPS = 20


class Punches(NamedTuple):
    """Flat punches that are coupled."""

    radius: Floats
    """0 of those that are not there."""
    slid: Floats
    """How far each stands beside its asperity, along x and along y."""
    coupling: Coupling
    tangent: Coupling
    """That of the steps, which are less accurate."""
    pairs: close.Pairs
    """Overlapping pairs."""
    order: int


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
    return beyond + expansion, beyond


def _displacement(punches: Punches, load: Floats, whole: Floats, added: Floats) -> Floats:
    """Return the displacement of each punch by all others."""
    pairs, coupling, a = punches.pairs, punches.coupling, punches.radius
    if punches.order == 1:
        displacement = coupling.potential(load)
        close.add_tangent(pairs, added, load, displacement)
        return displacement
    field = field_of(coupling, pairs, punches.order, load)
    spread, tilting, (x, y) = a * a / 6.0, 4.0 / (3.0 * math.pi) * a**3, punches.slid
    displacement = np.asarray(field[0] + x * field[1] + y * field[2] + spread * field[3])
    add_moments(
        coupling, pairs, (spread * load, tilting * field[1] - x * load, tilting * field[2] - y * load), displacement
    )
    close.add_tangent(pairs, whole, load, displacement)
    return displacement

"""The mean field: every asperity is displaced by the mean pressure of all, u = c F, without positions.

The flat at separation h then meets independent asperities as if at h + c F, so that F = F0(h + c F), where F0 is the
force of independent asperities (M. Ciavarella, J. A. Greenwood, M. Paggi, Wear 265 (2008) 729).
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from roughmdr.aggregate.problem import Problem
from roughmdr.aggregate.totals import CONDUCTANCE, ENERGY, ERROR, FORCE, STIFFNESS
from roughmdr.ensemble.ensemble import Ensemble
from roughmdr.ensemble.gaussian.section import SUMMIT_DISTANCE
from roughmdr.errors import OutOfRange
from roughmdr.interaction.placed import sides_of
from roughmdr.interaction.settings import Interaction
from roughmdr.loading.path import LoadingPath
from roughmdr.loading.staircase import no_memory
from roughmdr.numerics.arguments import Floats

_MAX_ITERATIONS = 200
_RTOL = 1e-13  # smallest step of Newton's method, over the force: a shorter one is the last

ForceAndStiffness = Callable[[Floats], tuple[Floats, Floats]]
"""Separations [m] -> force [N] and stiffness -dF/dh [N/m] of independent asperities."""


def mean_inverse_distance(side_x: float, side_y: float) -> float:
    """Return the mean of 1/r [1/m] over pairs of points on a rectangle: 2.97321 over the side of a square.

    4/(a b)^2 times the integral of (a - x)(b - y)/r over x < a and y < b, where t = b/a and a is the longer side. For a
    square it is (4/3)(1 - sqrt 2 + 3 ln(1 + sqrt 2))/a.
    """
    longer, shorter = max(side_x, side_y), min(side_x, side_y)
    t = shorter / longer
    diagonal = math.hypot(1.0, t)
    along = math.asinh(t) / t + math.asinh(1.0 / t)
    across = (diagonal * diagonal + diagonal + 1.0) / (diagonal + 1.0) - t  # (diagonal^3 - 1 - t^3)/t^2
    return 4.0 * (0.5 * along - across / 6.0) / longer


def coupling_of(
    interaction: Interaction, effective_modulus: float, sides: tuple[float, float], exclusion: float
) -> float:
    """Return c [m/N], the mean displacement by the others over the force of all; E* [Pa], lengths [m].

    "free": the mean over the patch of its displacement by a uniform pressure, <1/r>/(pi E*).

    "periodic": the mean of the zero-mean Green's function over the others. It is 0 where they are placed at random, and
    of uniform density beyond an empty disc of radius ``exclusion`` about each asperity it is -2 exclusion/(E* A): they
    raise the mean plane, but none is near. That is the first order of a hard core; of random sequential addition,
    whose asperities crowd just beyond the least distance, it is 10 % too large at 0.5 of the mean spacing, 30 % at 0.7.
    Of a hexagonal lattice the distance is such that the lattice sum comes out.
    """
    if interaction.boundary == "free":
        return mean_inverse_distance(*sides) / (math.pi * effective_modulus)
    return -2.0 * (exclusion / sides[0] / sides[1]) / effective_modulus


def exclusion_of(ensemble: Ensemble) -> float:
    """Return the radius of the empty disc [m] that stands for the neighbours which an asperity of an ensemble lacks.

    It is that of the placement where the attributes of the ensemble have it, as from ``generate``. Summits of a map are
    taken to be as far apart as those of source "nayak". All others are taken to be placed at random, with no such disc:
    their positions, if they have any, are for the pairwise interaction.
    """
    if "exclusion_distance" in ensemble.attrs:
        return float(ensemble.attrs["exclusion_distance"])
    if not ensemble.attrs.get("of_surface") or ensemble.nominal_area is None:
        return 0.0
    return SUMMIT_DISTANCE * math.sqrt(ensemble.nominal_area / ensemble.height.size)


def coupling_in(problem: Problem) -> float:
    """Return c [m/N] of the mean field of an ensemble, whose patch is known; 0 for none."""
    interaction, sides = problem.interaction, sides_of(problem.ensemble)
    if interaction is None or interaction.model != "mean_field" or sides is None:
        return 0.0
    return coupling_of(interaction, problem.effective_modulus, sides, exclusion_of(problem.ensemble))


class Shift(NamedTuple):
    """Separations at which independent asperities have the force of those under their mean field."""

    coupling: float
    """c [m/N]."""
    separation: Floats
    """h + c F [m]."""
    force: Floats
    """F [N]."""


def shift(independent: ForceAndStiffness, separation: Floats, coupling: float) -> Shift:
    """Find F = F0(h + c F) at each separation h [m], under the mean field c [m/N].

    Newton's method, at all separations at once, from F = 0. Contacts without adhesion grow stiffer as the flat falls:
    F - F0(h + c F) is concave in F, and each step ends at or below its first root, whatever the sign of c. OutOfRange
    where it has none: for c < 0 the contacts are stiffer than the half-space that their mean pressure raises.
    """
    force, beyond, moves = np.zeros_like(separation), separation, np.ones(separation.size, np.bool_)
    for _ in range(_MAX_ITERATIONS):
        found, stiffness = independent(beyond)
        slope = 1.0 + coupling * stiffness
        if (unstable := slope <= 0.0).any():
            h = float(separation[unstable].max())
            raise OutOfRange(
                f"interaction.model = 'mean_field' has no equilibrium at a separation of {h:g} m, of the flat or the "
                "far end of its spring: the contacts are stiffer than the surface, which the pressure between them "
                "raises against the flat; they are too near to each other for a mean field"
            )
        step = np.where(moves, np.maximum(found - force, 0.0) / slope, 0.0)
        force = force + step
        beyond = separation + coupling * force
        moves &= step > _RTOL * force  # each by itself, so that other separations change nothing
        if not moves.any():
            return Shift(coupling, beyond, force)
    raise OutOfRange("interaction.model = 'mean_field': no equilibrium was found")


def of_independent(problem: Problem) -> ForceAndStiffness:
    """Return force and stiffness of independent asperities without memory as a function of separations."""

    def law(separation: Floats) -> tuple[Floats, Floats]:
        found, _, _ = problem.sums(LoadingPath(separation, no_memory(separation)), {FORCE, STIFFNESS})
        return found[FORCE], found[STIFFNESS]

    return law


def couple(total: Floats, shift: Shift) -> None:
    """Change totals [row, step] at the separations h + c F into those of asperities under their mean field at h.

    With k the stiffness of independent asperities, the slope of the force is k/(1 + c k). The conductance, an error of
    the force, and the residual of F - F0(h + c F) are smaller by the same factor, and the surface stores c F^2/2 of
    the energy.
    """
    slope = 1.0 + shift.coupling * total[STIFFNESS]
    total[ERROR] = (total[ERROR] + np.abs(total[FORCE] - shift.force)) / slope
    total[STIFFNESS] /= slope
    total[CONDUCTANCE] /= slope
    total[ENERGY] += 0.5 * shift.coupling * total[FORCE] * total[FORCE]

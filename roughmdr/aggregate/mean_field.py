"""The totals of asperities under their mean field, from those of independent ones at the shifted separations."""

import numpy as np

from roughmdr.aggregate.loop import sum_over_asperities
from roughmdr.aggregate.totals import CONDUCTANCE, ENERGY, ERROR, FORCE, STIFFNESS
from roughmdr.interaction.mean_field import ForceAndStiffness, Shift
from roughmdr.kernels.adhesion import Adhesion
from roughmdr.kernels.interface import Columns, Kernels
from roughmdr.loading.staircase import no_memory
from roughmdr.numerics.arguments import Floats


def of_independent(
    kernels: Kernels, height: Floats, columns: Columns, effective_modulus: float, adhesion: Adhesion
) -> ForceAndStiffness:
    """Return force and stiffness of independent asperities without memory as a function of separations; E* [Pa]."""
    given = kernels, height, columns, effective_modulus, adhesion

    def law(separation: Floats) -> tuple[Floats, Floats]:
        found, _, _ = sum_over_asperities(*given, separation, no_memory(separation), {FORCE, STIFFNESS})
        return found[FORCE], found[STIFFNESS]

    return law


def couple(total: Floats, shift: Shift) -> None:
    """Change totals [row, step] at the separations h + c F into those of asperities under their mean field at h.

    With k the stiffness of independent asperities, the slope of the force is k/(1 + c k). The conductance, an error of
    the force, or what is left of F - F0(h + c F), are as much smaller, and the surface stores c F^2/2 of the energy.
    """
    slope = 1.0 + shift.coupling * total[STIFFNESS]
    total[ERROR] = (total[ERROR] + np.abs(total[FORCE] - shift.force)) / slope
    total[STIFFNESS] /= slope
    total[CONDUCTANCE] /= slope
    total[ENERGY] += 0.5 * shift.coupling * total[FORCE] * total[FORCE]

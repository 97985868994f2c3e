"""The pull-off of an ensemble: the largest tension of its unloadings."""

from typing import Any

import numpy as np

from roughmdr.aggregate.detachment import detachment_depths
from roughmdr.aggregate.loop import count_above, sum_over_asperities
from roughmdr.aggregate.totals import COUNT, FORCE
from roughmdr.kernels.adhesion import Adhesion
from roughmdr.kernels.interface import Columns, Kernels
from roughmdr.loading.path import LoadingPath
from roughmdr.loading.pull_off import WITHOUT_TENSION, PullOff, locate, unloadings
from roughmdr.numerics.arguments import Floats


def pull_off_of(
    kernels: Kernels,
    height: Floats,
    columns: Columns,
    effective_modulus: float,
    adhesion: Adhesion,
    path: LoadingPath,
    force: Floats,
) -> PullOff:
    """Return the pull-off along a path, given the force [N] at its steps; height [m] descends.

    NaN where no unloading ends with all contacts parted: there, and only there, the force is exactly 0.
    """
    rises = unloadings(path.separation, force)
    if not any(rise.force[-1] == 0.0 for rise in rises):
        return PullOff()
    closest = float(path.separation.min()) - adhesion.range
    count = count_above(height, closest) if height.size else 0
    if not (kernels.adhesive and count):
        return WITHOUT_TENSION
    top, few = height[:count], Columns(*(column[:count] for column in columns))
    depths = detachment_depths(kernels, few, effective_modulus, adhesion)

    def evaluate(refined: LoadingPath) -> tuple[Any, Any]:
        total, _, _ = sum_over_asperities(
            kernels, top, few, effective_modulus, adhesion, refined.separation, refined.memory, {FORCE, COUNT}
        )
        return total[FORCE], total[COUNT]

    return locate(rises, evaluate, np.sort(top + depths))

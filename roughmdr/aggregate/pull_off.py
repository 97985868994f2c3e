"""The pull-off of an ensemble: the largest tension of its unloadings."""

import numpy as np

from roughmdr.aggregate.detachment import detachments
from roughmdr.aggregate.loop import sum_over_asperities
from roughmdr.aggregate.totals import AREA, COUNT, FORCE
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
    count = int(np.count_nonzero(height >= closest))
    if not (kernels.adhesive and count):
        return WITHOUT_TENSION
    top, few = height[:count], Columns(*(column[:count] for column in columns))
    depths = detachments(kernels, few, effective_modulus, adhesion).depth

    def sums(along: LoadingPath, rows: set[int]) -> Floats:
        total, _, _ = sum_over_asperities(
            kernels, top, few, effective_modulus, adhesion, along.separation, along.memory, rows
        )
        return total

    found = locate(rises, lambda along: sums(along, {FORCE})[FORCE], np.sort(top + depths))
    if found is None:
        return WITHOUT_TENSION
    there = sums(found.path, {COUNT, AREA})[:, -1]
    return PullOff(found.force, float(found.path.separation[-1]), float(there[COUNT]), float(there[AREA]))

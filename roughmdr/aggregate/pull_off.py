"""The pull-off of an ensemble: the largest tension of its unloadings."""

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np

from roughmdr.aggregate.loop import count_above, sum_over_asperities
from roughmdr.aggregate.totals import COUNT, FORCE
from roughmdr.kernels.adhesion import Adhesion
from roughmdr.kernels.interface import Columns, Kernels, Material, law
from roughmdr.loading.path import LoadingPath
from roughmdr.loading.pull_off import WITHOUT_TENSION, PullOff, locate, unloadings
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.jit import specialise
from roughmdr.numerics.summation import BLOCK


def _fill_depths(columns: Columns, material: Material, depths: Floats) -> None:
    """Fill in how far below first touch [m] each contact detaches."""
    for start in range(0, depths.size, BLOCK):
        stop = min(start + BLOCK, depths.size)
        params = law.prepare(material, columns, start, stop, 0.0)
        for i in range(start, stop):
            own = law.params_of(params, i - start)
            (depth, _), _, _, _ = law.scales(
                material.effective_modulus, material.work, columns.width[i], columns.rise[i], own
            )
            depths[i] = depth


@cache
def _compiled(kernels: Kernels) -> Callable[[Columns, Material, Floats], None]:
    return specialise(_fill_depths, kernels)


def prepare(kernels: Kernels, columns: Columns, adhesion: Adhesion) -> None:
    """Compile what the pull-off of adhesive contacts needs."""
    if kernels.adhesive:
        _compiled(kernels)(columns, Material(1.0, adhesion.work, adhesion.strength), np.empty(1))


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
    material = Material(effective_modulus, adhesion.work, adhesion.strength)
    depths = np.empty(count)
    _compiled(kernels)(few, material, depths)

    def evaluate(refined: LoadingPath) -> tuple[Any, Any]:
        total, _, _ = sum_over_asperities(
            kernels, top, few, effective_modulus, adhesion, refined.separation, refined.memory, {FORCE, COUNT}
        )
        return total[FORCE], total[COUNT]

    return locate(rises, evaluate, np.sort(top + depths))

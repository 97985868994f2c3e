"""The natural scales of a block of asperities."""

import numpy as np

from roughmdr.aggregate.block import (
    DEPTH_SCALE,
    ENERGY_SCALE,
    FORCE_SCALE,
    PER_DEPTH,
    RADIUS_SCALE,
    SCALES,
    STIFFNESS_SCALE,
    Block,
    law,
)
from roughmdr.kernels.interface import Columns, Material
from roughmdr.numerics.summation import block_minimum

_SMALLEST, _LARGEST = np.finfo(np.float64).tiny, np.finfo(np.float64).max


def natural_scales(block: Block, columns: Columns, start: int, material: Material, energetic: bool) -> bool:
    """Fill the natural scales of a block that begins at ``start``; False where one is not representable.

    That of the energy is 1 unless ``energetic``: unless an energy is asked for.
    """
    scales, params, scratch, count = block.scales, block.params, block.scratch, block.z.size
    width, rise, modulus, work = columns.width, columns.rise, material.effective_modulus, material.work
    for i in range(count):  # nothing but this, so that it becomes vector code
        (depth, _), size, load, rigidity = law.scales(
            modulus, work, width[start + i], rise[start + i], law.params_of(params, i)
        )
        scales[DEPTH_SCALE, i] = depth
        scales[PER_DEPTH, i] = 1.0 / depth
        scales[RADIUS_SCALE, i] = size
        scales[FORCE_SCALE, i] = load
        scales[STIFFNESS_SCALE, i] = rigidity
    for i in range(count):
        scales[ENERGY_SCALE, i] = scales[FORCE_SCALE, i] * scales[DEPTH_SCALE, i] if energetic else 1.0
    unrepresentable = 0
    for row in range(SCALES):
        for i in range(count):
            scratch[i] = -scales[row, i]
            unrepresentable += not (_SMALLEST <= scales[row, i] <= _LARGEST)
        block.max_scales[row] = -block_minimum(scratch, count)
    return unrepresentable == 0

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
    kernel,
)
from roughmdr.kernels.interface import Columns, Material

_SMALLEST, _LARGEST = np.finfo(np.float64).tiny, np.finfo(np.float64).max


def natural_scales(block: Block, columns: Columns, start: int, material: Material) -> bool:
    """Fill the natural scales of a block that begins at ``start``; False where one is not representable.

    The scale of the energy, the last row, is left out unless energies can be asked for.
    """
    params, scales, max_scales = block.params, block.scales, block.max_scales
    count = block.z.size
    width, rise = columns.width, columns.rise
    for i in range(count):  # a loop of its own, so that it becomes vector code
        (depth, _), size, load, rigidity = kernel.scales(
            material.effective_modulus, material.work, width[start + i], rise[start + i], kernel.params_of(params, i)
        )
        scales[DEPTH_SCALE, i] = depth
        scales[PER_DEPTH, i] = 1.0 / depth if depth > 0.0 else np.inf
        scales[RADIUS_SCALE, i] = size
        scales[FORCE_SCALE, i] = load
        scales[STIFFNESS_SCALE, i] = rigidity
    if kernel.energetic:
        for i in range(count):
            scales[ENERGY_SCALE, i] = scales[FORCE_SCALE, i] * scales[DEPTH_SCALE, i]
    unrepresentable, rows = 0, SCALES if kernel.energetic else ENERGY_SCALE
    for row in range(rows):
        max_scales[row] = 0.0
    for i in range(count):
        for row in range(rows):  # the inner loop: the maximum of a row waits for that of the asperity before
            scale = scales[row, i]
            unrepresentable += not (_SMALLEST <= scale <= _LARGEST)
            max_scales[row] = scale if scale > max_scales[row] else max_scales[row]
    return unrepresentable == 0

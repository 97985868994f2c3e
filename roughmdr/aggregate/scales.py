"""The natural scales of a block of asperities."""

from collections.abc import Callable
from typing import Any

import numpy as np

from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.summation import least

# Rows of a block's natural scales.
DEPTH, PER_DEPTH, SIZE, LOAD, RIGIDITY, WORTH = range(6)
SCALES = 6
_SMALLEST, _LARGEST = np.finfo(np.float64).tiny, np.finfo(np.float64).max

# Names that ``specialise`` fills with the kernels of a law.
_natural: Callable[..., Any]
_own: Callable[..., Any]


def measure(
    width: Floats,
    rise: Floats,
    params: Floats,
    effective_modulus: float,
    work: float,
    energetic: bool,
    scales: Floats,
    greatest: Floats,
    terms: Floats,
) -> bool:
    """Fill the natural scales of a block, and the greatest of each; False where one is not representable.

    That of the energy is 1 unless it is ``energetic``: unless an energy is wanted.
    """
    for i in range(width.size):  # nothing but this, so that it becomes vector code
        (depth, _), size, load, rigidity = _natural(effective_modulus, work, width[i], rise[i], _own(params, i))
        scales[DEPTH, i] = depth
        scales[PER_DEPTH, i] = 1.0 / depth
        scales[SIZE, i] = size
        scales[LOAD, i] = load
        scales[RIGIDITY, i] = rigidity
    for i in range(width.size):
        scales[WORTH, i] = scales[LOAD, i] * scales[DEPTH, i] if energetic else 1.0
    strange = 0
    for row in range(SCALES):
        for i in range(width.size):
            terms[i] = -scales[row, i]
            strange += not (_SMALLEST <= scales[row, i] <= _LARGEST)
        greatest[row] = -least(terms, width.size)
    return strange == 0

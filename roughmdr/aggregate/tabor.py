"""The least Tabor number of an ensemble, and how far JKR is off there."""

import math
from collections.abc import Callable
from functools import cache
from types import FunctionType
from typing import Any, NamedTuple, cast

from roughmdr.kernels.adhesion import Adhesion, tabor_number
from roughmdr.kernels.interface import Kernels, choose
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.jit import specialise
from roughmdr.numerics.summation import BLOCK
from roughmdr.shapes import SHAPES, ProfileShape

# Names that ``specialise`` fills with the kernels of a law.
_prepare: Callable[..., Floats]
_natural: Callable[..., Any]
_own: Callable[..., Any]
_state: Callable[..., float]
_radius: Callable[..., float]

SHIFT, _AT_A_CORNER = 5.0, 2.0
"""How far the force of JKR is from Dugdale's, over the largest, where the asperities are many: at most 5 |delta_c|/std
of the heights over the Tabor number, since contacts are made sooner by w/sigma0, and at a corner of a flat 2 over the
Tabor number more. Measured with paraboloids of normal heights, |delta_c|/std from 0.1 to 10, Tabor numbers from 1 to
100, the flat down to 2, 0 and -1 std (``pipelines/adhesion_range.py``): there at most 4.3."""


class JkrValidity(NamedTuple):
    """What tells whether the range of adhesion matters."""

    tabor: float = math.inf
    """The least Tabor number [1]; inf where the strength of the attraction is not known, or none is."""
    jkr_error: float = 0.0
    """About by how much the force of JKR is off, over the largest force."""


def _extremes(
    width: Floats, rise: Floats, params: Floats, effective_modulus: float, work: float
) -> tuple[float, float]:
    """The least radius [m] and the greatest depth [m] of contacts where they let go under fixed grips in JKR.

    The radius is not above 0 where a contact is not representable.
    """
    least, deepest = math.inf, 0.0
    for start in range(0, width.size, BLOCK):
        stop = min(start + BLOCK, width.size)
        params = _prepare(effective_modulus, work, math.inf, width, rise, params, start, stop, 0.0)
        for i in range(stop - start):
            n = _own(params, i)
            (depth, _), size, _, _ = _natural(effective_modulus, work, width[start + i], rise[start + i], n)
            least = min(least, size * _radius(_state(0.0, n), n) if depth > 0.0 else 0.0)
            deepest = max(deepest, depth)
    return least, deepest


@cache
def _compiled(law: Kernels) -> Callable[..., tuple[float, float]]:
    return specialise(cast(FunctionType, _extremes), law.name, law.kernels)


def jkr_validity(
    shape: str, spread: float, columns: tuple[Floats, Floats, Floats], effective_modulus: float, adhesion: Adhesion
) -> JkrValidity:
    """Whether the range of adhesion matters; its Tabor number is 0 where a contact is not representable in JKR.

    ``spread`` is the standard deviation of the heights [m].
    """
    if not adhesion.tabor_known:
        return JkrValidity()
    law = choose(shape, Adhesion(adhesion.work), columns[2])
    radius, depth = _compiled(law)(*columns, effective_modulus, adhesion.work)
    if not 0.0 < radius < math.inf:
        return JkrValidity(0.0, math.inf)
    tabor = tabor_number(radius, effective_modulus, adhesion.work, adhesion.strength)
    kind = SHAPES[shape]
    sharp = issubclass(kind, ProfileShape) and kind.profile.flat and kind.profile.corner
    shift = SHIFT * depth / spread if spread > 0.0 else math.inf
    return JkrValidity(tabor, (shift + (_AT_A_CORNER if sharp else 0.0)) / tabor)

"""The sum over asperities, for all steps of a path: a plain loop that is handed the law.

Asperities come from the highest to the lowest and are taken in blocks. A block finds its natural scales once, then goes
through all the steps; in each it visits only its asperities within reach. What is added, and in which order, depends on
the asperities and the path alone.
"""

import math
from collections.abc import Callable
from functools import cache
from types import FunctionType
from typing import cast

import numpy as np
from numpy.typing import NDArray

from roughmdr.aggregate.contacts import (
    FOUND,
    conclude,
    force_at,
    force_found,
    hold,
    leave,
    radius_at,
    radius_found,
    settle,
    settle_curved,
    stiffness_at,
    stiffness_found,
)
from roughmdr.aggregate.error_bound import bound, bound_found, worst
from roughmdr.aggregate.scales import DEPTH, SCALES, SIZE, WORTH, measure
from roughmdr.aggregate.totals import DISSIPATED, ENERGY, ERROR, ROWS, jumps, jumps_branched, tally
from roughmdr.errors import OutOfRange
from roughmdr.kernels.adhesion import Adhesion
from roughmdr.kernels.interface import Kernels
from roughmdr.loading.staircase import Staircase
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.jit import njit, specialise
from roughmdr.numerics.summation import BLOCK, accumulate, run_on

_NOT_REPRESENTABLE = -1

# Names that ``specialise`` fills with the kernels of a law.
_adhesive: bool
_prepare: Callable[..., Floats]


@njit
def _within_reach(height: Floats, lowest: float) -> int:
    """How many of the descending heights are at least ``lowest``."""
    if height[0] < lowest:
        return 0
    if height[-1] >= lowest:
        return height.size
    low, high = 0, height.size
    while low < high:
        middle = (low + high) // 2
        if height[middle] >= lowest:
            low = middle + 1
        else:
            high = middle
    return low


def _lowest(h: float, begin: int, end: int, bottom: Floats, top: Floats, deepest: float) -> float:
    """The height from which on an asperity can be in contact: within its fold of a step of the staircase."""
    if not _adhesive:
        return float(np.nextafter(h, math.inf))  # at z = h there is no contact
    lowest = math.inf
    for j in range(begin, end):
        lowest = min(lowest, max(bottom[j], top[j] - deepest))
    return lowest


def _loop(
    height: Floats,
    width: Floats,
    rise: Floats,
    params: Floats,
    effective_modulus: float,
    work: float,
    strength: float,
    reach: float,
    separation: Floats,
    first: NDArray[np.int64],
    bottom: Floats,
    top: Floats,
    wanted: NDArray[np.bool_],
    total: Floats,
    carried: Floats,
    reached: Floats,
) -> int:
    """Add all asperities to total[row, step] (zeros before) for the rows wanted; returns the number of visits.

    That is _NOT_REPRESENTABLE where a scale of an asperity within reach is so. ``bottom`` is by ``reach`` lower than
    the flat was: from so far away the surfaces attract each other. ``reached`` (zeros before) becomes the contact
    radius of each where the flat is closest.
    """
    visits = 0
    turn = np.argmin(separation)
    closest = separation[turn] - reach
    scales, greatest = np.empty((SCALES, BLOCK)), np.empty(SCALES)
    held, held_before, found, terms = np.empty(BLOCK), np.empty(BLOCK), np.empty((FOUND, BLOCK)), np.empty(BLOCK)
    energetic = wanted[ENERGY] or wanted[DISSIPATED]
    for start in range(0, height.size, BLOCK):
        block = slice(start, min(start + BLOCK, height.size))
        z = height[block]
        if _within_reach(z, closest) == 0:
            break
        n = _prepare(effective_modulus, work, strength, width, rise, params, start, start + z.size, 0.0)
        if not measure(width[block], rise[block], n, effective_modulus, work, energetic, scales, greatest, terms):
            return _NOT_REPRESENTABLE
        count_before = 0
        held[:] = 0.0
        held_before[:] = 0.0
        for step in range(separation.size):
            h = separation[step]
            begin, end = first[step], first[step + 1]
            count = _within_reach(z, _lowest(h, begin, end, bottom, top, greatest[DEPTH]))
            if count > 0:
                visits += count
                settle(count, z, n, h, reach, begin, end, bottom, top, scales, held, found, terms)
                if wanted[ERROR]:
                    retracted = end - begin > 1 or top[begin] > bottom[begin]
                    error = bound(count, z, n, h, retracted, scales, greatest, held, found, terms)
                    accumulate(total[ERROR], carried[ERROR], step, error)
            if _adhesive:
                held[count:count_before] = 0.0  # out of reach
                if wanted[DISSIPATED]:
                    spent = jumps(max(count, count_before), n, scales[WORTH], held, held_before, terms)
                    accumulate(total[DISSIPATED], carried[DISSIPATED], step, spent)
                count_before = count
            if step == turn:
                for i in range(count):
                    if not _adhesive or held[i] > 0.0:
                        reached[start + i] = scales[SIZE, i] * radius_at(i, found, n)
            if count > 0:
                tally(count, n, scales, held, found, terms, wanted, step, total, carried)
    for row in range(ROWS):
        for step in range(separation.size):
            total[row, step] += carried[row, step]
    if wanted[DISSIPATED]:
        run_on(total[DISSIPATED])
    return visits


@cache
def _compiled(law: Kernels) -> Callable[..., int]:
    kernels, together = law.kernels, law.answer is not None
    parts = {
        "measure": measure,
        "_lowest": _lowest,
        "hold": hold,
        "radius_at": radius_found if together else radius_at,
        "force_at": force_found if together else force_at,
        "stiffness_at": stiffness_found if together else stiffness_at,
        "conclude": conclude if together else leave,
        "settle": settle_curved if law.curved else settle,
        "worst": worst,
        "bound": bound_found if together else bound,
        "jumps": jumps_branched if law.branched else jumps,
        "tally": tally,
    }
    for name, part in parts.items():
        kernels[name] = specialise(cast(FunctionType, part), law.name, kernels, inline=True)
    return specialise(cast(FunctionType, _loop), law.name, kernels)


def add_asperities(
    law: Kernels,
    height: Floats,
    columns: tuple[Floats, Floats, Floats],
    effective_modulus: float,
    adhesion: Adhesion,
    separation: Floats,
    memory: Staircase,
    rows: set[int],
) -> tuple[Floats, Floats, int]:
    """Totals over the asperities, [row, step] in SI, the contact radius of each [m] where the flat is closest, and the
    number of visits (asperities times steps).

    height [m] descends; columns are width [m], rise [m] and form; only the ``rows`` asked for are computed. OutOfRange
    where the contact of an asperity within reach is not representable.
    """
    wanted = np.zeros(ROWS, dtype=np.bool_)
    wanted[list(rows)] = True
    total, carried = np.zeros((ROWS, separation.size)), np.zeros((ROWS, separation.size))
    reached = np.zeros_like(height)
    how = effective_modulus, adhesion.work, adhesion.strength, adhesion.range
    way = separation, memory.first, memory.bottom - adhesion.range, memory.top
    visits = _compiled(law)(height, *columns, *how, *way, wanted, total, carried, reached)
    if visits == _NOT_REPRESENTABLE or not np.isfinite(total).all():
        raise OutOfRange(
            f"the contact of an asperity is not representable: {law.name} with "
            f"effective modulus {effective_modulus:g} Pa, "
            f"{adhesion}, separation down to {separation.min():g} m"
        )
    return total, reached, visits

"""The sum over asperities, for all steps of a path: a plain loop that is handed the law.

Asperities come from the highest to the lowest and are taken in blocks. A block finds its natural scales once, then goes
through all the steps; in each it visits only its asperities within reach. What is added, and in which order, depends on
the asperities and the path alone.
"""

import math
from collections.abc import Callable
from functools import cache
from types import FunctionType
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from roughmdr._jit import njit, specialise
from roughmdr.aggregate.block import BLOCK, accumulate, add_up, least, run_on
from roughmdr.aggregate.staircase import Staircase
from roughmdr.arguments import Floats
from roughmdr.errors import OutOfRange
from roughmdr.kernels.laws import Law

# Rows of the totals.
FORCE, RADIUS, AREA, STIFFNESS, COUNT, ENERGY, DISSIPATED, ERROR = range(8)
ROWS = 8

_UNIT = 2.0**-53  # the largest relative error of one rounding
_KERNEL_ERROR = 1e-13  # of the force of a contact over its natural scale, as the kernels are tested

_NOT_REPRESENTABLE = -1

# Rows of a block's natural scales.
_DEPTH, _PER_DEPTH, _SIZE, _LOAD, _RIGIDITY, _WORTH = range(6)
_SCALES = 6
_SMALLEST, _LARGEST = np.finfo(np.float64).tiny, np.finfo(np.float64).max

# Names that ``specialise`` fills with the kernels of a law.
_adhesive: bool
_natural: Callable[..., Any]
_state: Callable[..., float]
_radius: Callable[..., float]
_force: Callable[..., float]
_stiffness: Callable[..., float]
_energy: Callable[..., float]


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


def _measure(
    width: Floats,
    rise: Floats,
    form: Floats,
    modulus: float,
    work: float,
    wanted: NDArray[np.bool_],
    scales: Floats,
    greatest: Floats,
    terms: Floats,
) -> bool:
    """Fill the natural scales of a block, and the greatest of each; False where one is not representable.

    That of the energy is 1 unless an energy is wanted.
    """
    for i in range(width.size):  # nothing but this, so that it becomes vector code
        (depth, _), size, load, rigidity = _natural(modulus, work, width[i], rise[i], form[i])
        scales[_DEPTH, i] = depth
        scales[_PER_DEPTH, i] = 1.0 / depth
        scales[_SIZE, i] = size
        scales[_LOAD, i] = load
        scales[_RIGIDITY, i] = rigidity
    energetic = wanted[ENERGY] or wanted[DISSIPATED]
    for i in range(width.size):
        scales[_WORTH, i] = scales[_LOAD, i] * scales[_DEPTH, i] if energetic else 1.0
    strange = 0
    for row in range(_SCALES):
        for i in range(width.size):
            terms[i] = -scales[row, i]
            strange += not (_SMALLEST <= scales[row, i] <= _LARGEST)
        greatest[row] = -least(terms, width.size)
    return strange == 0


def _lowest(h: float, begin: int, end: int, bottom: Floats, top: Floats, deepest: float) -> float:
    """The height from which on an asperity can be in contact: within its fold of a step of the staircase."""
    if not _adhesive:
        return float(np.nextafter(h, math.inf))  # at z = h there is no contact
    lowest = math.inf
    for j in range(begin, end):
        lowest = min(lowest, max(bottom[j], top[j] - deepest))
    return lowest


def _settle(
    count: int,
    z: Floats,
    form: Floats,
    h: float,
    begin: int,
    end: int,
    bottom: Floats,
    top: Floats,
    scales: Floats,
    held: Floats,
    state: Floats,
) -> None:
    """The state of the first ``count`` contacts with the flat at h, and whether each holds on (1) or not (0).

    Without adhesion all of them do, and ``held`` is left alone.
    """
    depth, per_depth = scales[_DEPTH], scales[_PER_DEPTH]
    if _adhesive:
        low, high = bottom[begin], top[begin]
        for i in range(count):
            held[i] = 1.0 if (z[i] >= low) & (z[i] - high > -depth[i]) else 0.0
        for j in range(begin + 1, end):
            low, high = bottom[j], top[j]
            for i in range(count):
                held[i] = 1.0 if (z[i] >= low) & (z[i] - high > -depth[i]) else held[i]
        for i in range(count):
            x = ((z[i] - h) + depth[i]) * per_depth[i]
            state[i] = _state(x if x > 0.0 else 0.0, form[i])
    else:
        for i in range(count):
            state[i] = _state((z[i] - h) * per_depth[i], form[i])


def _tally(
    count: int,
    form: Floats,
    scales: Floats,
    held: Floats,
    state: Floats,
    terms: Floats,
    wanted: NDArray[np.bool_],
    step: int,
    total: Floats,
    carried: Floats,
) -> None:
    """Add the first ``count`` asperities of a block to the wanted totals of a step.

    Each total chooses among its terms as it makes them: a pass of its own over the block for that costs a tenth of all.
    """
    size, load, rigidity, worth = scales[_SIZE], scales[_LOAD], scales[_RIGIDITY], scales[_WORTH]
    if wanted[FORCE]:
        for i in range(count):
            terms[i] = load[i] * _force(state[i], form[i]) if not _adhesive or held[i] > 0.0 else 0.0
        accumulate(total[FORCE], carried[FORCE], step, add_up(terms, count))
    if wanted[RADIUS]:
        for i in range(count):
            terms[i] = size[i] * _radius(state[i], form[i]) if not _adhesive or held[i] > 0.0 else 0.0
        accumulate(total[RADIUS], carried[RADIUS], step, add_up(terms, count))
    if wanted[AREA]:
        for i in range(count):
            a = size[i] * _radius(state[i], form[i])
            terms[i] = math.pi * (a * a) if not _adhesive or held[i] > 0.0 else 0.0
        accumulate(total[AREA], carried[AREA], step, add_up(terms, count))
    if wanted[STIFFNESS]:
        for i in range(count):
            terms[i] = rigidity[i] * _stiffness(state[i], form[i]) if not _adhesive or held[i] > 0.0 else 0.0
        accumulate(total[STIFFNESS], carried[STIFFNESS], step, add_up(terms, count))
    if wanted[ENERGY]:
        for i in range(count):
            terms[i] = worth[i] * _energy(state[i], form[i]) if not _adhesive or held[i] > 0.0 else 0.0
        accumulate(total[ENERGY], carried[ENERGY], step, add_up(terms, count))
    if wanted[COUNT]:
        contacts = float(count)
        if _adhesive:
            contacts = add_up(held, count)  # the last use of held: it is spoilt
        accumulate(total[COUNT], carried[COUNT], step, contacts)


def _jumps(count: int, form: Floats, worth: Floats, held: Floats, held_before: Floats, terms: Floats) -> float:
    """The energy [J] lost in the jumps of a block since the step before, of whose contacts it takes the place.

    Between two steps the flat moves one way, so that a contact made or lost on the way has jumped once: on at first
    touch, where it goes from no energy to U < 0, or off at its fold, from U > 0 to none.
    """
    for i in range(count):
        made = held[i] > held_before[i]
        lost = held[i] < held_before[i]
        if made or lost:
            energy = _energy(_state(1.0 if made else 0.0, form[i]), form[i])
            terms[i] = worth[i] * (-energy if made else energy)
        else:
            terms[i] = 0.0
        held_before[i] = held[i]
    return add_up(terms, count)


def _bound(
    count: int,
    z: Floats,
    form: Floats,
    mixed: bool,
    h: float,
    retracted: bool,
    greatest: Floats,
    held: Floats,
    state: Floats,
    terms: Floats,
) -> float:
    """A bound on the error [N] of what the first ``count`` asperities of a block add to the force.

    Each force is off by |k| times the rounding of z - h and of the fold, and by what its kernel is off. k grows along
    the branch, so that |k| is largest in the least or the greatest state: two calls bound a block of one form. Only
    a retraction brings a state below that of first touch, x = 1.
    """
    deepest = greatest[_DEPTH] if _adhesive else 0.0
    high = _state(((z[0] - h) + deepest) * greatest[_PER_DEPTH], form[0])
    low = high
    if _adhesive:
        low = _state(1.0, form[0])
        if retracted:
            for i in range(count):
                terms[i] = state[i] if held[i] > 0.0 else math.inf
            low = max(min(low, least(terms, count)), _UNIT)
    slope = max(abs(_stiffness(low, form[0])), abs(_stiffness(high, form[0])))
    least_push = 1.0 if _adhesive else 0.0  # without adhesion the natural force is no force of this contact
    push = max(least_push, abs(_force(high, form[0])))
    if mixed:
        for i in range(count):
            slope = max(slope, abs(_stiffness(max(state[i], low), form[i])))
            push = max(push, abs(_force(state[i], form[i])))
    rounding = 4.0 * _UNIT * (max(abs(z[0]), abs(z[count - 1])) + abs(h) + deepest)
    each = slope * greatest[_RIGIDITY] * rounding + _KERNEL_ERROR * push * greatest[_LOAD]
    return float(count * each)


def _loop(
    height: Floats,
    width: Floats,
    rise: Floats,
    form: Floats,
    modulus: float,
    work: float,
    separation: Floats,
    first: NDArray[np.int64],
    bottom: Floats,
    top: Floats,
    wanted: NDArray[np.bool_],
    total: Floats,
    carried: Floats,
) -> int:
    """Add all asperities to total[row, step] (zeros before) for the rows wanted; returns the number of visits.

    That is _NOT_REPRESENTABLE where a scale of an asperity within reach is so.
    """
    visits = 0
    closest = np.min(separation)
    scales, greatest = np.empty((_SCALES, BLOCK)), np.empty(_SCALES)
    held, held_before, state, terms = np.empty(BLOCK), np.empty(BLOCK), np.empty(BLOCK), np.empty(BLOCK)
    for start in range(0, height.size, BLOCK):
        block = slice(start, min(start + BLOCK, height.size))
        z, n = height[block], form[block]
        if z[0] < closest:
            break
        mixed = bool(np.any(n != n[0]))
        if not _measure(width[block], rise[block], n, modulus, work, wanted, scales, greatest, terms):
            return _NOT_REPRESENTABLE
        count_before = 0
        held_before[:] = 0.0
        for step in range(separation.size):
            h = separation[step]
            begin, end = first[step], first[step + 1]
            count = _within_reach(z, _lowest(h, begin, end, bottom, top, greatest[_DEPTH]))
            if count > 0:
                visits += count
                _settle(count, z, n, h, begin, end, bottom, top, scales, held, state)
                if wanted[ERROR]:
                    retracted = end - begin > 1 or top[begin] > bottom[begin]
                    bound = _bound(count, z, n, mixed, h, retracted, greatest, held, state, terms)
                    accumulate(total[ERROR], carried[ERROR], step, bound)
            if _adhesive and wanted[DISSIPATED]:
                held[count:count_before] = 0.0
                spent = _jumps(max(count, count_before), n, scales[_WORTH], held, held_before, terms)
                accumulate(total[DISSIPATED], carried[DISSIPATED], step, spent)
                count_before = count
            if count > 0:
                _tally(count, n, scales, held, state, terms, wanted, step, total, carried)
    for row in range(ROWS):
        for step in range(separation.size):
            total[row, step] += carried[row, step]
    if wanted[DISSIPATED]:
        run_on(total[DISSIPATED])
    return visits


@cache
def _compiled(law: Law) -> Callable[..., int]:
    kernels: dict[str, object] = {
        "_adhesive": law.adhesive,
        "_natural": law.natural,
        "_state": law.state,
        "_radius": law.radius,
        "_force": law.force,
        "_stiffness": law.stiffness,
        "_energy": law.energy,
    }
    for part in (_measure, _lowest, _settle, _bound, _jumps, _tally):
        kernels[part.__name__] = specialise(cast(FunctionType, part), law.name, kernels, inline=True)
    return specialise(cast(FunctionType, _loop), law.name, kernels)


def add_asperities(
    law: Law,
    height: Floats,
    columns: tuple[Floats, Floats, Floats],
    modulus: float,
    work: float,
    separation: Floats,
    memory: Staircase,
    rows: set[int],
) -> tuple[Floats, int]:
    """Totals over the asperities, [row, step] in SI, and the number of visits (asperities times steps).

    height [m] descends; columns are width [m], rise [m] and form; only the ``rows`` asked for are computed. OutOfRange
    where the contact of an asperity within reach is not representable.
    """
    wanted = np.zeros(ROWS, dtype=np.bool_)
    wanted[list(rows)] = True
    total, carried = np.zeros((ROWS, separation.size)), np.zeros((ROWS, separation.size))
    visits = _compiled(law)(height, *columns, modulus, work, separation, *memory, wanted, total, carried)
    if visits == _NOT_REPRESENTABLE or not np.isfinite(total).all():
        raise OutOfRange(
            f"the contact of an asperity is not representable: {law.name} with modulus {modulus:g} Pa, "
            f"work {work:g} J/m^2, separation down to {separation.min():g} m"
        )
    return total, visits

"""The sum over asperities, for all steps of a path: a plain loop that is handed the law.

Asperities come from the highest to the lowest and are taken in blocks. A block finds its natural scales once, then goes
through all the steps; in each it visits only its asperities within reach. What is added, and in which order, depends on
the asperities and the path alone: within a block by halves, over the blocks with the rounding errors carried along
(A. Neumaier, Z. angew. Math. Mech. 54 (1974) 39).
"""

import math
from collections.abc import Callable
from functools import cache
from types import FunctionType
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from roughmdr._jit import njit, specialise
from roughmdr.aggregate.staircase import Staircase
from roughmdr.kernels.laws import Law
from roughmdr.shapes.base import Floats

BLOCK = 256

# Rows of the totals.
FORCE, RADIUS, AREA, STIFFNESS, COUNT, MAGNITUDE = range(6)
ROWS = 6

# Rows of a block's natural scales.
_DEPTH, _PER_DEPTH, _SIZE, _LOAD, _RIGIDITY = range(5)

# Names that ``specialise`` fills with the kernels of a law.
_adhesive: bool
_natural: Callable[..., Any]
_state: Callable[..., float]
_radius: Callable[..., float]
_force: Callable[..., float]
_stiffness: Callable[..., float]


@njit
def _add_up(terms: Floats, count: int) -> float:
    """The sum of the first ``count`` terms, by halves over the whole block; the terms are spoilt."""
    for i in range(count, BLOCK):
        terms[i] = 0.0
    half = BLOCK // 2
    while half > 0:
        for i in range(half):
            terms[i] += terms[i + half]
        half //= 2
    return float(terms[0])


@njit
def _accumulate(total: Floats, carried: Floats, step: int, term: float) -> None:
    """total[step] += term, with the rounding error added to carried[step]."""
    before = total[step]
    after = before + term
    if abs(before) >= abs(term):
        carried[step] += (before - after) + term
    else:
        carried[step] += (term - after) + before
    total[step] = after


@njit
def _within_reach(height: Floats, lowest: float) -> int:
    """How many of the descending heights are at least ``lowest``."""
    low, high = 0, height.size
    while low < high:
        middle = (low + high) // 2
        if height[middle] >= lowest:
            low = middle + 1
        else:
            high = middle
    return low


def _measure(width: Floats, rise: Floats, form: Floats, modulus: float, work: float, scales: Floats) -> float:
    """Fill the natural scales of a block; returns how far its deepest fold lies below the onset of contact [m]."""
    deepest = 0.0
    for i in range(width.size):
        depth, size, load, rigidity = _natural(modulus, work, width[i], rise[i], form[i])
        scales[_DEPTH, i] = depth[0]
        scales[_PER_DEPTH, i] = 1.0 / depth[0]
        scales[_SIZE, i] = size
        scales[_LOAD, i] = load
        scales[_RIGIDITY, i] = rigidity
        if _adhesive:
            deepest = max(deepest, depth[0])
    return deepest


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
            state[i] = _state(max(((z[i] - h) + depth[i]) * per_depth[i], 0.0), form[i])
    else:
        for i in range(count):
            state[i] = _state(max((z[i] - h) * per_depth[i], 0.0), form[i])


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
    """Add the first ``count`` asperities of a block to the wanted totals of a step."""
    size, load, rigidity = scales[_SIZE], scales[_LOAD], scales[_RIGIDITY]
    if wanted[FORCE]:
        for i in range(count):
            terms[i] = load[i] * _force(state[i], form[i]) if not _adhesive or held[i] > 0.0 else 0.0
        _accumulate(total[FORCE], carried[FORCE], step, _add_up(terms, count))
    if wanted[MAGNITUDE]:
        for i in range(count):
            terms[i] = abs(load[i] * _force(state[i], form[i])) if not _adhesive or held[i] > 0.0 else 0.0
        _accumulate(total[MAGNITUDE], carried[MAGNITUDE], step, _add_up(terms, count))
    if wanted[RADIUS]:
        for i in range(count):
            terms[i] = size[i] * _radius(state[i], form[i]) if not _adhesive or held[i] > 0.0 else 0.0
        _accumulate(total[RADIUS], carried[RADIUS], step, _add_up(terms, count))
    if wanted[AREA]:
        for i in range(count):
            a = size[i] * _radius(state[i], form[i])
            terms[i] = math.pi * (a * a) if not _adhesive or held[i] > 0.0 else 0.0
        _accumulate(total[AREA], carried[AREA], step, _add_up(terms, count))
    if wanted[STIFFNESS]:
        for i in range(count):
            terms[i] = rigidity[i] * _stiffness(state[i], form[i]) if not _adhesive or held[i] > 0.0 else 0.0
        _accumulate(total[STIFFNESS], carried[STIFFNESS], step, _add_up(terms, count))
    if wanted[COUNT]:
        contacts = float(count)
        if _adhesive:
            contacts = _add_up(held, count)  # the last use of held: it is spoilt
        _accumulate(total[COUNT], carried[COUNT], step, contacts)


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
    """Add all asperities to total[row, step] (zeros before) for the rows wanted; returns the number of visits."""
    visits = 0
    closest = np.min(separation)
    scales = np.empty((5, BLOCK))
    held, state, terms = np.empty(BLOCK), np.empty(BLOCK), np.empty(BLOCK)
    for start in range(0, height.size, BLOCK):
        block = slice(start, min(start + BLOCK, height.size))
        z, n = height[block], form[block]
        if z[0] < closest:
            break
        deepest = _measure(width[block], rise[block], n, modulus, work, scales)
        for step in range(separation.size):
            h = separation[step]
            begin, end = first[step], first[step + 1]
            count = _within_reach(z, _lowest(h, begin, end, bottom, top, deepest))
            if count > 0:
                visits += count
                _settle(count, z, n, h, begin, end, bottom, top, scales, held, state)
                _tally(count, n, scales, held, state, terms, wanted, step, total, carried)
    for row in range(ROWS):
        for step in range(separation.size):
            total[row, step] += carried[row, step]
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
    }
    parts = {
        part.__name__: specialise(cast(FunctionType, part), law.name, kernels, inline=True)
        for part in (_measure, _lowest, _settle, _tally)
    }
    return specialise(cast(FunctionType, _loop), law.name, {**parts})


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

    height [m] descends; columns are width [m], rise [m] and form; only the ``rows`` asked for are computed.
    """
    wanted = np.zeros(ROWS, dtype=np.bool_)
    wanted[list(rows)] = True
    total, carried = np.zeros((ROWS, separation.size)), np.zeros((ROWS, separation.size))
    visited = _compiled(law)(height, *columns, modulus, work, separation, *memory, wanted, total, carried)
    return total, visited

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

# Names that ``specialise`` fills.
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
    """Fill total[row, step] (zeros before) for the rows wanted; returns how often an asperity was visited."""
    visited = 0
    closest = np.min(separation)
    depth, per_depth = np.empty(BLOCK), np.empty(BLOCK)
    size, load, rigidity = np.empty(BLOCK), np.empty(BLOCK), np.empty(BLOCK)
    state, held, terms = np.empty(BLOCK), np.empty(BLOCK), np.empty(BLOCK)
    for start in range(0, height.size, BLOCK):
        z = height[start : start + BLOCK]
        n = form[start : start + BLOCK]
        if z[0] < closest:
            break
        deepest = 0.0
        for i in range(z.size):
            fold, size[i], load[i], rigidity[i] = _natural(modulus, work, width[start + i], rise[start + i], n[i])
            depth[i] = fold[0]
            per_depth[i] = 1.0 / fold[0]
            if _adhesive:
                deepest = max(deepest, fold[0])
        for step in range(separation.size):
            h = separation[step]
            lowest = math.inf
            for j in range(first[step], first[step + 1]):
                lowest = min(lowest, max(bottom[j], top[j] - deepest))
            if not _adhesive:
                lowest = np.nextafter(h, math.inf)  # at z = h nothing is in contact
            count = _within_reach(z, lowest)
            if count == 0:
                continue
            visited += count
            if _adhesive:
                low, high = bottom[first[step]], top[first[step]]
                for i in range(count):
                    held[i] = 1.0 if (z[i] >= low) & (z[i] - high > -depth[i]) else 0.0
                for j in range(first[step] + 1, first[step + 1]):
                    low, high = bottom[j], top[j]
                    for i in range(count):
                        held[i] = 1.0 if (z[i] >= low) & (z[i] - high > -depth[i]) else held[i]
                for i in range(count):
                    state[i] = _state(max(((z[i] - h) + depth[i]) * per_depth[i], 0.0), n[i])
            else:
                for i in range(count):
                    state[i] = _state(max((z[i] - h) * per_depth[i], 0.0), n[i])
            if wanted[FORCE] or wanted[MAGNITUDE]:
                for i in range(count):
                    terms[i] = load[i] * _force(state[i], n[i]) if not _adhesive or held[i] > 0.0 else 0.0
                if wanted[MAGNITUDE]:
                    magnitude = 0.0
                    for i in range(count):
                        magnitude += abs(terms[i])
                    _accumulate(total[MAGNITUDE], carried[MAGNITUDE], step, magnitude)
                if wanted[FORCE]:
                    _accumulate(total[FORCE], carried[FORCE], step, _add_up(terms, count))
            if wanted[RADIUS]:
                for i in range(count):
                    terms[i] = size[i] * _radius(state[i], n[i]) if not _adhesive or held[i] > 0.0 else 0.0
                _accumulate(total[RADIUS], carried[RADIUS], step, _add_up(terms, count))
            if wanted[AREA]:
                for i in range(count):
                    a = size[i] * _radius(state[i], n[i])
                    terms[i] = math.pi * (a * a) if not _adhesive or held[i] > 0.0 else 0.0
                _accumulate(total[AREA], carried[AREA], step, _add_up(terms, count))
            if wanted[STIFFNESS]:
                for i in range(count):
                    terms[i] = rigidity[i] * _stiffness(state[i], n[i]) if not _adhesive or held[i] > 0.0 else 0.0
                _accumulate(total[STIFFNESS], carried[STIFFNESS], step, _add_up(terms, count))
            if wanted[COUNT]:
                contacts = float(count)
                if _adhesive:
                    contacts = _add_up(held, count)  # the last use of held: it is spoilt
                _accumulate(total[COUNT], carried[COUNT], step, contacts)
    for row in range(ROWS):
        for step in range(separation.size):
            total[row, step] += carried[row, step]
    return visited


@cache
def _compiled(law: Law) -> Callable[..., int]:
    return specialise(
        cast(FunctionType, _loop),
        law.name,
        _adhesive=law.adhesive,
        _natural=law.natural,
        _state=law.state,
        _radius=law.radius,
        _force=law.force,
        _stiffness=law.stiffness,
    )


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

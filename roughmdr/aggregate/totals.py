"""What is added up over the asperities of a block, at one step."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from roughmdr.aggregate.contacts import STATE
from roughmdr.aggregate.scales import LOAD, RIGIDITY, SIZE, WORTH
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.summation import accumulate, add_up

# Rows of the totals.
FORCE, RADIUS, AREA, STIFFNESS, COUNT, ENERGY, DISSIPATED, ERROR = range(8)
ROWS = 8

# Names that ``specialise`` fills with the kernels of a law, and the parts of ``settle``.
_adhesive: bool
_cohesive: bool
_state: Callable[..., float]
_energy: Callable[..., float]
_own: Callable[..., Any]
_spent: Callable[..., float]
radius_at: Callable[..., float]
force_at: Callable[..., float]
stiffness_at: Callable[..., float]


def tally(
    count: int,
    params: Floats,
    scales: Floats,
    held: Floats,
    found: Floats,
    terms: Floats,
    wanted: NDArray[np.bool_],
    step: int,
    total: Floats,
    carried: Floats,
) -> None:
    """Add the first ``count`` asperities of a block to the wanted totals of a step.

    Each total chooses among its terms as it makes them: a pass of its own over the block for that costs a tenth of all.
    """
    size, load, rigidity, worth = scales[SIZE], scales[LOAD], scales[RIGIDITY], scales[WORTH]
    if wanted[FORCE]:
        for i in range(count):
            terms[i] = load[i] * force_at(i, found, params) if not _adhesive or held[i] > 0.0 else 0.0
        accumulate(total[FORCE], carried[FORCE], step, add_up(terms, count))
    if wanted[RADIUS]:
        for i in range(count):
            terms[i] = size[i] * radius_at(i, found, params) if not _adhesive or held[i] > 0.0 else 0.0
        accumulate(total[RADIUS], carried[RADIUS], step, add_up(terms, count))
    if wanted[AREA]:
        for i in range(count):
            a = size[i] * radius_at(i, found, params)
            terms[i] = math.pi * (a * a) if not _adhesive or held[i] > 0.0 else 0.0
        accumulate(total[AREA], carried[AREA], step, add_up(terms, count))
    if wanted[STIFFNESS]:
        for i in range(count):
            terms[i] = rigidity[i] * stiffness_at(i, found, params) if not _adhesive or held[i] > 0.0 else 0.0
        accumulate(total[STIFFNESS], carried[STIFFNESS], step, add_up(terms, count))
    if wanted[ENERGY]:
        for i in range(count):
            terms[i] = worth[i] * _energy(found[STATE, i], _own(params, i)) if not _adhesive or held[i] > 0.0 else 0.0
        accumulate(total[ENERGY], carried[ENERGY], step, add_up(terms, count))
    if wanted[COUNT]:
        for i in range(count):
            touching = not _cohesive or radius_at(i, found, params) > 0.0
            terms[i] = 1.0 if touching and (not _adhesive or held[i] > 0.0) else 0.0
        accumulate(total[COUNT], carried[COUNT], step, add_up(terms, count))


def jumps(count: int, params: Floats, worth: Floats, held: Floats, held_before: Floats, terms: Floats) -> float:
    """The energy [J] lost in the jumps of a block since the step before, of whose contacts it takes the place.

    Between two steps the flat moves one way, so that a contact made or lost on the way has jumped once: on at first
    touch, where it goes from no energy to U < 0, or off at its fold, from U > 0 to none.
    """
    for i in range(count):
        made = held[i] > held_before[i]
        lost = held[i] < held_before[i]
        if made or lost:
            energy = _energy(_state(1.0 if made else 0.0, _own(params, i)), _own(params, i))
            terms[i] = worth[i] * (-energy if made else energy)
        else:
            terms[i] = 0.0
        held_before[i] = held[i]
    return add_up(terms, count)


def jumps_branched(
    count: int, params: Floats, worth: Floats, held: Floats, held_before: Floats, terms: Floats
) -> float:
    """The same where a contact also jumps from one branch to another; ``held`` is the number of the branch."""
    for i in range(count):
        terms[i] = worth[i] * _spent(held_before[i], held[i], _own(params, i)) if held[i] != held_before[i] else 0.0
        held_before[i] = held[i]
    return add_up(terms, count)

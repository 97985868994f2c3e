"""The sum over asperities, for all steps of a path: a plain loop that is handed its kernels.

Asperities come from the highest to the lowest and are taken in blocks. For each block the natural scales are found
once; then the loop goes through all the steps and visits, in each, only the asperities that can be in contact. The
terms and their order depend on the asperities and the path alone.
"""

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from roughmdr.aggregate.block import (
    DEPTH_SCALE,
    FORCE_SCALE,
    RADIUS_SCALE,
    SCALES,
    Block,
    SumKernels,
    Totals,
    kernel,
    prepare_of,
)
from roughmdr.aggregate.contacts import (
    follow_branches,
    follow_either,
    follow_pairs,
    force_of_state,
    found_force,
    found_radius,
    found_stiffness,
    guess_states,
    place,
    radius_of_state,
    solve_closed,
    solve_each,
    solve_iterative,
    solve_refined,
    stiffness_of_state,
    update_contact,
)
from roughmdr.aggregate.error_bound import bound_block, bound_each, no_terms, total_error
from roughmdr.aggregate.scales import natural_scales
from roughmdr.aggregate.totals import (
    CONDUCTANCE,
    DISSIPATED,
    ENERGY,
    ERROR,
    RADIUS,
    ROWS,
    add_totals,
    jumps,
    jumps_between_branches,
    jumps_of_either,
)
from roughmdr.errors import OutOfRange
from roughmdr.kernels.adhesion import Adhesion
from roughmdr.kernels.blocks import BEFORE, CONTACT_ROWS, IN_CONTACT, evaluate_all, find_by_steps, find_near
from roughmdr.kernels.interface import Columns, Kernels, Material
from roughmdr.loading.staircase import Staircase, no_memory
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.jit import njit, once, specialise
from roughmdr.numerics.summation import BLOCK, accumulate, cumulative_sum

_NOT_REPRESENTABLE = -1
_ENERGIES = {ENERGY, DISSIPATED}
# Inlined by LLVM: inlined by numba they are no vector code.
_OF_ONE_CONTACT = {"radius_at", "force_at", "stiffness_at"}


class Steps(NamedTuple):
    """The steps of a path."""

    separation: Floats
    """[m]"""
    turn: int
    """The step at which the flat is closest."""
    memory: Staircase
    """Staircase of the path. Bottoms are lower by the adhesion range, where attraction begins; without adhesion they
    are the next float above the flat, as asperities of its height do not touch."""


@njit
def count_above(height: Floats, lowest: float) -> int:
    """Return how many of the descending heights are at least ``lowest``."""
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


def lowest_in_contact(begin: int, end: int, memory: Staircase, deepest: float) -> float:
    """Return the lowest height that can be in contact: the least max(bottom, top - deepest) of the staircase."""
    if not kernel.adhesive:
        return float(memory.bottom[begin])
    lowest = math.inf
    for j in range(begin, end):
        lowest = min(lowest, max(memory.bottom[j], memory.top[j] - deepest))
    return lowest


def _loop(
    height: Floats,
    columns: Columns,
    material: Material,
    adhesion_range: float,
    steps: Steps,
    prepare: Callable[..., Any],
    totals: Totals,
) -> int:
    """Add all asperities to the totals that are wanted (zeros before); return the number of visits.

    Return _NOT_REPRESENTABLE where a scale of an asperity in contact is not representable. ``prepare`` as in
    ``Kernels``; ``compiled_sum`` says which functions the names of ``kernel`` stand for.
    """
    visits = 0
    separation, turn, memory = steps.separation, steps.turn, steps.memory
    closest = separation[turn] - adhesion_range
    scales, contacts, max_scales = np.empty((SCALES, BLOCK)), np.empty((CONTACT_ROWS, BLOCK)), np.empty(SCALES)
    total, compensation, wanted = totals.total, totals.compensation, totals.wanted
    if kernel.shared:
        params = prepare(material, columns, 0, height.size, 0.0, height[0] - separation[turn])
    for start in range(0, height.size, BLOCK):
        z = height[start : min(start + BLOCK, height.size)]
        if z[0] < closest:
            break
        if not kernel.shared:
            params = prepare(material, columns, start, start + z.size, 0.0, z[0] - separation[turn])
        block = Block(z, params, scales, max_scales, contacts)
        if not kernel.natural_scales(block, columns, start, material):
            visits = _NOT_REPRESENTABLE
            break
        count_before = 0
        if kernel.adhesive:
            for i in range(BLOCK):  # one by one, here and below: slices take long to compile
                contacts[IN_CONTACT, i] = contacts[BEFORE, i] = 0.0
        for step in range(separation.size):
            h = separation[step]
            begin, end = memory.first[step], memory.first[step + 1]
            count = count_above(z, kernel.lowest_in_contact(begin, end, memory, max_scales[DEPTH_SCALE]))
            if count > 0:
                visits += count
                kernel.solve_contacts(count, block, h, adhesion_range, memory, begin, end)
                if wanted[ERROR]:
                    retracted = end - begin > 1 or memory.top[begin] > memory.bottom[begin]
                    error = kernel.error_bound(count, block, h, retracted)
                    total[ERROR, step], compensation[ERROR, step] = accumulate(
                        total[ERROR, step], compensation[ERROR, step], error
                    )
            if kernel.adhesive:
                for i in range(count, count_before):
                    contacts[IN_CONTACT, i] = 0.0  # too low
                if kernel.energetic and wanted[DISSIPATED]:
                    dissipated = kernel.jumps(max(count, count_before), block)
                    total[DISSIPATED, step], compensation[DISSIPATED, step] = accumulate(
                        total[DISSIPATED, step], compensation[DISSIPATED, step], dissipated
                    )
                count_before = count
            if step == turn:
                for i in range(count):
                    if not kernel.adhesive or contacts[IN_CONTACT, i] > 0.0:
                        totals.closest[0, start + i] = scales[RADIUS_SCALE, i] * kernel.radius_at(contacts, params, i)
                        totals.closest[1, start + i] = scales[FORCE_SCALE, i] * kernel.force_at(contacts, params, i)
            if count > 0:
                kernel.add_totals(count, block, step, totals)
    return visits


@once
def compiled_sum(kernels: Kernels, *, energetic: bool) -> SumKernels:
    """Return the kernels with the parts of the sum, compiled with them; without energies where not ``energetic``."""
    name, together = kernels.name + ("_energetic" if energetic else ""), kernels.found_together
    whole = SumKernels(name)
    solve = solve_iterative if kernels.iterative else solve_refined if kernels.refinements > 0 else solve_closed
    solve = solve_each if kernels.one_by_one else solve
    follow = follow_either if kernels.rows_tell else follow_branches if kernels.branched else follow_pairs
    vars(whole).update({"term_sizes": no_terms, **vars(kernels), "__name__": name})
    whole.energetic = energetic
    parts: dict[str, Callable[..., object]] = {
        "natural_scales": natural_scales,
        "lowest_in_contact": lowest_in_contact,
        "update_contact": update_contact,
        "place": place,
        "follow": follow,
        "follow_branches": follow_branches,
        "guess_states": guess_states,
        "solve_contacts": solve,
        "radius_at": found_radius if together else radius_of_state,
        "force_at": found_force if together else force_of_state,
        "stiffness_at": found_stiffness if together else stiffness_of_state,
        "total_error": total_error,
        "error_bound": bound_each if together else bound_block,
        "jumps": jumps_of_either if kernels.rows_tell else jumps_between_branches if kernels.branched else jumps,
        "jumps_of_one": jumps,
        "jumps_between_branches": jumps_between_branches,
        "add_totals": add_totals,
    }
    if "find_all" not in vars(kernels):
        parts |= {"find_all": find_near if kernels.found_near else find_by_steps, "evaluate_all": evaluate_all}
    for name, part in parts.items():
        of_one = name in _OF_ONE_CONTACT
        vars(whole)[name] = specialise(part, whole, inline=not of_one, small=of_one)
    whole.loop = specialise(_loop, whole)
    return whole


def sum_over_asperities(
    kernels: Kernels,
    height: Floats,
    columns: Columns,
    effective_modulus: float,
    adhesion: Adhesion,
    separation: Floats,
    memory: Staircase,
    rows: set[int],
) -> tuple[Floats, Floats, int]:
    """Return the totals over the asperities, [row, step] in SI, the contact radius [m] and the force [N] of each where
    the flat is closest, [2, asperity], and the number of visits (asperities times steps).

    height [m] descends; only the ``rows`` asked for are computed, for the conductance that of the radii. OutOfRange
    where the contact of an asperity that can be in contact is not representable.
    """
    wanted = np.zeros(ROWS, dtype=np.bool_)
    wanted[list(rows)] = True
    wanted[RADIUS] |= wanted[CONDUCTANCE]
    shape = ROWS, separation.size
    totals = Totals(wanted, np.zeros(shape), np.zeros(shape), np.zeros((2, height.size)))
    of_sum, energetic = kernels.in_sums or kernels, not _ENERGIES.isdisjoint(rows)
    material = of_sum.material(effective_modulus, adhesion, summed=True, energetic=energetic)
    compiled = compiled_sum(of_sum.of_any or of_sum, energetic=energetic)
    if compiled.adhesive:
        memory = memory._replace(bottom=memory.bottom - adhesion.range)
    else:
        memory = no_memory(np.nextafter(separation, np.inf))
    steps = Steps(separation, int(np.argmin(separation)), memory)
    prepare = prepare_of(compiled, columns, material)
    visits = compiled.loop(height, columns, material, adhesion.range, steps, prepare, totals)
    totals.total[:] += totals.compensation
    if wanted[DISSIPATED]:
        cumulative_sum(totals.total[DISSIPATED])
    if visits == _NOT_REPRESENTABLE or not np.isfinite(totals.total).all():
        raise OutOfRange(
            f"the contact of an asperity is not representable: {kernels.name} with "
            f"effective modulus {effective_modulus:g} Pa, {adhesion}, separation down to {separation.min():g} m"
        )
    if wanted[CONDUCTANCE]:
        totals.total[CONDUCTANCE] = totals.total[RADIUS]
    return totals.total, totals.closest, visits

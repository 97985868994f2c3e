"""The totals of the sum, to which each block adds at one step."""

import math

from roughmdr.aggregate.block import LOAD, RIGIDITY, SIZE, STATE, WORTH, Block, Totals, law
from roughmdr.numerics.summation import accumulate, block_sum

# Rows of the totals.
FORCE, RADIUS, AREA, STIFFNESS, COUNT, ENERGY, DISSIPATED, ERROR = range(8)
ROWS = 8
TOTAL_INDEX = {
    "force": FORCE,
    "pressure": FORCE,
    "contact_area": AREA,
    "contact_fraction": AREA,
    "contact_count": COUNT,
    "contact_radius_sum": RADIUS,
    "stiffness": STIFFNESS,
    "energy": ENERGY,
    "dissipated_energy": DISSIPATED,
}
"""The row of the totals that each curve variable is made from."""


def add_totals(count: int, block: Block, step: int, totals: Totals) -> None:
    """Add the first ``count`` asperities of a block to the wanted totals of a step.

    Each total selects its terms as it makes them: another pass over the block for that would cost a tenth of all.
    """
    size, load, rigidity, worth = block.scales[SIZE], block.scales[LOAD], block.scales[RIGIDITY], block.scales[WORTH]
    wanted, total, compensation = totals.wanted, totals.total, totals.compensation
    terms, in_contact = block.scratch, block.in_contact
    if wanted[FORCE]:
        for i in range(count):
            terms[i] = load[i] * law.force_at(block, i) if not law.adhesive or in_contact[i] > 0.0 else 0.0
        accumulate(total[FORCE], compensation[FORCE], step, block_sum(terms, count))
    if wanted[RADIUS]:
        for i in range(count):
            terms[i] = size[i] * law.radius_at(block, i) if not law.adhesive or in_contact[i] > 0.0 else 0.0
        accumulate(total[RADIUS], compensation[RADIUS], step, block_sum(terms, count))
    if wanted[AREA]:
        for i in range(count):
            a = size[i] * law.radius_at(block, i)
            terms[i] = math.pi * (a * a) if not law.adhesive or in_contact[i] > 0.0 else 0.0
        accumulate(total[AREA], compensation[AREA], step, block_sum(terms, count))
    if wanted[STIFFNESS]:
        for i in range(count):
            terms[i] = rigidity[i] * law.stiffness_at(block, i) if not law.adhesive or in_contact[i] > 0.0 else 0.0
        accumulate(total[STIFFNESS], compensation[STIFFNESS], step, block_sum(terms, count))
    if wanted[ENERGY]:
        for i in range(count):
            energy = law.energy(block.contacts[STATE, i], law.params_of(block.params, i))
            terms[i] = worth[i] * energy if not law.adhesive or in_contact[i] > 0.0 else 0.0
        accumulate(total[ENERGY], compensation[ENERGY], step, block_sum(terms, count))
    if wanted[COUNT]:
        for i in range(count):
            touching = not law.cohesive or law.radius_at(block, i) > 0.0
            terms[i] = 1.0 if touching and (not law.adhesive or in_contact[i] > 0.0) else 0.0
        accumulate(total[COUNT], compensation[COUNT], step, block_sum(terms, count))


def jumps(count: int, block: Block) -> float:
    """Return the energy [J] dissipated in the jumps of a block since the step before.

    Between two steps the flat moves one way, so that a contact made or lost meanwhile has jumped once: on at first
    touch, where it goes from no energy to U < 0, or off at its fold, from U > 0 to none.
    """
    for i in range(count):
        made = block.in_contact[i] > block.in_contact_before[i]
        lost = block.in_contact[i] < block.in_contact_before[i]
        if made or lost:
            own = law.params_of(block.params, i)
            energy = law.energy(law.state(1.0 if made else 0.0, own), own)
            block.scratch[i] = block.scales[WORTH, i] * (-energy if made else energy)
        else:
            block.scratch[i] = 0.0
        block.in_contact_before[i] = block.in_contact[i]
    return block_sum(block.scratch, count)


def jumps_between_branches(count: int, block: Block) -> float:
    """Return as ``jumps`` the energy where a contact also jumps from one branch to another."""
    for i in range(count):
        before, now, dissipated = block.in_contact_before[i], block.in_contact[i], 0.0
        if now != before:
            dissipated = block.scales[WORTH, i] * law.jump_energy(before, now, law.params_of(block.params, i))
        block.scratch[i] = dissipated
        block.in_contact_before[i] = now
    return block_sum(block.scratch, count)

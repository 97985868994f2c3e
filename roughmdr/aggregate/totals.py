"""The totals of the sum, to which each block adds at one step."""

import math

from roughmdr.aggregate.block import ENERGY_SCALE, FORCE_SCALE, RADIUS_SCALE, STATE, STIFFNESS_SCALE, Block, Totals, law
from roughmdr.numerics.summation import accumulate, block_sum

# Rows of the totals.
FORCE, RADIUS, AREA, STIFFNESS, COUNT, ENERGY, DISSIPATED, ERROR, MACHINE, CONDUCTANCE = range(10)
"""That of the machine, the energy which its jumps lose, is filled where there is one; the conductance radius is that of
the radii where contacts do not feel each other.
"""
ROWS = 10
TOTAL_INDEX = {
    "force": FORCE,
    "pressure": FORCE,
    "contact_area": AREA,
    "contact_fraction": AREA,
    "model_error_curve": AREA,
    "contact_count": COUNT,
    "contact_radius_sum": RADIUS,
    "conductance_radius": CONDUCTANCE,
    "stiffness": STIFFNESS,
    "energy": ENERGY,
    "dissipated_energy": DISSIPATED,
    "machine_dissipated_energy": MACHINE,
}
"""The row of the totals that each curve variable is made from."""


def add_totals(count: int, block: Block, step: int, totals: Totals) -> None:
    """Add the first ``count`` asperities of a block to the wanted totals of a step.

    Each total selects its terms as it makes them: another pass over the block for that would cost a tenth of all.
    """
    size, load = block.scales[RADIUS_SCALE], block.scales[FORCE_SCALE]
    rigidity, worth = block.scales[STIFFNESS_SCALE], block.scales[ENERGY_SCALE]
    wanted, total, compensation = totals.wanted, totals.total, totals.compensation
    terms, in_contact, contacts, params = block.scratch, block.in_contact, block.contacts, block.params
    if wanted[FORCE]:
        for i in range(count):
            terms[i] = load[i] * law.force_at(contacts, params, i) if not law.adhesive or in_contact[i] > 0.0 else 0.0
        accumulate(total[FORCE], compensation[FORCE], step, block_sum(terms, count))
    if wanted[RADIUS]:
        for i in range(count):
            terms[i] = size[i] * law.radius_at(contacts, params, i) if not law.adhesive or in_contact[i] > 0.0 else 0.0
        accumulate(total[RADIUS], compensation[RADIUS], step, block_sum(terms, count))
    if wanted[AREA]:
        for i in range(count):
            a = size[i] * law.radius_at(contacts, params, i)
            terms[i] = math.pi * (a * a) if not law.adhesive or in_contact[i] > 0.0 else 0.0
        accumulate(total[AREA], compensation[AREA], step, block_sum(terms, count))
    if wanted[STIFFNESS]:
        for i in range(count):
            terms[i] = (
                rigidity[i] * law.stiffness_at(contacts, params, i) if not law.adhesive or in_contact[i] > 0.0 else 0.0
            )
        accumulate(total[STIFFNESS], compensation[STIFFNESS], step, block_sum(terms, count))
    if law.energetic and wanted[ENERGY]:
        for i in range(count):
            energy = law.energy(contacts[STATE, i], law.params_of(params, i))
            terms[i] = worth[i] * energy if not law.adhesive or in_contact[i] > 0.0 else 0.0
        accumulate(total[ENERGY], compensation[ENERGY], step, block_sum(terms, count))
    if not law.adhesive and wanted[COUNT]:
        accumulate(total[COUNT], compensation[COUNT], step, float(count))
    elif wanted[COUNT]:
        for i in range(count):
            touching = not law.cohesive or law.radius_at(contacts, params, i) > 0.0
            terms[i] = 1.0 if touching and in_contact[i] > 0.0 else 0.0
        accumulate(total[COUNT], compensation[COUNT], step, block_sum(terms, count))


def jumps(count: int, block: Block) -> float:
    """Return the energy [J] dissipated in the jumps of a block since the step before.

    Between two steps the flat moves one way, so that a contact made or lost meanwhile has jumped once: on at first
    touch, where it goes from no energy to U < 0, or off at its fold, from U > 0 to none.
    """
    now, before, terms, worth, params = (
        block.in_contact, block.in_contact_before, block.scratch, block.scales[ENERGY_SCALE], block.params
    )  # fmt: skip
    for i in range(count):
        made, lost = now[i] > before[i], now[i] < before[i]
        if made or lost:
            own = law.params_of(params, i)
            energy = law.energy(law.state(1.0 if made else 0.0, own), own)
            terms[i] = worth[i] * (-energy if made else energy)
        else:
            terms[i] = 0.0
        before[i] = now[i]
    return block_sum(terms, count)


def jumps_between_branches(count: int, block: Block) -> float:
    """Return as ``jumps`` the energy where a contact also jumps from one branch to another."""
    now, before, terms, worth, params = (
        block.in_contact, block.in_contact_before, block.scratch, block.scales[ENERGY_SCALE], block.params
    )  # fmt: skip
    for i in range(count):
        changed = now[i] != before[i]
        terms[i] = worth[i] * law.jump_energy(before[i], now[i], law.params_of(params, i)) if changed else 0.0
        before[i] = now[i]
    return block_sum(terms, count)

"""The totals of the sum, to which each block adds at one step."""

import math

from roughmdr.aggregate.block import ENERGY_SCALE, FORCE_SCALE, RADIUS_SCALE, STIFFNESS_SCALE, Block, Totals, kernel
from roughmdr.kernels.blocks import BEFORE, IN_CONTACT, STATE, TERM
from roughmdr.kernels.profile.layout import BRANCHED
from roughmdr.numerics.summation import BLOCK, accumulate, sum_by_halves

# Rows of the totals.
FORCE, RADIUS, AREA, STIFFNESS, COUNT, ENERGY, DISSIPATED, ERROR, MACHINE, CONDUCTANCE, NOMINAL = range(11)
"""MACHINE, the energy that jumps of a machine lose, is filled under a machine alone; CONDUCTANCE is the sum of radii
where contacts are independent, NOMINAL the effective radius of the load of coupled ones under a curved body."""
ROWS = 11
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
    "nominal_contact_radius": NOMINAL,
}
"""The row of the totals that each curve variable is made from."""


def add_totals(count: int, block: Block, step: int, totals: Totals) -> None:
    """Add the first ``count`` asperities of a block to the wanted totals of a step.

    Each total selects the contacts itself: another pass over the block for that would take a tenth of all time.
    """
    params, scales, contacts = block.params, block.scales, block.contacts
    terms, total, compensation = contacts[TERM], totals.total, totals.compensation
    for row in range(ROWS):
        if not totals.wanted[row]:
            continue
        if row == FORCE:
            for i in range(count):
                force = scales[FORCE_SCALE, i] * kernel.force_at(contacts, params, i)
                terms[i] = force if not kernel.adhesive or contacts[IN_CONTACT, i] > 0.0 else 0.0
        elif row == RADIUS:
            for i in range(count):
                a = scales[RADIUS_SCALE, i] * kernel.radius_at(contacts, params, i)
                terms[i] = a if not kernel.adhesive or contacts[IN_CONTACT, i] > 0.0 else 0.0
        elif row == AREA:
            for i in range(count):
                a = scales[RADIUS_SCALE, i] * kernel.radius_at(contacts, params, i)
                terms[i] = math.pi * (a * a) if not kernel.adhesive or contacts[IN_CONTACT, i] > 0.0 else 0.0
        elif row == STIFFNESS:
            for i in range(count):
                k = scales[STIFFNESS_SCALE, i] * kernel.stiffness_at(contacts, params, i)
                terms[i] = k if not kernel.adhesive or contacts[IN_CONTACT, i] > 0.0 else 0.0
        elif row == COUNT and not kernel.adhesive:
            for i in range(count):
                terms[i] = 1.0
        elif row == COUNT:
            for i in range(count):
                touching = not kernel.cohesive or kernel.radius_at(contacts, params, i) > 0.0
                terms[i] = 1.0 if touching and contacts[IN_CONTACT, i] > 0.0 else 0.0
        elif kernel.energetic and row == ENERGY:
            for i in range(count):
                energy = scales[ENERGY_SCALE, i] * kernel.energy(contacts[STATE, i], kernel.params_of(params, i))
                terms[i] = energy if not kernel.adhesive or contacts[IN_CONTACT, i] > 0.0 else 0.0
        else:
            continue  # added elsewhere
        total[row, step], compensation[row, step] = accumulate(
            total[row, step], compensation[row, step], sum_by_halves(terms, count, BLOCK)
        )


def jumps(count: int, block: Block) -> float:
    """Return the energy [J] dissipated in the jumps of a block since the step before.

    Between two steps the flat does not turn, so that a contact made or lost meanwhile has jumped once: on at first
    touch, where it goes from no energy to U < 0, or off at its fold, from U > 0 to none.
    """
    params, scales, contacts = block.params, block.scales, block.contacts
    terms = contacts[TERM]
    for i in range(count):
        now, before = contacts[IN_CONTACT, i], contacts[BEFORE, i]
        terms[i] = 0.0
        if now != before:
            own, made = kernel.params_of(params, i), now > before
            energy = kernel.energy(kernel.state(1.0 if made else 0.0, own), own)
            terms[i] = scales[ENERGY_SCALE, i] * (-energy if made else energy)
        contacts[BEFORE, i] = now
    return sum_by_halves(terms, count, BLOCK)


def jumps_of_either(count: int, block: Block) -> float:
    """Do as ``jumps_between_branches`` where the rows have several branches, else as ``jumps``."""
    if block.params[0, BRANCHED] > 0.0:
        return float(kernel.jumps_between_branches(count, block))
    return float(kernel.jumps_of_one(count, block))


def jumps_between_branches(count: int, block: Block) -> float:
    """Return the energy of ``jumps``, with those of contacts from one branch to another."""
    params, scales, contacts = block.params, block.scales, block.contacts
    terms = contacts[TERM]
    for i in range(count):
        now, before = contacts[IN_CONTACT, i], contacts[BEFORE, i]
        lost = kernel.jump_energy(before, now, kernel.params_of(params, i)) if now != before else 0.0
        terms[i] = scales[ENERGY_SCALE, i] * lost
        contacts[BEFORE, i] = now
    return sum_by_halves(terms, count, BLOCK)

"""The state of each contact of a block at one step, and radius, force and stiffness from it."""

from typing import Any

from roughmdr.aggregate.block import DEPTH_SCALE, PER_DEPTH, Block, kernel
from roughmdr.kernels.blocks import FORCE, IN_CONTACT, RADIUS, STATE, STATE_ERROR, STIFFNESS, TERM
from roughmdr.kernels.profile.layout import BRANCHED
from roughmdr.loading.staircase import Staircase
from roughmdr.numerics.arguments import Floats


def update_contact(count: int, block: Block, memory: Staircase, begin: int, end: int) -> None:
    """Set which of the first ``count`` asperities are in contact, by the pairs begin to end of the staircase."""
    z, scales, contacts = block.z, block.scales, block.contacts
    for i in range(count):
        contacts[IN_CONTACT, i] = 0.0
    for j in range(begin, end):
        low, high = memory.bottom[j], memory.top[j]
        for i in range(count):
            held = (z[i] >= low) & (z[i] - high > -scales[DEPTH_SCALE, i])
            contacts[IN_CONTACT, i] = 1.0 if held else contacts[IN_CONTACT, i]


def follow_pairs(count: int, block: Block, touched: float, memory: Staircase, begin: int, end: int) -> None:
    """Find which of the first ``count`` asperities are in contact, where there is one branch."""
    kernel.update_contact(count, block, memory, begin, end)


def follow_branches(count: int, block: Block, touched: float, memory: Staircase, begin: int, end: int) -> None:
    """Find the branches of the first ``count`` asperities from those at the step before; contact begins at heights of
    ``touched``.
    """
    z, params, contacts = block.z, block.params, block.contacts
    for i in range(count):
        contacts[IN_CONTACT, i] = kernel.branch(
            contacts[TERM, i], contacts[IN_CONTACT, i], z[i] >= touched, kernel.params_of(params, i)
        )


def follow_either(count: int, block: Block, touched: float, memory: Staircase, begin: int, end: int) -> None:
    """Do as ``follow_branches`` where the rows have several branches, else as ``follow_pairs``."""
    if block.params[0, BRANCHED] > 0.0:
        kernel.follow_branches(count, block, touched, memory, begin, end)
    else:
        kernel.update_contact(count, block, memory, begin, end)


def solve_closed(
    count: int, block: Block, h: float, adhesion_range: float, memory: Staircase, begin: int, end: int
) -> None:
    """Find the first ``count`` contacts with the flat at h, and which of them are in contact.

    Without adhesion all of them are. Those out of contact have the state of first touch.
    """
    z, params = block.z, block.params
    scales, contacts = block.scales, block.contacts
    if kernel.adhesive:
        kernel.update_contact(count, block, memory, begin, end)
        for i in range(count):
            x = ((z[i] - h) + scales[DEPTH_SCALE, i]) * scales[PER_DEPTH, i]
            contacts[STATE, i] = kernel.state(x if contacts[IN_CONTACT, i] > 0.0 else 1.0, kernel.params_of(params, i))
    else:
        for i in range(count):
            contacts[STATE, i] = kernel.state((z[i] - h) * scales[PER_DEPTH, i], kernel.params_of(params, i))
    if kernel.found_together:
        kernel.evaluate_all(count, block.contacts, block.params)


def solve_refined(
    count: int, block: Block, h: float, adhesion_range: float, memory: Staircase, begin: int, end: int
) -> None:
    """Do as ``solve_closed`` in several steps, a loop for each, so that no contact waits for another."""
    params, contacts = block.params, block.contacts
    state, x = contacts[STATE], contacts[TERM]
    kernel.guess_states(count, block, h, adhesion_range, memory, begin, end)
    for _ in range(kernel.refinements):
        for i in range(count):
            state[i] = kernel.refined(state[i], x[i], kernel.params_of(params, i))
    kernel.evaluate_all(count, block.contacts, block.params)


def guess_states(
    count: int, block: Block, h: float, adhesion_range: float, memory: Staircase, begin: int, end: int
) -> None:
    """Do as ``place``, and guess the states."""
    params, contacts = block.params, block.contacts
    state, x = contacts[STATE], contacts[TERM]
    kernel.place(count, block, h, adhesion_range, memory, begin, end)
    for i in range(count):
        state[i] = kernel.y_of_x(x[i], kernel.params_of(params, i)) if kernel.iterative else x[i]
    for i in range(count):
        state[i] = kernel.initial_guess(state[i], kernel.params_of(params, i))


def solve_iterative(
    count: int, block: Block, h: float, adhesion_range: float, memory: Staircase, begin: int, end: int
) -> None:
    """Do as ``solve_closed``: equal steps for all contacts, as vector code, then a search for those that need it."""
    params, contacts = block.params, block.contacts
    state, error, in_contact, x = contacts[STATE], contacts[STATE_ERROR], contacts[IN_CONTACT], contacts[TERM]
    kernel.guess_states(count, block, h, adhesion_range, memory, begin, end)
    kernel.find_all(count, contacts, params)
    unknown = 0
    for i in range(count):
        branch = in_contact[i] if kernel.adhesive else 1.0
        unknown += (branch > 0.0) & (kernel.converged(error[i], branch, kernel.params_of(params, i)) < 1)
    if unknown > 0:
        for i in range(count):
            branch, own = in_contact[i] if kernel.adhesive else 1.0, kernel.params_of(params, i)
            if branch > 0.0 and not kernel.converged(error[i], branch, own):
                t, left, _ = kernel.one_step(state[i], x[i], own)  # from a state below 0 it does not converge
                state[i] = t if kernel.converged(left, branch, own) else kernel.state_on_branch(x[i], branch, own)
                contacts[RADIUS, i], contacts[FORCE, i], contacts[STIFFNESS, i] = kernel.radius_force_stiffness(
                    state[i], own
                )


def solve_each(
    count: int, block: Block, h: float, adhesion_range: float, memory: Staircase, begin: int, end: int
) -> None:
    """Do as ``solve_closed`` for contacts that are solved one by one."""
    params, contacts = block.params, block.contacts
    kernel.place(count, block, h, adhesion_range, memory, begin, end)
    for i in range(count):
        state, a, force, stiffness = 0.0, 0.0, 0.0, 0.0
        if contacts[IN_CONTACT, i] > 0.0:
            x, branch = contacts[TERM, i], contacts[IN_CONTACT, i]
            state, a, force, stiffness = kernel.contact_at(x, branch, kernel.params_of(params, i))
        contacts[STATE, i], contacts[RADIUS, i] = state, a
        contacts[FORCE, i], contacts[STIFFNESS, i] = force, stiffness


def place(count: int, block: Block, h: float, adhesion_range: float, memory: Staircase, begin: int, end: int) -> None:
    """Put x of the first ``count`` asperities into the row TERM, and find which of them are in contact.

    Those out of contact have the x of first touch. With several branches, IN_CONTACT holds the number of the
    branch at the step before, and then the new one.
    """
    z, scales, contacts = block.z, block.scales, block.contacts
    lift = 1.0 if kernel.adhesive else 0.0
    for i in range(count):
        contacts[TERM, i] = max(((z[i] - h) + lift * scales[DEPTH_SCALE, i]) * scales[PER_DEPTH, i], 0.0)
    if kernel.adhesive:
        kernel.follow(count, block, h - adhesion_range, memory, begin, end)
        for i in range(count):
            contacts[TERM, i] = contacts[TERM, i] if contacts[IN_CONTACT, i] > 0.0 else 1.0


def radius_of_state(contacts: Floats, params: Any, i: int) -> float:
    """Return a of one contact over its natural scale."""
    return kernel.radius(contacts[STATE, i], kernel.params_of(params, i))


def force_of_state(contacts: Floats, params: Any, i: int) -> float:
    """Return P of one contact over its natural scale."""
    return kernel.force(contacts[STATE, i], kernel.params_of(params, i))


def stiffness_of_state(contacts: Floats, params: Any, i: int) -> float:
    """Return k of one contact over its natural scale."""
    return kernel.stiffness(contacts[STATE, i], kernel.params_of(params, i))


def found_radius(contacts: Floats, params: Any, i: int) -> float:
    """Return a of one contact that was found with its state."""
    return float(contacts[RADIUS, i])


def found_force(contacts: Floats, params: Any, i: int) -> float:
    """Return P of one contact that was found with its state."""
    return float(contacts[FORCE, i])


def found_stiffness(contacts: Floats, params: Any, i: int) -> float:
    """Return k of one contact that was found with its state."""
    return float(contacts[STIFFNESS, i])

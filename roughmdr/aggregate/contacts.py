"""The state of each contact of a block at one step, and radius, force and stiffness from it."""

from typing import Any

from roughmdr.aggregate.block import DEPTH_SCALE, FORCE, PER_DEPTH, RADIUS, STATE, STATE_ERROR, STIFFNESS, Block, law
from roughmdr.loading.staircase import Staircase
from roughmdr.numerics.arguments import Floats


def update_contact(count: int, block: Block, memory: Staircase, begin: int, end: int) -> None:
    """Set which of the first ``count`` asperities are in contact, by the pairs begin to end of the staircase."""
    z, depth, in_contact, bottom, top = block.z, block.scales[DEPTH_SCALE], block.in_contact, memory.bottom, memory.top
    low, high = bottom[begin], top[begin]
    for i in range(count):
        in_contact[i] = 1.0 if (z[i] >= low) & (z[i] - high > -depth[i]) else 0.0
    for j in range(begin + 1, end):
        low, high = bottom[j], top[j]
        for i in range(count):
            in_contact[i] = 1.0 if (z[i] >= low) & (z[i] - high > -depth[i]) else in_contact[i]


def evaluate(count: int, block: Block) -> None:
    """Find a, P and k of the first ``count`` contacts."""
    contacts, params = block.contacts, block.params
    a, force, stiffness = contacts[RADIUS], contacts[FORCE], contacts[STIFFNESS]
    for i in range(count):
        a[i], force[i], stiffness[i] = law.radius_force_stiffness(contacts[STATE, i], law.params_of(params, i))


def skip(count: int, block: Block) -> None:
    """Leave a, P and k to be computed from the state where they are asked for."""


def solve_closed(
    count: int, block: Block, h: float, adhesion_range: float, memory: Staircase, begin: int, end: int
) -> None:
    """Find the first ``count`` contacts with the flat at h, and which of them are in contact.

    Without adhesion all of them are. Those out of contact have the state of first touch.
    """
    z, params, in_contact, state = block.z, block.params, block.in_contact, block.contacts[STATE]
    depth, per_depth = block.scales[DEPTH_SCALE], block.scales[PER_DEPTH]
    if law.adhesive:
        law.update_contact(count, block, memory, begin, end)
        for i in range(count):
            x = ((z[i] - h) + depth[i]) * per_depth[i]
            state[i] = law.state(x if in_contact[i] > 0.0 else 1.0, law.params_of(params, i))
    else:
        for i in range(count):
            state[i] = law.state((z[i] - h) * per_depth[i], law.params_of(params, i))
    law.evaluate(count, block)


def solve_refined(
    count: int, block: Block, h: float, adhesion_range: float, memory: Staircase, begin: int, end: int
) -> None:
    """Do as ``solve_closed`` in several steps, a loop for each, so that no contact waits for another."""
    params, x, state = block.params, block.scratch, block.contacts[STATE]
    law.place(count, block, h, adhesion_range, memory, begin, end)
    for i in range(count):
        state[i] = law.initial_guess(x[i], law.params_of(params, i))
    for _ in range(law.refinements):
        for i in range(count):
            state[i] = law.refined(state[i], x[i], law.params_of(params, i))
    law.evaluate(count, block)


def solve_iterative(
    count: int, block: Block, h: float, adhesion_range: float, memory: Staircase, begin: int, end: int
) -> None:
    """Do as ``solve_closed`` by a fixed number of steps for all contacts, as vector code, and a search for some."""
    params, in_contact, x = block.params, block.in_contact, block.scratch
    state, error = block.contacts[STATE], block.contacts[STATE_ERROR]
    law.place(count, block, h, adhesion_range, memory, begin, end)
    for i in range(count):
        state[i] = law.y_of_x(x[i], law.params_of(params, i))
    for i in range(count):
        state[i] = law.initial_guess(state[i], law.params_of(params, i))
    for i in range(count):
        state[i], error[i], _ = law.approach(state[i], x[i], law.params_of(params, i))
    unknown = 0
    for i in range(count):
        branch = in_contact[i] if law.adhesive else 1.0
        unknown += (branch > 0.0) & (law.converged(error[i], branch, law.params_of(params, i)) < 1)
    if unknown > 0:
        for i in range(count):
            branch, own = in_contact[i] if law.adhesive else 1.0, law.params_of(params, i)
            if branch > 0.0 and not law.converged(error[i], branch, own):
                t, left, _ = law.one_step(state[i], x[i], own)
                state[i] = t if law.converged(left, branch, own) else law.state_on_branch(x[i], branch, own)
    law.evaluate(count, block)


def solve_each(
    count: int, block: Block, h: float, adhesion_range: float, memory: Staircase, begin: int, end: int
) -> None:
    """Do as ``solve_closed`` for contacts that are solved one by one."""
    params, in_contact, x, contacts = block.params, block.in_contact, block.scratch, block.contacts
    state, a, force, stiffness = contacts[STATE], contacts[RADIUS], contacts[FORCE], contacts[STIFFNESS]
    law.place(count, block, h, adhesion_range, memory, begin, end)
    for i in range(count):
        if in_contact[i] > 0.0:
            state[i], a[i], force[i], stiffness[i] = law.contact_at(x[i], in_contact[i], law.params_of(params, i))
        else:
            state[i], a[i], force[i], stiffness[i] = 0.0, 0.0, 0.0, 0.0


def place(count: int, block: Block, h: float, adhesion_range: float, memory: Staircase, begin: int, end: int) -> None:
    """Put x of the first ``count`` asperities into ``block.scratch``, and find which of them are in contact.

    Those out of contact have the x of first touch. With several branches, ``block.in_contact`` holds the number of the
    branch at the step before, and then the new one.
    """
    z, params, in_contact, x = block.z, block.params, block.in_contact, block.scratch
    depth, per_depth = block.scales[DEPTH_SCALE], block.scales[PER_DEPTH]
    lift = 1.0 if law.adhesive else 0.0
    for i in range(count):
        x[i] = max(((z[i] - h) + lift * depth[i]) * per_depth[i], 0.0)
    if law.branched:
        for i in range(count):
            in_contact[i] = law.branch(x[i], in_contact[i], z[i] >= h - adhesion_range, law.params_of(params, i))
    elif law.adhesive:
        law.update_contact(count, block, memory, begin, end)
    if law.adhesive:
        for i in range(count):
            x[i] = x[i] if in_contact[i] > 0.0 else 1.0


def radius_of_state(contacts: Floats, params: Any, i: int) -> float:
    """Return a of one contact over its natural scale."""
    return law.radius(contacts[STATE, i], law.params_of(params, i))


def force_of_state(contacts: Floats, params: Any, i: int) -> float:
    """Return P of one contact over its natural scale."""
    return law.force(contacts[STATE, i], law.params_of(params, i))


def stiffness_of_state(contacts: Floats, params: Any, i: int) -> float:
    """Return k of one contact over its natural scale."""
    return law.stiffness(contacts[STATE, i], law.params_of(params, i))


def found_radius(contacts: Floats, params: Any, i: int) -> float:
    """Return a of one contact that was found with its state."""
    return float(contacts[RADIUS, i])


def found_force(contacts: Floats, params: Any, i: int) -> float:
    """Return P of one contact that was found with its state."""
    return float(contacts[FORCE, i])


def found_stiffness(contacts: Floats, params: Any, i: int) -> float:
    """Return k of one contact that was found with its state."""
    return float(contacts[STIFFNESS, i])

"""Force and stiffness of an ensemble with the flat anywhere on a leg, as a machine needs them.

In contrast to the loop over all steps of a path, the next separation is not known before the force at this one is. So
the natural scales of all asperities are kept; they are computed when a block is first visited.
"""

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from roughmdr.aggregate.block import DEPTH_SCALE, FORCE_SCALE, RADIUS_SCALE, SCALES, STIFFNESS_SCALE, Block, kernel
from roughmdr.aggregate.far_contacts import GROUP, Far, far_response, nothing_known, slot_for
from roughmdr.aggregate.loop import count_above
from roughmdr.kernels.blocks import CONTACT_ROWS, IN_CONTACT, STIFFNESS, TERM
from roughmdr.kernels.interface import Columns, Material
from roughmdr.loading.staircase import Staircase
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.jit import njit
from roughmdr.numerics.summation import accumulate, sum_by_halves


class Response(NamedTuple):
    """Force and stiffness of all contacts at a separation."""

    force: float
    """[N]"""
    stiffness: float
    """-dF/dh [N/m], jumps not included."""
    bound: float
    """An upper bound of the stiffness [N/m] of these contacts wherever the flat is higher."""


class Asperities(NamedTuple):
    """The asperities of an ensemble, with room for scales and states that are kept."""

    height: Floats
    columns: Columns
    material: Material
    adhesion_range: float
    params: Any
    """Prepared parameters of all asperities, or the one row that they share."""
    scales: Floats
    """Natural scales in SI, [group, row, asperity]."""
    max_scales: Floats
    """The largest of each, [group, row]."""
    in_contact: Floats
    """Whether each is in contact, [group, asperity], with the flat where it stands."""
    tried: Floats
    """Whether each is in contact, [group, asperity], with the flat where it was tried last."""
    contacts: Floats
    """Contacts of the group that is evaluated, [row, asperity]."""
    ready: NDArray[np.int64]
    """Number of groups that are prepared, -1 where a scale is not representable; and number of asperities visited."""
    far: Far


class Memory(NamedTuple):
    """The pairs of the staircase [m] at the begin of a leg, and room for those at a separation, one more."""

    first: NDArray[np.int64]
    bottom: Floats
    top: Floats
    bottom_now: Floats
    top_now: Floats


def keep(
    height: Floats,
    columns: Columns,
    material: Material,
    adhesion_range: float,
    release: Floats,
    prepare: Callable[..., Floats],
) -> Asperities:
    """Return asperities of descending height [m], none of which is prepared; ``prepare`` as in ``Kernels``.

    ``release`` [m] is the separation above which each is out of contact.
    """
    groups, two = (height.size + GROUP - 1) // GROUP, min(height.size, 2)
    params = prepare(material, columns, 0, two, 0.0, 0.0)
    size = height.size if params.shape[0] == two else 1
    return Asperities(
        height,
        columns,
        material,
        adhesion_range,
        np.empty((size, *params.shape[1:])),
        np.empty((groups, SCALES, GROUP)),
        np.empty((groups, SCALES)),
        np.zeros((groups, GROUP)),
        np.zeros((groups, GROUP)),
        np.empty((CONTACT_ROWS, GROUP)),
        np.zeros(2, dtype=np.int64),
        nothing_known(release),
    )


def block_at(asperities: Asperities, number: int) -> Block:
    """Return a group with its natural scales; ``asperities.ready`` is -1 where one is not representable."""
    start = number * GROUP
    stop = min(start + GROUP, asperities.height.size)
    shared = asperities.params.shape[0] < asperities.height.size
    if number >= asperities.ready[0] and not (shared and number > 0):
        begin, end = (0, 1) if shared else (start, stop)
        found = kernel.prepare(asperities.material, asperities.columns, begin, end, 0.0, math.inf).reshape(-1)
        kept = asperities.params[begin:end].reshape(-1)  # one by one, here and below: slices take seconds to compile
        for i in range(kept.size):
            kept[i] = found[i]
    block = Block(
        asperities.height[start:stop],
        asperities.params[0:1] if shared else asperities.params[start:stop],
        asperities.scales[number],
        asperities.max_scales[number],
        asperities.contacts,
    )
    if number >= asperities.ready[0]:
        representable = kernel.natural_scales(block, asperities.columns, start, asperities.material)
        asperities.ready[0] = number + 1 if representable else -1
    return block


def response(h: float, falls: bool, asperities: Asperities, memory: Memory) -> Response:
    """Return force and stiffness at h, reached directly from where the flat is; NaN if a scale is not representable.

    ``falls`` says whether the flat goes down on this leg. The first groups are interpolated if ``far`` says so.
    """
    count_of_pairs = memory.bottom.size
    now, reach = Staircase(memory.first, memory.bottom_now, memory.top_now), asperities.adhesion_range
    for j in range(count_of_pairs):
        now.bottom[j], now.top[j] = memory.bottom[j] - reach, max(memory.top[j], h)
    if falls or not kernel.adhesive:
        now.bottom[count_of_pairs] = h - reach if kernel.adhesive else np.nextafter(h, math.inf)
        now.top[count_of_pairs] = h
        count_of_pairs += 1
    lowest = now.bottom[0]
    for j in range(1, count_of_pairs):
        lowest = min(lowest, now.bottom[j])
    total, compensation, far = np.zeros(3), np.zeros(3), asperities.far
    begin, slot = far.number[1], -1
    if begin > 0:
        total[0], total[1] = far_response(h, far)
        total[2] = total[1]
    elif kernel.hardening:
        slot = slot_for(h, far)
    groups = asperities.in_contact.shape[0]
    for number in range(begin, groups):
        if slot >= 0:
            far.force[slot, number] = total[0] + compensation[0]
            far.stiffness[slot, number] = total[1] + compensation[1]
        if asperities.height[number * GROUP] < lowest:
            groups = number
            break
        block = kernel.block_at(asperities, number)
        if asperities.ready[0] < 0:
            return Response(math.nan, math.nan, math.nan)
        deepest = block.max_scales[DEPTH_SCALE]
        count = count_above(block.z, kernel.lowest_in_contact(0, count_of_pairs, now, deepest))
        if kernel.adhesive:
            for i in range(GROUP):
                asperities.contacts[IN_CONTACT, i] = asperities.in_contact[number, i] if i < count else 0.0
        if count > 0:
            asperities.ready[1] += count
            kernel.solve_contacts(count, block, h, reach, now, 0, count_of_pairs)
            kernel.add_response(count, block, asperities.material.effective_modulus, total, compensation)
        if kernel.adhesive:
            for i in range(GROUP):
                asperities.tried[number, i] = asperities.contacts[IN_CONTACT, i]
    if slot >= 0:
        far.force[slot, groups:] = total[0] + compensation[0]
        far.stiffness[slot, groups:] = total[1] + compensation[1]
    force, stiffness = total[0] + compensation[0], total[1] + compensation[1]
    return Response(force, stiffness, total[2] + compensation[2] if kernel.adhesive else stiffness)


def add_response(count: int, block: Block, modulus: float, total: Floats, compensation: Floats) -> None:
    """Add the force, the stiffness and its bound of the first ``count`` asperities of a group.

    The stiffness of a contact is its own bound where it grows with the indentation, as all do without adhesion; else
    the bound is 2 E* a, the stiffness of a punch of that radius.
    """
    params, scales, contacts = block.params, block.scales, block.contacts
    terms = contacts[TERM]
    for row in range(3 if kernel.adhesive else 2):
        if row == 0:
            for i in range(count):
                force = scales[FORCE_SCALE, i] * kernel.force_at(contacts, params, i)
                terms[i] = force if not kernel.adhesive or contacts[IN_CONTACT, i] > 0.0 else 0.0
        elif row == 1:
            for i in range(count):
                k = scales[STIFFNESS_SCALE, i] * kernel.stiffness_at(contacts, params, i)
                terms[i] = k if not kernel.adhesive or contacts[IN_CONTACT, i] > 0.0 else 0.0
                contacts[STIFFNESS, i] = terms[i] if terms[i] > 0.0 else 0.0
        elif kernel.hardening:
            for i in range(count):
                terms[i] = contacts[STIFFNESS, i]
        else:
            for i in range(count):
                k = 2.0 * modulus * (scales[RADIUS_SCALE, i] * kernel.radius_at(contacts, params, i))
                terms[i] = k if contacts[IN_CONTACT, i] > 0.0 else 0.0
        total[row], compensation[row] = accumulate(total[row], compensation[row], sum_by_halves(terms, count, GROUP))


@njit
def stand(asperities: Asperities) -> None:
    """Have the flat stand where it was tried last."""
    in_contact, tried = asperities.in_contact, asperities.tried
    for number in range(asperities.ready[0]):
        for i in range(in_contact.shape[1]):
            in_contact[number, i] = tried[number, i]

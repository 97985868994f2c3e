"""Contacts far from the separations where they are made or lost: their force is smooth, and interpolated.

A look is a separation at which all contacts were summed. A search tries many separations, at which nothing happens to
the highest asperities. So each look keeps the sums of force and stiffness up to every group of asperities, and groups
far from any event (a touch, a detachment) take their force from Hermite's polynomial through the last looks.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.jit import njit

GROUP = 256
"""Asperities that are summed over together."""
LOOKS = 3
_DISTANCE = 1.0  # distance of far groups from any event, over the range of looks and search
_APART = 2.0**-6  # least distance of two looks, over the range of all: a nearer look replaces the earlier one


class Far(NamedTuple):
    """The sums that the last looks at all contacts have given."""

    separation: Floats
    """Separation [m] of each look."""
    force: Floats
    """[look, group]: the sum [N] over all groups before this one."""
    stiffness: Floats
    """[look, group]: the sum [N/m] over the same groups."""
    lowest_event: Floats
    """[group]: the lowest separation [m] at which an asperity of the groups before is lost, or touched."""
    number: NDArray[np.int64]
    """How many looks there are; and how many groups are taken from them now, 0 for none."""


def nothing_known(release: Floats) -> Far:
    """Return room for looks; ``release`` is the separation [m] at which each asperity is lost, the highest first."""
    groups = release.size // GROUP
    lowest = np.minimum.accumulate(release)[GROUP - 1 :: GROUP][:groups]
    room = np.empty((LOOKS, groups + 1))
    return Far(np.empty(LOOKS), room, room.copy(), np.append(math.inf, lowest), np.zeros(2, dtype=np.int64))


@njit
def slot_for(h: float, far: Far) -> int:
    """Return the slot for a look at h: that of a look at nearly the same separation, else of the oldest."""
    count = far.number[0]
    low = high = h
    for i in range(count):
        low, high = min(low, far.separation[i]), max(high, far.separation[i])
    for i in range(count):
        if abs(far.separation[i] - h) <= _APART * (high - low):
            far.separation[i] = h
            return i
    if count == LOOKS:  # the oldest is first
        count -= 1
        for i in range(count):
            far.separation[i] = far.separation[i + 1]
            for group in range(far.force.shape[1]):
                far.force[i, group] = far.force[i + 1, group]
                far.stiffness[i, group] = far.stiffness[i + 1, group]
    far.separation[count] = h
    far.number[0] = count + 1
    return int(count)


@njit
def far_response(h: float, far: Far) -> tuple[float, float]:
    """Return force [N] and stiffness [N/m] of the far groups at h, by Hermite's polynomial in Newton's form."""
    groups, count = far.number[1], far.number[0]
    nodes, table = np.empty(2 * LOOKS), np.empty(2 * LOOKS)
    for i in range(count):
        nodes[2 * i] = nodes[2 * i + 1] = far.separation[i]
        table[2 * i] = table[2 * i + 1] = far.force[i, groups]
    for order in range(1, 2 * count):
        for i in range(2 * count - 1, order - 1, -1):
            way = nodes[i] - nodes[i - order]
            if order == 1 and i % 2 == 1:
                table[i] = -far.stiffness[i // 2, groups]
            else:
                table[i] = (table[i] - table[i - 1]) / way
    value, slope = table[2 * count - 1], 0.0
    for i in range(2 * count - 2, -1, -1):
        slope = slope * (h - nodes[i]) + value
        value = value * (h - nodes[i]) + table[i]
    return value, -slope


@njit
def far_groups(at: float, to: float, falls: bool, height: Floats, far: Far) -> int:
    """Return how many of the highest groups stay far from any event from ``at`` [m] to ``to`` [m]."""
    count = far.number[0]
    if count < LOOKS:
        return 0
    low, high = min(at, to), max(at, to)
    for i in range(count):
        low, high = min(low, far.separation[i]), max(high, far.separation[i])
    limit = high + _DISTANCE * (high - low)
    first, last = 0, far.lowest_event.size - 1
    while first < last:
        middle = (first + last + 1) // 2
        touched = height[middle * GROUP - 1] > high or not falls
        if far.lowest_event[middle] >= limit and touched:
            first = middle
        else:
            last = middle - 1
    return int(first)

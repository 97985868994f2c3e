"""Which summits are in contact at each step of the path, and on which branch: intervals of their height."""

import math
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from roughmdr.aggregate import LoadingPath
from roughmdr.asperity.contact import Contact
from roughmdr.expected.curve import branch_ends
from roughmdr.kernels.profile.layout import ONSET
from roughmdr.numerics.arguments import Floats


class Intervals(NamedTuple):
    """Summits from ``begin`` to ``end`` [m] at a step; on a branch, or moved from one branch to another, 0 for none."""

    step: NDArray[np.int64]
    before: NDArray[np.int64]
    rung: NDArray[np.int64]
    begin: Floats
    end: Floats

    @classmethod
    def of(cls, found: list[tuple[int, int, int, float, float]]) -> "Intervals":
        """From tuples in the order of the fields."""
        columns = np.array(found, dtype=np.float64).reshape(-1, 5).T
        step, before, rung = columns[:3].astype(np.int64)
        return cls(step, before, rung, columns[3], columns[4])


def remember(contact: Contact, path: LoadingPath) -> tuple[Intervals, Intervals]:
    """Where summits are in contact at each step, and where they jumped on the way to it."""
    if contact.law.branched:
        return _on_branches(contact, path.separation)
    return _on_one(contact, path)


def _on_one(contact: Contact, path: LoadingPath) -> tuple[Intervals, Intervals]:
    """Without branches all summits above one height are in contact: that of the lowest step of the staircase."""
    depth = contact.depth[0] if contact.law.adhesive else 0.0
    memory = path.memory
    each = np.maximum(memory.bottom, memory.top - depth)
    lowest = np.minimum.reduceat(each, memory.first[:-1])
    steps = np.arange(lowest.size)
    one = np.ones_like(steps)
    held = Intervals(steps, one, one, lowest, np.full_like(lowest, math.inf))
    earlier = np.concatenate([[math.inf], lowest[:-1]])
    made = (lowest < earlier).astype(np.int64)
    moved = Intervals(steps, 1 - made, made, np.minimum(lowest, earlier), np.maximum(lowest, earlier))
    return held, moved


def _on_branches(contact: Contact, separation: Floats) -> tuple[Intervals, Intervals]:
    """With branches: the heights are cut wherever a jump begins, and each interval moves as one."""
    row, depth, reach = contact.params, contact.depth[0], contact.adhesion.range
    feet, tops = branch_ends(contact)
    offsets = [(mark - 1.0) * depth for mark in (*feet, *tops, float(row[ONSET]))]
    bounds, rungs = [-math.inf, math.inf], [0]
    held, moved = [], []
    for step, h in enumerate(separation.tolist()):
        cuts = sorted({*bounds, *(h + offset for offset in offsets), h - reach})
        befores, afters = [], []
        at = 0
        for low, high in pairwise(cuts):
            while bounds[at + 1] <= low:
                at += 1
            z = _within(low, high, depth)
            x = max(((z - h) + depth) / depth, 0.0)
            befores.append(rungs[at])
            afters.append(int(contact.law.branch(x, float(rungs[at]), z >= h - reach, row)))
        bounds, rungs = [-math.inf], []
        for (low, high), before, after in zip(pairwise(cuts), befores, afters, strict=True):
            if before != after:
                moved.append((step, before, after, low, high))
            if rungs and rungs[-1] == after:
                bounds[-1] = high
            else:
                rungs.append(after)
                bounds.append(high)
        held += [
            (step, rung, rung, low, high) for rung, (low, high) in zip(rungs, pairwise(bounds), strict=True) if rung > 0
        ]
    return Intervals.of(held), Intervals.of(moved)


def _within(low: float, high: float, depth: float) -> float:
    """A height between two, of which one may be infinite."""
    if low == -math.inf:
        return high - depth
    return low + depth if high == math.inf else 0.5 * (low + high)


def lost(contact: Contact, moved: Intervals) -> Floats:
    """The energy over its natural scale that each of these jumps costs a contact."""
    law, row = contact.law, contact.params
    if not law.adhesive:
        return np.zeros(moved.step.size)
    if law.branched:
        jumps = zip(moved.before.astype(float), moved.rung.astype(float), strict=True)
        return np.array([law.jump_energy(before, after, row) for before, after in jumps])
    on, off = (law.energy(law.state(x, row), row) for x in (1.0, 0.0))
    return np.where(moved.rung > 0, -on, off)

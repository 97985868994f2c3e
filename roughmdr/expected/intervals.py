"""Intervals of the heights of the summits that are in contact at each step of the path, with their branches."""

import math
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from roughmdr.aggregate import LoadingPath
from roughmdr.asperity.contact import Contact
from roughmdr.expected.curve import branch_ends
from roughmdr.kernels.profile.layout import FUNCTIONS, ONSET
from roughmdr.numerics.arguments import Floats, Ints


class Intervals(NamedTuple):
    """Summits from ``begin`` to ``end`` [m] that at a step are on a branch, or jump from one to another; 0 is none."""

    step: NDArray[np.int64]
    branch_before: NDArray[np.int64]
    branch: NDArray[np.int64]
    begin: Floats
    end: Floats

    @classmethod
    def of(cls, rows: list[tuple[int, int, int, float, float]]) -> "Intervals":
        """Return intervals from tuples in the order of the fields."""
        columns = np.array(rows, dtype=np.float64).reshape(-1, 5).T
        step, before, branch = columns[:3].astype(np.int64)
        return cls(step, before, branch, columns[3], columns[4])

    def some(self, which: NDArray[np.bool_] | Ints) -> "Intervals":
        """Return some of the intervals, by their numbers or by whether they are among them."""
        return Intervals(
            self.step[which], self.branch_before[which], self.branch[which], self.begin[which], self.end[which]
        )

    def at_steps(self, selected: NDArray[np.bool_]) -> "Intervals":
        """Return the intervals of the steps that are ``selected`` [step]."""
        return self.some(selected[self.step])

    def around(self, height: float) -> "Intervals":
        """Return the intervals that hold a height [m], at most one a step."""
        return self.some((self.begin <= height) & (height < self.end))

    def up_to(self, ends: Floats) -> "Intervals":
        """Return the part of each interval below ``ends`` [step]; those that begin there are left out."""
        cut = self._replace(end=ends[self.step])
        return cut.some(cut.begin < cut.end)

    def disjoint(self, separation: Floats) -> "tuple[Intervals, Ints, Ints]":
        """Return intervals that end where others at the same separation [m] and on the same branch begin.

        They are numbered instead of the steps, which are returned with how many intervals each has to be added to.
        """
        order = np.lexsort((-self.begin, self.end, self.branch, separation[self.step]))
        step, before, branch, begin, end = self.some(order)
        same = np.zeros(step.size, dtype=bool)
        same[1:] = (separation[step[1:]] == separation[step[:-1]]) & (branch[1:] == branch[:-1]) & (end[1:] == end[:-1])
        number = np.arange(step.size)
        rank = np.asarray(number - np.maximum.accumulate(np.where(same, 0, number)), dtype=np.int64)
        end[1:] = np.where(same[1:], begin[:-1], end[1:])
        return Intervals(number, before, branch, begin, end), step, rank


def has_branches(contact: Contact) -> bool:
    """Return whether summits in contact may be on several branches, or touch at a distance."""
    return bool(contact.kernels.branched and (contact.adhesion.cohesive or len(branch_ends(contact)[0]) > 1))


def contact_intervals(contact: Contact, path: LoadingPath) -> tuple[Intervals, Intervals]:
    """Return the summits in contact at each step, and those that jumped since the step before."""
    if has_branches(contact):
        return _with_branches(contact, path.separation)
    return _without_branches(contact, path)


def _without_branches(contact: Contact, path: LoadingPath) -> tuple[Intervals, Intervals]:
    """Return one interval a step: all summits above the lowest height that a pair of the staircase holds.

    A summit that the flat just touches is in contact only with adhesion.
    """
    depth = contact.depth[0] if contact.kernels.adhesive else 0.0
    memory = path.memory
    lowest = np.minimum.reduceat(np.maximum(memory.bottom, memory.top - depth), memory.first[:-1])
    if not contact.kernels.adhesive:
        lowest = np.nextafter(lowest, math.inf)
    steps = np.arange(lowest.size)
    ones = np.ones_like(steps)
    in_contact = Intervals(steps, ones, ones, lowest, np.full_like(lowest, math.inf))
    lowest_before = np.concatenate([[math.inf], lowest[:-1]])
    made = (lowest < lowest_before).astype(np.int64)
    jumped = Intervals(steps, 1 - made, made, np.minimum(lowest, lowest_before), np.maximum(lowest, lowest_before))
    return in_contact, jumped


def _with_branches(contact: Contact, separation: Floats) -> tuple[Intervals, Intervals]:
    """Divide the heights wherever a jump begins, and follow the branch of each interval from step to step."""
    params, depth, adhesion_range = contact.params, contact.depth[0], contact.adhesion.range
    feet, tops = branch_ends(contact)
    offsets = [*((x - 1.0) * depth for x in (*feet, *tops, float(params[ONSET]))), -adhesion_range]
    bounds, branches = [-math.inf, math.inf], [0]
    in_contact, jumped = [], []
    for step, h in enumerate(separation.tolist()):
        cuts = sorted({*bounds, *(h + offset for offset in offsets)})
        befores, afters = [], []
        number = 0
        for low, high in pairwise(cuts):
            while bounds[number + 1] <= low:
                number += 1
            z = _inside(low, high, depth)
            x = max(((z - h) + depth) / depth, 0.0)
            befores.append(branches[number])
            afters.append(int(contact.kernels.branch(x, float(branches[number]), z >= h - adhesion_range, params)))
        bounds, branches = [-math.inf], []
        for (low, high), before, after in zip(pairwise(cuts), befores, afters, strict=True):
            if before != after:
                jumped.append((step, before, after, low, high))
            if branches and branches[-1] == after:
                bounds[-1] = high
            else:
                branches.append(after)
                bounds.append(high)
        found = zip(branches, pairwise(bounds), strict=True)
        in_contact += [(step, branch, branch, low, high) for branch, (low, high) in found if branch > 0]
    return Intervals.of(in_contact), Intervals.of(jumped)


def _inside(low: float, high: float, depth: float) -> float:
    """Return a height between two, of which one may be infinite."""
    if low == -math.inf:
        return high - depth
    return low + depth if high == math.inf else 0.5 * (low + high)


def jump_energies(contact: Contact, jumped: Intervals) -> Floats:
    """Return the energy over its natural scale that a contact loses in each of these jumps."""
    kernels, params = contact.kernels, contact.params
    if not kernels.adhesive:
        return np.zeros(jumped.step.size)
    if kernels.branched:
        jumps = zip(jumped.branch_before.astype(float), jumped.branch.astype(float), strict=True)
        if kernels.functions is not None:  # the energy is called by an address that a row of forces does not hold
            params = params.copy()
            params[FUNCTIONS] = kernels.functions(False, True)
        return np.array([kernels.jump_energy(before, after, params) for before, after in jumps])
    made, lost = (kernels.energy(kernels.state(x, params), params) for x in (1.0, 0.0))
    return np.where(jumped.branch > 0, -made, lost)

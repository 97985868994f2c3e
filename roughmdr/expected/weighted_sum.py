"""The law of a few asperities with weights, along the path of the flat: a plain sum over their contacts."""

import math

import numpy as np

from roughmdr.expected.height_rules import Points
from roughmdr.expected.node import QuadratureNode
from roughmdr.kernels.elementwise import apply
from roughmdr.numerics.arguments import Floats, Ints

FORCE, AREA, COUNT = range(3)
_AT_ONCE = 2**21  # contacts


def weighted_sum(node: QuadratureNode, rule: Points, separation: Floats) -> Floats:
    """Return force [N], contact area [m2] and number in contact at each separation [m] of the node's path: [row, step].

    The heights of ``rule`` are differences to the origin of those of the node, ascending.
    """
    y, weights = rule
    steps, branches = node.in_contact.step, node.in_contact.branch
    first, last = np.searchsorted(y, node.in_contact.begin), np.searchsorted(y, node.in_contact.end)
    total = np.zeros((3, separation.size))
    rows = max(1, _AT_ONCE // max(y.size, 1))
    for begin in range(0, steps.size, rows):
        part = np.arange(begin, min(begin + rows, steps.size))
        sizes = np.maximum(last[part] - first[part], 0)
        row = np.repeat(part, sizes)
        number = np.arange(row.size) - np.repeat(np.cumsum(sizes) - sizes, sizes) + first[row]
        force, radius = _contacts(node, y[number] - (separation[steps[row]] - node.heights.origin), branches[row])
        weight = weights[number]
        touching = np.where(radius > 0.0, 1.0, 0.0)
        for quantity, values in ((FORCE, force), (AREA, math.pi * radius * radius), (COUNT, touching)):
            total[quantity] += np.bincount(steps[row], weight * values, separation.size)
    return total


def _contacts(node: QuadratureNode, indentation: Floats, branch: Ints) -> tuple[Floats, Floats]:
    """Return force [N] and radius [m] of contacts at indentations [m] on their branches."""
    contact = node.contact
    x = contact.reduced(indentation, contact.depth)
    if not contact.law.branched:
        radius, force, _ = contact.radius_force_stiffness(apply(contact.law.state, x, contact.params))
        return force, radius
    force, radius = np.zeros_like(x), np.zeros_like(x)
    for number in np.unique(branch):
        on = branch == number
        state = apply(contact.law.state_on_branch, x[on], float(number), contact.params)
        radius[on], force[on], _ = contact.radius_force_stiffness(state)
    return force, radius

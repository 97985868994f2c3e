"""The law of a few asperities with weights, along the path of the flat: a plain sum over their contacts."""

import numpy as np

from roughmdr.aggregate.totals import AREA, COUNT, FORCE
from roughmdr.expected.curve import quantities_of
from roughmdr.expected.height_rules import Points
from roughmdr.expected.node import QuadratureNode
from roughmdr.numerics.arguments import Floats

_ROWS = (FORCE, AREA, COUNT)
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
        indentation = y[number] - (separation[steps[row]] - node.heights.origin)
        for quantity, values in enumerate(quantities_of(node.contact, indentation, branches[row], _ROWS)):
            total[quantity] += np.bincount(steps[row], weights[number] * values, separation.size)
    return total

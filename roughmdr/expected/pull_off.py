"""The pull-off of the expected law: the largest tension of its unloadings."""

import numpy as np

from roughmdr.aggregate import LoadingPath
from roughmdr.aggregate.totals import AREA, COUNT, FORCE
from roughmdr.expected.converge import Converged
from roughmdr.expected.node import MeanProblem, QuadratureNode, moved
from roughmdr.expected.split_rules import KinkSplit
from roughmdr.loading.pull_off import WITHOUT_TENSION, PullOff, Unloading, locate, unloadings
from roughmdr.numerics.arguments import Floats

_FEW, _FEW_OF_MOST = 0.5, 0.01
"""Expected contacts at the end of an unloading that are none: less than half a contact, and less than one in a hundred
of those at closest approach. Heights without an end never all detach."""


def pull_off_of(problem: MeanProblem, split: KinkSplit | None, chosen: Converged, force: Floats) -> PullOff:
    """Return the pull-off, given the rule of the expected law and the force of all asperities [N] at each step.

    NaN where no unloading ends out of contact.
    """
    path, count, nodes = problem.path, problem.source.expected_count, chosen.nodes
    rises = unloadings(path.separation, force)
    if not ends_apart(rises, count * _fraction_in_contact(nodes, path.separation.size)):
        return PullOff()
    if not problem.kernels.adhesive:
        return WITHOUT_TENSION

    def totals(along: LoadingPath, rows: tuple[int, ...]) -> Floats:
        return count * chosen.sums(problem._replace(path=along, rows=rows), moved(nodes, along), dissipating=False)[0]

    found = locate(rises, lambda along: totals(along, problem.rows[:1])[FORCE])
    if found is None:
        return WITHOUT_TENSION
    last = found.path.separation.size - 1
    exact = None if split is None else KinkSplit.of(problem._replace(path=found.path))
    if exact is not None and last in exact.cuts:
        there = count * exact.total(last, dissipating=False)
    else:
        there = totals(found.path, problem.rows)[:, last]
    return PullOff(*map(float, (there[FORCE], found.path.separation[last], there[COUNT], there[AREA])))


def ends_apart(rises: list[Unloading], contacts: Floats) -> bool:
    """Return whether an unloading ends out of contact, given the number of contacts at each step."""
    parted = min(_FEW, _FEW_OF_MOST * float(contacts.max()))
    return any(contacts[rise.last] <= parted for rise in rises)


def _fraction_in_contact(nodes: list[QuadratureNode], steps: int) -> Floats:
    """Return the fraction of all asperities that are in contact, or attracted: [step]."""
    fraction = np.zeros(steps)
    for node in nodes:
        begin, end = node.in_contact.begin, node.in_contact.end
        np.add.at(fraction, node.in_contact.step, node.fraction * node.heights.between(begin, end))
    return fraction

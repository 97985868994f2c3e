"""The pull-off of the expected law: the largest tension of its unloadings."""

import numpy as np

from roughmdr.aggregate import LoadingPath
from roughmdr.aggregate.totals import COUNT, FORCE
from roughmdr.ensemble.nodes import Rule
from roughmdr.expected.intervals import contact_intervals
from roughmdr.expected.kinks import KinkSplit
from roughmdr.expected.node import Problem, QuadratureNode, set_up, totals_of
from roughmdr.loading.pull_off import WITHOUT_TENSION, PullOff, locate, unloadings
from roughmdr.numerics.arguments import Floats

_FEW, _FEW_OF_MOST = 0.5, 0.01
"""Expected contacts at the end of an unloading that are none: less than half a contact, and less than one in a hundred
of those at closest approach. Heights without an end never all detach."""


def pull_off_of(
    problem: Problem, split: KinkSplit | None, rule: Rule, nodes: list[QuadratureNode], force: Floats
) -> PullOff:
    """Return the pull-off, given the nodes of a rule and the force of all asperities [N] at each step.

    NaN where no unloading ends out of contact.
    """
    path, count = problem.path, problem.source.expected_count
    rises = unloadings(path.separation, force)
    bearing = count * _fraction_in_contact(nodes, path.separation.size)
    parted = min(_FEW, _FEW_OF_MOST * float(bearing.max()))
    if not any(bearing[rise.last] <= parted for rise in rises):
        return PullOff()
    if not problem.law.adhesive:
        return WITHOUT_TENSION
    rows = (FORCE, COUNT)
    if COUNT not in problem.rows:
        nodes = set_up(problem._replace(rows=rows), rule)

    def evaluate(refined: LoadingPath) -> tuple[Floats, Floats]:
        moved = [
            node._replace(in_contact=contact_intervals(node.contact, refined.relative_to(node.heights.origin))[0])
            for node in nodes
        ]
        own_rows = problem.rows if COUNT in problem.rows else rows
        total, _ = totals_of(moved, refined.separation, own_rows, list(range(refined.separation.size)))
        return count * total[FORCE], count * total[COUNT]

    found = [(locate([rise], evaluate), rise) for rise in rises]
    lowest, rise = min(found, key=lambda each: each[0].force)
    if not lowest.force < 0.0:
        return WITHOUT_TENSION
    if split is not None:
        there = rise.path(np.array([lowest.separation]))
        if exact := KinkSplit.of(problem._replace(path=there, rows=rows)):
            step = there.separation.size - 1
            if step in exact.cuts:
                total = count * exact.total(step, dissipating=False)
                return PullOff(float(total[FORCE]), lowest.separation, float(total[COUNT]))
    return lowest


def _fraction_in_contact(nodes: list[QuadratureNode], steps: int) -> Floats:
    """Return the fraction of all asperities that are in contact, or attracted: [step]."""
    fraction = np.zeros(steps)
    for node in nodes:
        begin, end = node.in_contact.begin, node.in_contact.end
        np.add.at(fraction, node.in_contact.step, node.fraction * node.heights.between(begin, end))
    return fraction

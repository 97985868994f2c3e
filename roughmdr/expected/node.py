"""The nodes of a rule over the shape parameters: the contact of each, its heights and its intervals, and their sums."""

from typing import NamedTuple

import numpy as np

from roughmdr.aggregate import LoadingPath
from roughmdr.aggregate.totals import ERROR, ROWS, STIFFNESS
from roughmdr.asperity.contact import Contact
from roughmdr.ensemble import Source
from roughmdr.ensemble.nodes import Nodes, Rule
from roughmdr.expected.curve import Curve, curves_of, scales_of
from roughmdr.expected.heights import HeightTable
from roughmdr.expected.integral import integrate
from roughmdr.expected.intervals import Intervals, contact_intervals, jump_energies
from roughmdr.kernels.adhesion import Adhesion
from roughmdr.kernels.interface import Kernels
from roughmdr.numerics.arguments import Floats
from roughmdr.shapes import SHAPES


class Problem(NamedTuple):
    """The asperities, the path, the material, and the totals that are to be computed."""

    source: Source
    path: LoadingPath
    effective_modulus: float
    adhesion: Adhesion
    rows: tuple[int, ...]
    """Rows of the totals; the first is FORCE."""
    unjudged: tuple[int, ...] = ()
    """Of these, rows whose error does not count: the model error alone needs them."""

    @property
    def judged(self) -> tuple[int, ...]:
        """The first rows, whose errors count: not the stiffness, which is infinite at detachment."""
        return tuple(row for row in self.rows if row not in (STIFFNESS, *self.unjudged))

    @property
    def law(self) -> Kernels:
        """Kernels of one asperity."""
        return contacts_of(self, self.source.nodes(Rule(np.zeros(1), np.ones(1))))[0].law

    @property
    def hysteretic(self) -> bool:
        """Whether contacts depend on the path before: the surfaces adhere, and the flat rises."""
        return self.adhesion.work > 0.0 and bool((np.diff(self.path.separation) > 0.0).any())


class QuadratureNode(NamedTuple):
    """Asperities with equal shape parameters, as a fraction of all."""

    fraction: float
    contact: Contact
    curve: Curve
    heights: HeightTable
    in_contact: Intervals
    """Of heights as differences to the origin of ``heights``."""
    jumped: Intervals
    """Likewise."""


def contacts_of(problem: Problem, nodes: Nodes) -> list[Contact]:
    """Return the contact of each node; OutOfRange where one is not representable."""
    shape = SHAPES[problem.source.shape_name]
    columns = {name: column.tolist() for name, column in nodes.parameters.items()}
    shapes = [
        problem.source.shared_profile or shape(**{name: column[number] for name, column in columns.items()})
        for number in range(nodes.weights.size)
    ]
    return [Contact.of(one, problem.effective_modulus, problem.adhesion) for one in shapes]


def set_up(problem: Problem, rule: Rule) -> list[QuadratureNode]:
    """Return the nodes at the scores of a rule."""
    nodes = problem.source.nodes(rule)
    contacts = contacts_of(problem, nodes)
    tables = {heights: HeightTable.of(heights) for heights in dict.fromkeys(nodes.heights)}
    curves = curves_of(contacts, nodes.heights, float(problem.path.separation.min()), problem.rows)
    each = zip(nodes.weights.tolist(), contacts, curves, (tables[heights] for heights in nodes.heights), strict=True)
    return [
        QuadratureNode(
            fraction, contact, curve, heights, *contact_intervals(contact, problem.path.relative_to(heights.origin))
        )
        for fraction, contact, curve, heights in each
    ]


def moved(nodes: list[QuadratureNode], path: LoadingPath) -> list[QuadratureNode]:
    """Return the nodes along another path, which comes no closer than that of their tables."""
    parts = [contact_intervals(node.contact, path.relative_to(node.heights.origin)) for node in nodes]
    pairs = zip(nodes, parts, strict=True)
    return [node._replace(in_contact=in_contact, jumped=jumped) for node, (in_contact, jumped) in pairs]


def totals_of(
    nodes: list[QuadratureNode], separation: Floats, rows: tuple[int, ...], steps: list[int]
) -> tuple[Floats, int]:
    """Return the totals of one asperity [row, step], 0 but at ``steps``, and how often tables were multiplied.

    Row ERROR is the error bound of the first of ``rows``, the force.
    """
    total, products = np.zeros((ROWS, separation.size)), 0
    selected = np.isin(np.arange(separation.size), steps)
    stiffness_row = rows.index(STIFFNESS) if STIFFNESS in rows else -1
    for fraction, contact, curve, heights, in_contact, _ in nodes:
        intervals, order, rank = in_contact.at_steps(selected).disjoint(separation)
        found = np.zeros((len(rows) + 1, order.size))
        relative = separation[order] - heights.origin
        products += integrate(intervals, relative, contact.depth[0], curve, heights, stiffness_row, found)
        for number in range(1, rank.max(initial=0) + 1):
            within = np.flatnonzero(rank == number)
            found[:, within] += found[:, within - 1]
        scales = fraction * scales_of(contact, rows)
        found *= np.append(scales, scales[0])[:, None]
        for row, values in zip((*rows, ERROR), found, strict=True):
            total[row] += np.bincount(order, values, separation.size)
    return total, products


def undecided_of(nodes: list[QuadratureNode], steps: int) -> Floats:
    """Return the fraction of all asperities of which it is not known whether they are in contact: [step]."""
    undecided = np.zeros(steps)
    for node in nodes:
        for ends in (node.in_contact.begin, node.in_contact.end):
            np.add.at(undecided, node.in_contact.step, node.fraction * node.heights.undecided(ends))
    return undecided


def dissipated_of(nodes: list[QuadratureNode], steps: int) -> Floats:
    """Return the energy [J] that an asperity has lost in jumps up to each step."""
    dissipated = np.zeros(steps)
    for fraction, contact, _, heights, _, jumped in nodes:
        scale = fraction * contact.force * contact.depth[0]
        jumping = heights.between(jumped.begin, jumped.end)
        np.add.at(dissipated, jumped.step, scale * jump_energies(contact, jumped) * jumping)
    return np.cumsum(dissipated)

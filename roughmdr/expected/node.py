"""The nodes of a rule over the shape parameters: the contact of each, its heights and its intervals, and their sums."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from roughmdr.aggregate import LoadingPath
from roughmdr.aggregate.totals import ERROR, ROWS, STIFFNESS
from roughmdr.asperity.contact import Contact
from roughmdr.ensemble import Source
from roughmdr.ensemble.nodes import Heights, Nodes, Rule
from roughmdr.expected.curve import Curve, curves_of, curves_to_touch, quantities_of, scales_of
from roughmdr.expected.heights import HeightTable
from roughmdr.expected.integral import MeanContact, integrate
from roughmdr.expected.intervals import Intervals, contact_intervals, has_branches, jump_energies
from roughmdr.kernels.adhesion import Adhesion
from roughmdr.kernels.interface import Kernels
from roughmdr.numerics.arguments import Floats
from roughmdr.shapes import SHAPES


class MeanProblem(NamedTuple):
    """The asperities, the path, the material, and the totals that are to be computed."""

    source: Source
    path: LoadingPath
    effective_modulus: float
    adhesion: Adhesion
    rows: tuple[int, ...]
    """Rows of the totals; the first is FORCE."""
    unjudged: tuple[int, ...] = ()
    """Rows among these whose error does not count: the model error alone needs them."""

    @property
    def judged(self) -> tuple[int, ...]:
        """The first rows, whose errors count: not the stiffness, which is infinite at detachment."""
        judged = tuple(row for row in self.rows if row not in (STIFFNESS, *self.unjudged))
        assert judged == self.rows[: len(judged)]  # they share the first curves of the nodes
        return judged

    @property
    def kernels(self) -> Kernels:
        """Kernels of one asperity."""
        return contacts_of(self, self.source.nodes(Rule(np.zeros(1), np.ones(1))))[0].kernels

    @property
    def hysteretic(self) -> bool:
        """Whether contacts depend on the path before: the surfaces adhere, and the flat rises."""
        return self.adhesion.work > 0.0 and bool((np.diff(self.path.separation) > 0.0).any())


class QuadratureNode(NamedTuple):
    """Asperities with equal shape parameters, as a fraction of all."""

    fraction: float
    contact: Contact
    curve: Curve | None
    """Up to first touch where ``above`` is given; None where there is nothing to it, without adhesion, or where all
    heights are equal."""
    heights: HeightTable
    above: MeanContact | None
    """The mean contact above first touch of all nodes that were set up with these heights; None where the curve goes
    on."""
    in_contact: Intervals
    """Intervals of heights in contact, as differences to the origin of ``heights``."""
    jumped: Intervals
    """Intervals of heights that have jumped, likewise."""


def contacts_of(problem: MeanProblem, nodes: Nodes) -> list[Contact]:
    """Return the contact of each node; OutOfRange where one is not representable."""
    shape = SHAPES[problem.source.shape_name]
    columns = {name: column.tolist() for name, column in nodes.parameters.items()}
    shapes = [
        problem.source.shared_profile or shape(**{name: column[number] for name, column in columns.items()})
        for number in range(nodes.weights.size)
    ]
    return [Contact.rounded(one, problem.effective_modulus, problem.adhesion) for one in shapes]


def set_up(problem: MeanProblem, *rules: Rule, shared: bool = True) -> list[QuadratureNode]:
    """Return the nodes at the scores of a rule, or of one for each random parameter.

    Where tables are ``shared``, nodes of one branch have curves up to first touch and one mean contact above it; else
    each has the whole curve of its contact.
    """
    nodes, rows, closest = problem.source.nodes(*rules), problem.rows, float(problem.path.separation.min())
    contacts = contacts_of(problem, nodes)
    heights_of = {heights: HeightTable.of(heights) for heights in dict.fromkeys(nodes.heights)}
    spread = [number for number, heights in enumerate(nodes.heights) if not heights_of[heights].all_equal]
    whole = [number for number in spread if not shared or _is_apart(contacts[number])]
    groups: dict[Heights, list[int]] = {}
    for number in sorted(set(spread).difference(whole)):
        groups.setdefault(nodes.heights[number], []).append(number)
    curves: dict[int, Curve] = {}
    above: dict[int, MeanContact] = {}
    if whole:
        found = curves_of([contacts[k] for k in whole], [nodes.heights[k] for k in whole], closest, rows)
        curves |= dict(zip(whole, found, strict=True))
    for heights, alike in groups.items():
        own, fractions = [contacts[k] for k in alike], nodes.weights[alike]
        mean = MeanContact.of(own, fractions, (heights, heights_of[heights]), closest, rows)
        above |= dict.fromkeys(alike, mean)
    if one_branch := [number for alike in groups.values() for number in alike if contacts[number].kernels.adhesive]:
        found = curves_to_touch([contacts[k] for k in one_branch], nodes.weights[one_branch], rows)
        curves |= dict(zip(one_branch, found, strict=True))
    each = zip(nodes.weights.tolist(), contacts, (heights_of[heights] for heights in nodes.heights), strict=True)
    return [
        QuadratureNode(
            fraction,
            contact,
            curves.get(number),
            heights,
            above.get(number),
            *contact_intervals(contact, problem.path.relative_to(heights.origin)),
        )
        for number, (fraction, contact, heights) in enumerate(each)
    ]


def _is_apart(contact: Contact) -> bool:
    """Return whether a contact shares no curve: where it has branches, or a kink above first touch, each its own one,
    which a mean curve would have all.
    """
    return has_branches(contact) or (not contact.shape.flat and contact.shape.breakpoints.size > 0)


def moved(nodes: list[QuadratureNode], path: LoadingPath) -> list[QuadratureNode]:
    """Return the nodes along another path, which comes no closer than that of their tables."""
    parts = [contact_intervals(node.contact, path.relative_to(node.heights.origin)) for node in nodes]
    pairs = zip(nodes, parts, strict=True)
    return [node._replace(in_contact=in_contact, jumped=jumped) for node, (in_contact, jumped) in pairs]


def totals_of(
    nodes: list[QuadratureNode], separation: Floats, rows: tuple[int, ...], steps: list[int]
) -> tuple[Floats, int]:
    """Return the totals of one asperity [row, step], 0 but at ``steps``, and how often tables were multiplied.

    Row ERROR is the error bound of the first of ``rows``, the force. The nodes are all that were set up together.
    """
    total, products = np.zeros((ROWS, separation.size)), 0
    selected = np.zeros(separation.size, dtype=np.bool_)
    selected[steps] = True
    stiffness_row = rows.index(STIFFNESS) if STIFFNESS in rows else -1
    found = np.zeros((len(rows) + 1, separation.size))
    for mean in {id(node.above): node.above for node in nodes if node.above is not None}.values():
        products += mean.add_to(found, separation, np.flatnonzero(selected), stiffness_row)
    for node in nodes:
        add = _add_equal if node.heights.all_equal else _add_node
        products += add(node, found, separation, selected, rows)
    total[[*rows, ERROR]] = found
    return total, products


def _add_node(
    node: QuadratureNode, total: Floats, separation: Floats, selected: NDArray[np.bool_], rows: tuple[int, ...]
) -> int:
    """Add the sums over the summits of a node, where others share its curve only over those that the flat is not above,
    to total[row, step]; return how often tables were multiplied.
    """
    contact, heights = node.contact, node.heights
    own = node.in_contact.at_steps(selected)
    if node.above is not None:
        own = own.up_to(separation - heights.origin)
    if node.curve is None or not own.step.size:
        return 0
    intervals, order, rank = own.disjoint(separation)
    found = np.zeros((len(rows) + 1, order.size))
    stiffness_row = rows.index(STIFFNESS) if STIFFNESS in rows else -1
    relative = separation[order] - heights.origin
    products = integrate(intervals, relative, contact.depth[0], node.curve, heights, stiffness_row, found)
    for number in range(1, rank.max(initial=0) + 1):
        within = np.flatnonzero(rank == number)
        found[:, within] += found[:, within - 1]
    scales = node.fraction * scales_of(contact, rows)
    found *= np.append(scales, scales[0])[:, None]
    for row, values in enumerate(found):
        total[row] += np.bincount(order, values, separation.size)
    return int(products)


def _add_equal(
    node: QuadratureNode, total: Floats, separation: Floats, selected: NDArray[np.bool_], rows: tuple[int, ...]
) -> int:
    """Add the contacts of a node whose heights are all equal to total[row, step]; return their number."""
    own = node.in_contact.at_steps(selected).around(0.0)
    indentation = node.heights.origin - separation[own.step]
    total[:-1, own.step] += node.fraction * quantities_of(node.contact, indentation, own.branch, rows)
    return own.step.size


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
    for node in nodes:
        contact, jumped = node.contact, node.jumped
        scale = node.fraction * contact.force * contact.depth[0]
        jumping = node.heights.between(jumped.begin, jumped.end)
        np.add.at(dissipated, jumped.step, scale * jump_energies(contact, jumped) * jumping)
    return np.cumsum(dissipated)

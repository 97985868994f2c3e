"""The nodes that stand for all asperities, each with what it bears and when it is in contact, and their sums."""

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
from roughmdr.expected.intervals import Intervals, lost, remember
from roughmdr.kernels.adhesion import Adhesion
from roughmdr.kernels.interface import Kernels
from roughmdr.numerics.arguments import Floats
from roughmdr.shapes import SHAPES


class Problem(NamedTuple):
    """What the expected law is asked of."""

    source: Source
    path: LoadingPath
    effective_modulus: float
    adhesion: Adhesion
    rows: tuple[int, ...]
    """As in ``totals``; the first is FORCE."""

    @property
    def law(self) -> Kernels:
        """The law of one asperity."""
        return contacts_of(self, self.source.nodes(Rule(np.zeros(1), np.ones(1))))[0].law

    @property
    def hysteretic(self) -> bool:
        """Whether contacts remember the path: where they stick, and the flat rises."""
        return self.adhesion.work > 0.0 and bool((np.diff(self.path.separation) > 0.0).any())


class Node(NamedTuple):
    """One node: its share of all asperities, what they bear, and when they are in contact."""

    share: float
    contact: Contact
    curve: Curve
    heights: HeightTable
    held: Intervals
    """Of heights as differences to the origin of ``heights``."""
    moved: Intervals
    """Likewise."""


def contacts_of(asked: Problem, nodes: Nodes) -> list[Contact]:
    """The contact of each node; OutOfRange where one is not representable."""
    shape = SHAPES[asked.source.shape_name]
    columns = {name: column.tolist() for name, column in nodes.parameters.items()}
    shapes = [
        asked.source.shared_profile or shape(**{name: column[number] for name, column in columns.items()})
        for number in range(nodes.weights.size)
    ]
    return [Contact.of(one, asked.effective_modulus, asked.adhesion) for one in shapes]


def set_up(asked: Problem, rule: Rule) -> list[Node]:
    """The nodes at the scores of a rule."""
    nodes = asked.source.nodes(rule)
    contacts = contacts_of(asked, nodes)
    tables = {heights: HeightTable.of(heights) for heights in dict.fromkeys(nodes.heights)}
    curves = curves_of(contacts, nodes.heights, float(asked.path.separation.min()), asked.rows)
    return [
        Node(float(share), contact, curve, tables[heights], *remember(contact, asked.path.seen_from(heights.origin)))
        for share, contact, curve, heights in zip(nodes.weights, contacts, curves, nodes.heights, strict=True)
    ]


def totals_of(nodes: list[Node], separation: Floats, rows: tuple[int, ...], steps: list[int]) -> tuple[Floats, int]:
    """[row, step] of ``totals`` for an asperity, at some steps (else 0); and how often tables were multiplied.

    Row ERROR is how far the first of ``rows``, the force, may be off.
    """
    total, products = np.zeros((ROWS, separation.size)), 0
    chosen = np.zeros(separation.size, dtype=np.bool_)
    chosen[steps] = True
    for share, contact, (first, foot, table), heights, held, _ in nodes:
        asked = chosen[held.step]
        found, error = np.zeros((len(rows), separation.size)), np.zeros(separation.size)
        products += integrate(
            held.step[asked],
            held.rung[asked],
            held.begin[asked],
            held.end[asked],
            separation - heights.origin,
            contact.depth[0],
            1.0 if contact.law.adhesive else 0.0,
            first,
            foot,
            table.low,
            table.high,
            table.coefficients,
            table.slack,
            heights.low,
            heights.high,
            heights.coefficients,
            heights.doubt,
            rows.index(STIFFNESS) if STIFFNESS in rows else -1,
            found,
            error,
        )
        scales = share * scales_of(contact, rows)
        total[list(rows)] += scales[:, None] * found
        total[ERROR] += scales[0] * error
    return total, products


def undecided_of(nodes: list[Node], steps: int) -> Floats:
    """The part of all asperities of which nothing tells at a step whether they are in contact: [step]."""
    found = np.zeros(steps)
    for share, _, _, heights, held, _ in nodes:
        for ends in (held.begin, held.end):
            np.add.at(found, held.step, share * heights.undecided(ends))
    return found


def dissipated_of(nodes: list[Node], steps: int) -> Floats:
    """The energy [J] that an asperity has lost in jumps up to each step."""
    spent = np.zeros(steps)
    for share, contact, _, heights, _, moved in nodes:
        worth = share * contact.force * contact.depth[0]
        parts = heights.between(moved.begin, moved.end)
        np.add.at(spent, moved.step, worth * lost(contact, moved) * parts)
    return np.cumsum(spent)

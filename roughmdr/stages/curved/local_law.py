"""The law per area of the rough layer on a ring: its pressure at a local separation, given the contacts it remembers.

Asperities of one set of shape parameters are in contact above one height, which is all the memory that a ring has of
them: the flat makes contacts down to its own height s, and where it rises loses those below s - d, d the depth at which
they detach. Along a path that is the staircase of ``loading/staircase.py``.
"""

import math
from typing import NamedTuple

import numpy as np

from roughmdr.aggregate.totals import AREA, COUNT, FORCE, RADIUS, STIFFNESS
from roughmdr.expected.curve import scales_of
from roughmdr.expected.heights import HeightTable
from roughmdr.expected.integral import integrate
from roughmdr.expected.intervals import Intervals
from roughmdr.expected.node import QuadratureNode
from roughmdr.expected.table import AdaptiveTable
from roughmdr.kernels.elementwise import apply
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.chebyshev import find_piece, series_at
from roughmdr.numerics.jit import njit

ROWS = (FORCE, STIFFNESS, AREA, COUNT, RADIUS)
"""Rows of the totals that the nodes have tables of, in this order."""
_OF_SLOPE = 2  # number of these rows, from the first, that are computed where the slope alone is asked for
_RTOL_TABLE, _NARROWEST = 1e-11, 1e-7  # error over the largest value on a piece; narrowest piece over the scale


class LocalLaw(NamedTuple):
    """The law per area from the nodes of the expected law, with the number of asperities per area.

    Without adhesion it depends on the separation alone, and is tabulated.
    """

    nodes: list[QuadratureNode]
    density: float
    """Asperities per area [1/m2]."""
    scale: float
    """The width of the heights [m], over which the pressure changes."""
    closest: float
    """The least separation [m] of the tables; below it the pressure is taken as constant, so that rings still find an
    equilibrium, which shows how deep tables must go."""
    table: AdaptiveTable | None = None
    """``ROWS`` per area over the separation."""

    @classmethod
    def of(cls, nodes: list[QuadratureNode], density: float, scale: float, closest: float) -> "LocalLaw":
        """Return the law of nodes; the arguments are the fields."""
        law = cls(nodes, density, scale, closest)
        if law.adhesive:
            return law

        def rows(s: Floats) -> Floats:
            return law._summed(s, np.broadcast_to(s, (len(nodes), s.size)), len(ROWS))

        def min_width(low: Floats, high: Floats) -> Floats:
            return np.full_like(low, _NARROWEST * scale)

        def weight(low: Floats, high: Floats, largest: Floats) -> Floats:
            return np.ones_like(low)

        ends = np.array([closest, max(law.highest, closest + scale)])
        tolerance = np.full(len(ROWS), _RTOL_TABLE)
        return law._replace(table=AdaptiveTable.of(rows, ends, tolerance, min_width, weight))

    @property
    def highest(self) -> float:
        """The separation [m] at which the layer first touches."""
        return max(node.heights.origin + float(node.heights.high[-1]) for node in self.nodes)

    @property
    def adhesive(self) -> bool:
        """Whether rings have a memory."""
        return bool(self.nodes[0].contact.kernels.adhesive)

    @property
    def range(self) -> float:
        """The largest depth [m] at which contacts detach; 0 without adhesion."""
        return max(self._depths) if self.adhesive else 0.0

    @property
    def _depths(self) -> list[float]:
        return [float(node.contact.depth[0]) for node in self.nodes]

    def untouched(self, rings: int) -> Floats:
        """Return the memory of rings that have no contacts: [node, ring]."""
        return np.full((len(self.nodes), rings), math.inf)

    def remember(self, s: Floats, memory: Floats) -> Floats:
        """Return the lowest height [m] in contact, of each node on each ring, at separations s [m] after ``memory``."""
        if not self.adhesive:
            return np.broadcast_to(s, memory.shape)
        return np.asarray(np.minimum(np.maximum(memory, s - np.array(self._depths)[:, None]), s))

    def pressure(self, s: Floats, memory: Floats) -> tuple[Floats, Floats]:
        """Return p [Pa] and dp/ds [Pa/m] at separations s [m], reached monotonically after ``memory``."""
        within = np.maximum(s, self.closest)
        if self.table is None:
            pressure, slope = self._remembered(within, memory)
        else:
            pressure, stiffness = _read(self.table, within, _OF_SLOPE)
            slope = -stiffness
        return pressure, np.where(s < self.closest, 0.0, slope)

    def _remembered(self, s: Floats, memory: Floats) -> tuple[Floats, Floats]:
        """Return p and dp/ds with adhesion, contacts that are made or lost as s changes included."""
        lowest = self.remember(s, memory)
        pressure, stiffness = self._summed(s, lowest, _OF_SLOPE)
        slope = -stiffness
        for node, edge, before in zip(self.nodes, lowest, memory, strict=True):
            touching, detaching = _end_forces(node)
            gained = np.where(edge < before, touching, np.where(edge > before, detaching, 0.0))
            y = edge - node.heights.origin
            density = np.where(y < node.heights.low[0], 0.0, _read(node.heights, y, 1)[0])
            slope -= self.density * node.fraction * np.where(gained != 0.0, gained * density, 0.0)
        return pressure, slope

    def totals(self, s: Floats, lowest: Floats) -> dict[int, Floats]:
        """Return the totals per area of ``ROWS`` at separations s [m] with contacts above ``lowest`` [node, ring]."""
        found: Floats = self._summed(s, lowest, len(ROWS)) if self.table is None else _read(self.table, s, len(ROWS))
        return dict(zip(ROWS, found, strict=True))

    def pushing(self, s: Floats, lowest: Floats) -> Floats:
        """Return the pressure [Pa] of the contacts that push, at least 0; without adhesion these are all."""
        if not self.adhesive:
            return self.pressure(s, lowest)[0]
        unloaded = [float(node.contact.at_force(np.zeros(1))["indentation"][0]) for node in self.nodes]
        return np.asarray(self._summed(s, np.maximum(lowest, s + np.array(unloaded)[:, None]), 1)[0])

    def _summed(self, s: Floats, lowest: Floats, rows: int) -> Floats:
        """Return the first ``rows`` totals per area, summed over the nodes: [row, ring]."""
        found = np.zeros((rows, s.size))
        for node, edge in zip(self.nodes, lowest, strict=True):
            found += node.fraction * _integrals(node, s, edge, rows)
        return np.asarray(self.density * found)


def _integrals(node: QuadratureNode, s: Floats, lowest: Floats, rows: int) -> Floats:
    """Return the first ``rows`` totals of an asperity of a node on each ring: [row, ring]."""
    assert node.curve is not None
    found, ones = np.zeros((rows + 1, s.size)), np.ones(s.size, dtype=np.int64)
    origin, infinite = node.heights.origin, np.full(s.size, math.inf)
    each = Intervals(np.arange(s.size), ones, ones, lowest - origin, infinite)
    integrate(each, s - origin, node.contact.depth[0], node.curve, node.heights, ROWS.index(STIFFNESS), found)
    return np.asarray(found[:-1] * scales_of(node.contact, ROWS[:rows])[:, None])


@njit
def _read(table: AdaptiveTable | HeightTable, s: Floats, rows: int) -> Floats:
    """Return the first ``rows`` of a table at each s [m] above its lower end; 0 above its upper: [row, ring]."""
    found = np.zeros((rows, s.size))
    for i in range(s.size):
        if s[i] < table.high[-1]:
            piece = find_piece(table.high, s[i])
            low, high = table.low[piece], table.high[piece]
            u = (2.0 * s[i] - low - high) / (high - low)
            for row in range(rows):
                found[row, i] = series_at(table.coefficients[piece, row], u)
    return found


def _end_forces(node: QuadratureNode) -> tuple[float, float]:
    """Return the force [N] of a contact at first touch, and just before it detaches."""
    kernels, params = node.contact.kernels, node.contact.params
    state = apply(kernels.state, np.array([1.0, 0.0]), params)
    touching, detaching = node.contact.force * apply(kernels.force, state, params)
    return float(touching), float(detaching)

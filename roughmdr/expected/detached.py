"""Gauss's rule over the shape parameters at steps at which the lowest summits have detached for some of them only.

The flat has risen from ``bottom`` to ``top``. Summits of a node are in contact from the higher of bottom and
top - depth on, which has a kink over the parameters where depth = top - bottom. Sums from top - depth on are smooth.
From these is taken what lies below bottom,

    ∫_0^1 2 s ds  E[q(s) depth phi(top - (1 - s^2) depth);  (1 - s^2) depth > top - bottom],

q a quantity of a contact and s^2 its distance to detachment over the depth, phi the density of heights. At fixed s the
expectation E is that of a smooth function over a part of all parameters: along one axis of the scores the weights are
those of integrals up to where the depth has the limit, with the nodes that all steps share.
"""

import math
from typing import NamedTuple

import numpy as np

from roughmdr.aggregate.totals import DISSIPATED, ERROR, STIFFNESS
from roughmdr.ensemble.nodes import Line, Rule, crossings, lines_along, weighty
from roughmdr.expected.curve import Curve, scales_of
from roughmdr.expected.heights import HeightTable
from roughmdr.expected.intervals import Intervals, has_branches, jump_energies
from roughmdr.expected.node import MeanProblem, QuadratureNode, dissipated_of, totals_of
from roughmdr.expected.table import ORDER
from roughmdr.numerics.arguments import Floats, Ints
from roughmdr.numerics.chebyshev import find_piece, series_at
from roughmdr.numerics.gauss import last_coefficients, unit_gauss
from roughmdr.numerics.jit import njit

_ORDER = 48  # order of the rule over s on each of two panels, which meet where the median depth has the limit
_NODES, _WEIGHTS = unit_gauss(_ORDER)
_LAST = last_coefficients(_ORDER)
_NEAR_END, _NO_HEIGHTS = (
    0.01,
    1e-12,
)  # share of the range of heights; of all heights: more mean an end
_KINK = 1e-6  # jump of the slope of a smooth density, over its largest slope, at most
_NEGLIGIBLE = 1e-14  # fraction of all asperities that is left out


class PartialRule(NamedTuple):
    """A rule for smooth functions, with the weights of parts of it at the steps that need them."""

    problem: MeanProblem
    nodes: list[QuadratureNode]
    lines: list[Line]
    steps: Ints
    """Steps that need the parts."""

    @classmethod
    def of(cls, problem: MeanProblem, rules: tuple[Rule, ...], nodes: list[QuadratureNode]) -> "PartialRule | None":
        """Return None where no step needs it, or where it does not hold.

        It holds while the flat has turned once only, for heights whose density is smooth and contacts of one branch,
        and where the depth is monotone along an axis of the scores.
        """
        memory = problem.path.memory
        if not problem.hysteretic or problem.adhesion.cohesive or memory.top.size != problem.path.separation.size:
            return None
        rise = memory.top - memory.bottom
        shallowest, _, deepest = _range(nodes)
        steps = np.flatnonzero((rise > shallowest) & (rise < deepest))
        if not steps.size or not all(map(_are_smooth, {id(node.heights): node.heights for node in nodes}.values())):
            return None
        log_depths, fractions = np.array([(math.log(node.contact.depth[0]), node.fraction) for node in nodes]).T
        lines = [
            line
            for line in lines_along(problem.source.node_axes, rules, log_depths)
            if fractions[line.numbers].sum() > _NEGLIGIBLE
        ]
        monotone = all(_is_monotone(log_depths[line.numbers][weighty(line.rule)]) for line in lines)
        one_branch = not any(has_branches(nodes[number].contact) for line in lines for number in line.numbers)
        return cls(problem, nodes, lines, steps) if lines and monotone and one_branch else None

    def totals(self, steps: list[int]) -> tuple[Floats, int]:
        """Return the totals of one asperity [row, step], 0 but at some steps, and how often tables were multiplied.

        The energy lost in jumps is not among them.
        """
        separation, rows = self.problem.path.separation, self.problem.rows
        nodes = list(self.nodes)
        for number in np.concatenate([line.numbers for line in self.lines]).tolist():
            node = nodes[number]
            begin = node.in_contact.begin.copy()
            begin[self.steps] = separation[self.steps] - node.heights.origin - node.contact.depth[0]
            nodes[number] = node._replace(in_contact=node.in_contact._replace(begin=begin))
        total, products = totals_of(nodes, separation, rows, steps)
        kinked = np.intersect1d(self.steps, steps)
        if not kinked.size:
            return total, products
        below, error = self._replace(steps=kinked)._below_bottom()
        total[np.array(rows)[:, None], kinked] -= below
        total[ERROR, kinked] += error
        return total, products

    def _below_bottom(self) -> tuple[Floats, Floats]:
        """Return what the summits below bottom would bear, [row, step], and the error bound of the force."""
        memory, rows = self.problem.path.memory, self.problem.rows
        bottom, top = memory.bottom[self.steps], memory.top[self.steps]
        _, middle, deepest = _range(self.nodes)
        farthest = np.sqrt(1.0 - (top - bottom) / deepest)
        turn = np.sqrt(np.maximum(1.0 - (top - bottom) / middle, 0.25 * farthest * farthest))
        begin, width = np.column_stack([0.0 * turn, turn]), np.column_stack([turn, farthest - turn])
        s = (begin[:, :, None] + width[:, :, None] * _NODES).reshape(turn.size, -1)
        limit = ((top - bottom)[:, None] / ((1.0 - s) * (1.0 + s))).ravel()
        values = np.zeros((len(rows), s.size))
        stiffness_row = rows.index(STIFFNESS) if STIFFNESS in rows else -1
        for line in self.lines:
            for number, weights in zip(line.numbers.tolist(), self._weights_above(line, limit).T, strict=True):
                node = self.nodes[number]
                y = (top - node.heights.origin)[:, None] - (1.0 - s) * (1.0 + s) * node.contact.depth[0]
                scales = scales_of(node.contact, rows) * node.contact.depth[0]
                _add_values(node.curve, node.heights, (s.ravel(), y.ravel(), weights), scales, stiffness_row, values)
        values = values.reshape(len(rows), *width.shape, _ORDER) * width[:, :, None]
        error = np.abs(np.einsum("spm,cm->cps", values[0], _LAST)).max(axis=0).sum(axis=0)
        return np.asarray(np.einsum("rspm,m->rs", values, _WEIGHTS)), error

    def dissipated(self) -> Floats:
        """Return the energy [J] that an asperity has lost in jumps up to each step."""
        memory, separation = self.problem.path.memory, self.problem.path.separation
        bottom, top = memory.bottom[self.steps], memory.top[self.steps]
        off = np.zeros((2, separation.size))  # as if all made contact or lost it
        for line in self.lines:
            above = self._weights_above(line, top - bottom).T
            for number, weights in zip(line.numbers.tolist(), above, strict=True):
                node = self.nodes[number]
                contact, heights = node.contact, node.heights
                low, high = bottom - heights.origin, top - heights.origin - contact.depth[0]
                lost = (node.fraction - weights) * heights.between(low, high)
                lost -= node.fraction * heights.between(low, np.maximum(low, high))
                energies = contact.force * contact.depth[0] * jump_energies(contact, _MADE_AND_LOST)
                off[:, self.steps] += energies[:, None] * lost
        made, lost = np.diff(off, axis=1, prepend=0.0)
        rises = np.diff(separation, prepend=math.inf) > 0.0
        return np.asarray(dissipated_of(self.nodes, separation.size) + np.cumsum(np.where(rises, lost, -made)))

    def _weights_above(self, line: Line, limit: Floats) -> Floats:
        """Return the weights of the nodes of a line for integrals over depths above each limit [m]: [limit, score]."""
        rule, numbers = line
        depths = np.array([self.nodes[number].contact.depth[0] for number in numbers.tolist()])
        middle = self.nodes[numbers[numbers.size // 2]].fraction / rule.weights[numbers.size // 2]
        below = rule.weights_below(crossings(rule, np.log(depths), np.log(limit)))
        return np.asarray(middle * (rule.weights - below if depths[0] < depths[-1] else below))


def sums_of(
    problem: MeanProblem,
    partial: PartialRule | None,
    nodes: list[QuadratureNode],
    steps: list[int],
    *,
    dissipating: bool,
) -> tuple[Floats, int]:
    """Return the totals of one asperity [row, step] at some steps, and how often tables were multiplied.

    ``partial`` has the weights of parts of the nodes where steps need them.
    """
    if partial is None:
        total, products = totals_of(nodes, problem.path.separation, problem.rows, steps)
    else:
        total, products = partial._replace(problem=problem).totals(steps)
    if dissipating:
        count = problem.path.separation.size
        total[DISSIPATED] = dissipated_of(nodes, count) if partial is None else partial.dissipated()
    return total, products


_MADE_AND_LOST = Intervals.of([(0, 0, 1, 0.0, 0.0), (0, 1, 0, 0.0, 0.0)])


def _range(nodes: list[QuadratureNode]) -> tuple[float, float, float]:
    """Return the depths [m] below and above which only a negligible fraction detaches, and the median between them."""
    depths = np.array([node.contact.depth[0] for node in nodes])
    order = np.argsort(depths)
    below = np.cumsum(np.array([node.fraction for node in nodes])[order])
    at = np.searchsorted(below, [_NEGLIGIBLE, 0.5, 1.0 - _NEGLIGIBLE]).clip(max=order.size - 1)
    low, middle, high = depths[order[at]].tolist()
    return low, middle, high


def _is_monotone(values: Floats) -> bool:
    rises = np.diff(values)
    return bool((rises > 0.0).all() or (rises < 0.0).all())


def _are_smooth(heights: HeightTable) -> bool:
    """Return whether heights fade out towards the lowest and the highest, and their density has no kink between."""
    if heights.all_equal:
        return False
    low, high = heights.low[0], heights.high[-1]
    near = _NEAR_END * (high - low)
    if heights.between(np.array([low, high - near]), np.array([low + near, high])).max() > _NO_HEIGHTS:
        return False
    n = np.arange(ORDER)
    terms = 2.0 / (heights.high - heights.low)[:, None] * heights.coefficients[:, 0] * n * n  # T_n' is n^2 at the end
    end, begin = terms.sum(axis=1), (terms * np.where(n % 2 == 1, 1.0, -1.0)).sum(axis=1)
    return bool(np.abs(begin[1:] - end[:-1]).max(initial=0.0) <= _KINK * np.abs(end).max())


@njit
def _add_values(
    curve: Curve,
    heights: HeightTable,
    points: tuple[Floats, Floats, Floats],
    scales: Floats,
    stiffness_row: int,
    values: Floats,
) -> None:
    """Add to values[row, point] the quantities of a contact times the density of heights, over s.

    Points are s, y [m] as differences to the origin of ``heights``, and weights. Row ``stiffness_row`` (-1 for none) of
    the curve is times 2 s.
    """
    s, y, weights = points
    z_low, z_high, densities = heights.low, heights.high, heights.coefficients
    table = curve.table
    s_low, s_high, coefficients = table.low, table.high[: curve.first[1]], table.coefficients
    for i in range(s.size):
        if weights[i] == 0.0 or not z_low[0] < y[i] < z_high[-1]:
            continue
        j, k = find_piece(z_high, y[i]), min(find_piece(s_high, s[i]), s_high.size - 1)
        density = series_at(densities[j, 0], ((y[i] - z_low[j]) - (z_high[j] - y[i])) / (z_high[j] - z_low[j]))
        u = (2.0 * s[i] - s_low[k] - s_high[k]) / (s_high[k] - s_low[k])
        for row in range(scales.size):
            measure = 1.0 if row == stiffness_row else 2.0 * s[i]
            value = series_at(coefficients[k, row], u)
            values[row, i] += weights[i] * scales[row] * measure * density * value

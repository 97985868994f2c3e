"""A rule over the normal score of one shape parameter on panels, where Gauss's rule for smooth functions fails.

A panel is halved until its halves agree with it. Each keeps its integrals, so that none is computed twice.
"""

import math
from collections.abc import Callable
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from roughmdr.ensemble.nodes import Rule, fraction_above, mean_over_edge
from roughmdr.errors import RoughmdrError
from roughmdr.expected.node import QuadratureNode
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.gauss import gauss

# Normal scores at which panels end, and beyond which parameters may be left out.
_ENDS = (3.0, 4.5, 6.0, 8.5, 12.0, 17.0, 24.0, 37.0)
_MIN_END = 8.5  # a nearer one only where no contact is representable there
_ORDER = 10
_MAX_NODES = 2_000
RTOL_PANEL = 1e-12
"""Difference of panels from their halves, over the largest values, below which they are right."""
_NEGLIGIBLE = 1e-13  # contribution, over the largest values, that may be left out

Curves = Callable[[list[QuadratureNode]], Floats]
"""Nodes -> their sums, with their fractions of all asperities: [curve, step]."""
SetUp = Callable[[Rule], list[QuadratureNode]]


class _Panel(NamedTuple):
    low: float
    high: float
    nodes: list[QuadratureNode]
    sums: Floats


def halve_panels(set_up: SetUp, curves: Curves, rtol: float) -> tuple[Rule, list[QuadratureNode], Floats]:
    """Return the rule on panels, its nodes, and for each curve the error bound over its largest value.

    Panels are halved until they change by less than ``rtol`` times the largest values, or until there are too many.
    RoughmdrError where not even the bulk of the contacts is representable.
    """
    (lowest, left_out_below), (highest, left_out_above) = (_find_end(side, set_up, curves) for side in (-1.0, 1.0))
    edges = sorted({0.0, *(-end for end in _ENDS if end <= lowest), *(end for end in _ENDS if end <= highest)})
    waiting = _panels(list(pairwise(edges)), set_up, curves)
    accepted: list[_Panel] = []
    error = left_out_below + left_out_above
    node_count = _ORDER * len(waiting)
    while waiting:
        largest = np.abs(sum(panel.sums for panel in [*accepted, *waiting])).max(axis=1, keepdims=True)
        ends = [(panel.low, 0.5 * (panel.low + panel.high), panel.high) for panel in waiting]
        halves = _panels([pair for three in ends for pair in pairwise(three)], set_up, curves)
        node_count += _ORDER * len(halves)
        still_waiting: list[_Panel] = []
        for number, panel in enumerate(waiting):
            pair = halves[2 * number : 2 * number + 2]
            change = np.abs(pair[0].sums + pair[1].sums - panel.sums)
            if (change <= rtol * largest).all() or node_count >= _MAX_NODES:
                accepted += pair
                error = error + change
            else:
                still_waiting += pair
        waiting = still_waiting
    accepted.sort(key=lambda panel: panel.low)
    largest = np.abs(sum(panel.sums for panel in accepted)).max(axis=1)
    nodes = [node for panel in accepted for node in panel.nodes]
    rule = _rule([(panel.low, panel.high) for panel in accepted])
    return rule, nodes, error.max(axis=1) / np.where(largest > 0.0, largest, 1.0)


def _find_end(side: float, set_up: SetUp, curves: Curves) -> tuple[float, Floats]:
    """Return the magnitude of the last score on one side, and about the sums [curve, step] beyond it.

    It is where what lies beyond is negligible, or where no contact is representable any more.
    """

    def at(score: float) -> Floats:
        return curves(set_up(Rule(np.array([score]), np.ones(1))))

    fraction, values = fraction_above(0.0), at(0.0)
    bulk = np.abs(values).max(axis=1, keepdims=True)
    score, left_out = 0.0, np.full_like(values, math.inf)
    for end in _ENDS:
        try:
            values_before, values = values, at(side * end)
        except (RoughmdrError, ArithmeticError):
            break
        score, fraction_before, fraction = end, fraction, fraction_above(end)
        index = _tail_index(np.abs(values), np.abs(values_before), fraction_before / fraction)
        left_out = fraction * np.abs(values) * mean_over_edge(index)
        bulk = np.maximum(bulk, fraction * np.abs(values).max(axis=1, keepdims=True))
        if score >= _MIN_END and (left_out <= _NEGLIGIBLE * bulk).all():
            break
    return score, left_out


def _tail_index(values: Floats, before: Floats, ratio: float) -> Floats:
    """Return the power, at least 0, of ``ratio`` by which values have grown from those before."""
    index = np.zeros_like(values)
    both = (values > before) & (before > 0.0)
    index[both] = np.log(values[both] / before[both]) / math.log(ratio)
    return index


def _panels(ends: list[tuple[float, float]], set_up: SetUp, curves: Curves) -> list[_Panel]:
    parts = [set_up(_rule([pair])) for pair in ends]
    return [_Panel(low, high, part, curves(part)) for (low, high), part in zip(ends, parts, strict=True)]


def _rule(ends: list[tuple[float, float]]) -> Rule:
    """Return Gauss's rule on each of some panels, with the normal density."""
    nodes, weights = gauss(_ORDER)
    low, high = np.array(ends).T[..., None]
    scores = (0.5 * (low + high) + 0.5 * (high - low) * nodes).ravel()
    fractions = (0.5 * (high - low) * weights).ravel() * np.exp(-0.5 * scores**2) / math.sqrt(2.0 * math.pi)
    return Rule(scores, fractions)

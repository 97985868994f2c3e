"""Rules over the normal score of one shape parameter where Gauss's rule for smooth functions fails: panels and splits.

A panel is halved until its halves agree with it. Each keeps its integrals, so that none is computed twice.

At steps of unloading the lowest summits may have detached for some shape parameters but not for others. The summits in
contact are those above max(bottom, top - depth). Over the shape parameters that has a kink where depth = top - bottom,
and where top - depth is an end of all heights: Gauss's rule is split there.
"""

import math
from collections.abc import Callable
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from roughmdr.aggregate import LoadingPath
from roughmdr.aggregate.totals import DISSIPATED, ERROR, FORCE
from roughmdr.ensemble import Source
from roughmdr.ensemble.nodes import PARAMETER_END, Rule, fraction_above, mean_over_edge
from roughmdr.errors import RoughmdrError
from roughmdr.expected.node import MeanProblem, QuadratureNode, contacts_of, dissipated_of, set_up, totals_of
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.gauss import gauss

# Normal scores at which panels end, and beyond which parameters may be left out.
_ENDS = (3.0, 4.5, 6.0, 8.5, 12.0, 17.0, 24.0, 37.0)
_MIN_END = 8.5  # a nearer one only where no contact is representable there
_ORDER = 10  # scores of a panel
_MAX_NODES = 2_000
RTOL_PANEL = 1e-12
"""Difference of panels from their halves, over the largest values, below which they are right."""
_NEGLIGIBLE = 1e-13  # contribution, over the largest values, that may be left out
Curves = Callable[[list[QuadratureNode]], Floats]
"""Nodes -> their sums, with their fractions of all asperities: [curve, step]."""
_MAX_STEPS = 32  # more of them take longer than they are worth
_MAX_SPREAD = 100.0  # largest parameter over the median: 1e-17 of all are left out, and forces grow as its square
_SCAN_ORDER = 40
_SPLIT_ORDERS = (40, 56)  # on each side of a cut; the second is used, and its difference to the first is its error


class _Panel(NamedTuple):
    low: float
    high: float
    nodes: list[QuadratureNode]
    sums: Floats


def halve_panels(problem: MeanProblem, curves: Curves, rtol: float) -> tuple[Rule, list[QuadratureNode], Floats]:
    """Return the rule on panels, its nodes, and for each curve the error bound over its largest value.

    Panels are halved until they change by less than ``rtol`` times the largest values, or until there are too many.
    RoughmdrError where not even the bulk of the contacts is representable.
    """
    (lowest, left_out_below), (highest, left_out_above) = (_find_end(side, problem, curves) for side in (-1.0, 1.0))
    edges = sorted({0.0, *(-end for end in _ENDS if end <= lowest), *(end for end in _ENDS if end <= highest)})
    waiting = _panels(list(pairwise(edges)), problem, curves)
    accepted: list[_Panel] = []
    error = left_out_below + left_out_above
    node_count = _ORDER * len(waiting)
    while waiting:
        largest = np.abs(sum(panel.sums for panel in [*accepted, *waiting])).max(axis=1, keepdims=True)
        ends = [(panel.low, 0.5 * (panel.low + panel.high), panel.high) for panel in waiting]
        halves = _panels([pair for three in ends for pair in pairwise(three)], problem, curves)
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


def _find_end(side: float, problem: MeanProblem, curves: Curves) -> tuple[float, Floats]:
    """Return the magnitude of the last score on one side, and about the sums [curve, step] beyond it.

    It is where what lies beyond is negligible, or where no contact is representable any more.
    """

    def at(score: float) -> Floats:
        return curves(set_up(problem, Rule(np.array([score]), np.ones(1))))

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


def _panels(ends: list[tuple[float, float]], problem: MeanProblem, curves: Curves) -> list[_Panel]:
    parts = [set_up(problem, _rule([pair])) for pair in ends]
    return [_Panel(low, high, part, curves(part)) for (low, high), part in zip(ends, parts, strict=True)]


def _rule(ends: list[tuple[float, float]]) -> Rule:
    """Return Gauss's rule on each of some panels, with the normal density."""
    nodes, weights = gauss(_ORDER)
    low, high = np.array(ends).T[..., None]
    scores = (0.5 * (low + high) + 0.5 * (high - low) * nodes).ravel()
    fractions = (0.5 * (high - low) * weights).ravel() * np.exp(-0.5 * scores**2) / math.sqrt(2.0 * math.pi)
    return Rule(scores, fractions)


class KinkSplit(NamedTuple):
    """Scores at which the rule over the one parameter that is drawn has to be split."""

    problem: MeanProblem
    cuts: dict[int, list[float]]
    """The scores, for each step that needs it."""

    @classmethod
    def of(cls, problem: MeanProblem) -> "KinkSplit | None":
        """Return None without hysteresis, where not exactly one parameter is drawn, or if too many steps have kinks.

        Nor is the rule split where it would leave out parameters that matter, or that no contact can have.
        """
        source = problem.source
        if not problem.hysteretic or problem.kernels.branched or not source.one_parameter or _is_wide(source):
            return None
        scan = Rule.between([], _SCAN_ORDER)
        try:
            depths = _depths(problem, scan.scores)
        except RoughmdrError:
            return None
        heights = dict.fromkeys(source.nodes(scan).heights)
        ends = [own.origin + own.edges[end] for own in heights for end in (0, -1)] if len(heights) == 1 else []
        kinks = _kinks(problem.path, ends, float(depths.min()), float(depths.max()))
        if len(kinks) > _MAX_STEPS:
            return None
        cuts = {
            step: [score for depth in found for score in _scores(problem, scan.scores, depths, depth)]
            for step, found in kinks.items()
        }
        return cls(problem, cuts)

    def total(self, step: int, *, dissipating: bool) -> Floats:
        """Return the totals of one asperity at a step: [row]."""
        problem = self.problem
        totals = []
        for order in _SPLIT_ORDERS:
            nodes = set_up(problem, Rule.between(self.cuts[step], order))
            total = totals_of(nodes, problem.path.separation, problem.rows, [step])[0][:, step]
            if dissipating:
                total[DISSIPATED] = dissipated_of(nodes, problem.path.separation.size)[step]
            totals.append(total)
        coarse, fine = totals
        fine[ERROR] += abs(fine[FORCE] - coarse[FORCE])
        return fine


def _is_wide(source: Source) -> bool:
    """Return whether parameters beyond the scores of a split rule may matter."""
    for parameter in source.drawn_parameters:
        low, middle, high = parameter(np.array([-PARAMETER_END, 0.0, PARAMETER_END]))
        if not max(high / middle, middle / low) < _MAX_SPREAD:
            return True
    return False


def _depths(problem: MeanProblem, scores: Floats) -> Floats:
    """Return how far below first touch [m] the contacts at some scores detach."""
    nodes = problem.source.nodes(Rule(scores, np.ones_like(scores)))
    return np.array([contact.depth[0] for contact in contacts_of(problem, nodes)])


def _kinks(path: LoadingPath, ends: list[float], smallest: float, largest: float) -> dict[int, list[float]]:
    """Return the depths between ``smallest`` and ``largest`` at which there is a kink, for each step that has one."""
    first, bottom, top = path.memory
    kinks = {}
    for step in range(path.separation.size):
        pairs = slice(first[step], first[step + 1])
        depths = np.unique(top[pairs, None] - np.concatenate([bottom[pairs], ends]))
        if (inside := depths[(depths > smallest) & (depths < largest)]).size:
            kinks[step] = inside.tolist()
    return kinks


def _scores(problem: MeanProblem, scores: Floats, depths: Floats, kink: float) -> list[float]:
    """Return the scores at which the depth passes ``kink``, one in each interval of the scan where it does."""
    from scipy.optimize import brentq

    def deviation(score: float) -> float:
        return float(_depths(problem, np.array([score]))[0] / kink - 1.0)

    above = depths > kink
    crossings = np.flatnonzero(above[1:] != above[:-1])
    return [float(brentq(deviation, scores[i], scores[i + 1])) for i in crossings]

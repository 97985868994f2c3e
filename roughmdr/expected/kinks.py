"""Steps of unloading at which, for some shape parameters but not for others, the lowest summits have detached.

The summits in contact are those above max(bottom, top - depth). Over the shape parameters that has a kink where
depth = top - bottom, and where top - depth is an end of all heights: Gauss's rule must be split there.
"""

from typing import NamedTuple

import numpy as np

from roughmdr.aggregate import LoadingPath
from roughmdr.aggregate.totals import DISSIPATED, ERROR, FORCE
from roughmdr.ensemble import Source
from roughmdr.ensemble.nodes import PARAMETER_END, Rule
from roughmdr.errors import RoughmdrError
from roughmdr.expected.node import MeanProblem, contacts_of, dissipated_of, set_up, totals_of
from roughmdr.numerics.arguments import Floats

_MAX_STEPS = 32  # more of them take longer than they are worth
_MAX_SPREAD = 100.0  # largest parameter over the median: 1e-17 of all are left out, and forces grow as its square
_SCAN_ORDER = 40
_ORDERS = (40, 56)  # on each side of a cut; the second is used, and its difference to the first is its error


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
        for order in _ORDERS:
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

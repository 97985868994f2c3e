"""Steps at which some asperities have let go of their lowest summits and others not yet.

On the way back contacts hold on to z = max(bottom, top - depth): over the shape parameters that has a kink where
depth = top - bottom, and Gauss's rule must be parted there. So it must where top - depth is the end of all heights.
"""

from typing import NamedTuple

import numpy as np

from roughmdr.aggregate import LoadingPath
from roughmdr.aggregate.totals import DISSIPATED, ERROR, FORCE
from roughmdr.ensemble import Source
from roughmdr.ensemble.nodes import PARAMETER_END, Rule
from roughmdr.errors import RoughmdrError
from roughmdr.expected.node import Problem, contacts_of, dissipated_of, set_up, totals_of
from roughmdr.numerics.arguments import Floats

_MOST = 32  # steps; where more would be parted it takes longer than it is worth
_FAR = 100.0  # times the median: beyond the last score stands 1e-17 of all, and nothing grows faster than its square
_SCAN = 40  # scores at which the depth is looked at
_ORDERS = (40, 56)  # on each side of a cut; the second tells how right the first is


class Parted(NamedTuple):
    """Where the rule over the one parameter that is drawn has to be parted."""

    asked: Problem
    cuts: dict[int, list[float]]
    """The scores, for each step that needs it."""

    @classmethod
    def of(cls, asked: Problem) -> "Parted | None":
        """None where there is nothing to part, or no single parameter to part it by, or too many steps need it.

        Nor is the rule parted where it would leave out parameters that are felt, or that no contact can have.
        """
        if not asked.hysteretic or asked.law.branched or not asked.source.one_parameter or _far(asked.source):
            return None
        scan = Rule.between([], _SCAN)
        try:
            depths = _depths(asked, scan.scores)
        except RoughmdrError:
            return None
        heights = dict.fromkeys(asked.source.nodes(scan).heights)
        ends = [end for own in heights for end in (own.low, own.high)] if len(heights) == 1 else []
        kinks = _kinks(asked.path, ends, float(depths.min()), float(depths.max()))
        if len(kinks) > _MOST:
            return None
        cuts = {
            step: [score for depth in found for score in _scores(asked, scan.scores, depths, depth)]
            for step, found in kinks.items()
        }
        return cls(asked, cuts)

    def total(self, step: int, *, dissipating: bool) -> Floats:
        """[row] of ``totals`` at a step, for an asperity."""
        separation = self.asked.path.separation
        found = []
        for order in _ORDERS:
            nodes = set_up(self.asked, Rule.between(self.cuts[step], order))
            total = totals_of(nodes, separation, self.asked.rows, [step])[0][:, step]
            if dissipating:
                total[DISSIPATED] = dissipated_of(nodes, separation.size)[step]
            found.append(total)
        coarse, fine = found
        fine[ERROR] += abs(fine[FORCE] - coarse[FORCE])
        return fine


def _far(source: Source) -> bool:
    """Whether parameters beyond the scores of a parted rule may be felt."""
    for parameter in source.drawn_parameters:
        low, middle, high = parameter(np.array([-PARAMETER_END, 0.0, PARAMETER_END]))
        if not max(high / middle, middle / low) < _FAR:
            return True
    return False


def _depths(asked: Problem, scores: Floats) -> Floats:
    """How far below first touch [m] the contacts at some scores let go."""
    nodes = asked.source.nodes(Rule(scores, np.ones_like(scores)))
    return np.array([contact.depth[0] for contact in contacts_of(asked, nodes)])


def _kinks(path: LoadingPath, ends: list[float], least: float, most: float) -> dict[int, list[float]]:
    """The depths between ``least`` and ``most`` at which contacts part in what they remember, for each such step."""
    first, bottom, top = path.memory
    found = {}
    for step in range(path.separation.size):
        pairs = slice(first[step], first[step + 1])
        gaps = np.unique(top[pairs, None] - np.concatenate([bottom[pairs], ends]))
        if (kinks := gaps[(gaps > least) & (gaps < most)]).size:
            found[step] = kinks.tolist()
    return found


def _scores(asked: Problem, scores: Floats, depths: Floats, kink: float) -> list[float]:
    """The scores at which the depth passes ``kink``, one in each interval of the scan where it does."""
    from scipy.optimize import brentq

    def off(score: float) -> float:
        return float(_depths(asked, np.array([score]))[0] / kink - 1.0)

    above = depths > kink
    found = np.flatnonzero(above[1:] != above[:-1])
    return [float(brentq(off, scores[i], scores[i + 1])) for i in found]

"""The distribution of asperities as a few of them with weights: shape parameters at nodes, heights by their density."""

import math
from collections.abc import Callable
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from roughmdr.arguments import Floats
from roughmdr.ensemble.distributions import Distribution
from roughmdr.ensemble.population import AsperityLaw, Population

END = 10.0
"""The normal score beyond which heights are left out: their share is 1e-23."""
_LAST = 8.5  # normal score beyond which parameters are left out: their share is 1e-17
_QUARTER = 0.6745  # normal score that a quarter of all heights lie above


class Heights(NamedTuple):
    """The heights of the summits of one node."""

    density: Callable[[Floats], Floats]
    """z [m] -> the density [1/m]."""
    low: float
    """[m]; next to no summit is lower."""
    high: float
    """[m]; next to no summit is higher."""
    scale: float
    """[m]; half of the summits lie so near to each other."""

    @classmethod
    def of(cls, distribution: Distribution) -> "Heights":
        """Heights that have a distribution of their own."""
        low, lower, upper, high = distribution.of_scores(np.array([-END, -_QUARTER, _QUARTER, END]))
        return cls(distribution.density, float(low), float(high), float(upper - lower))

    @classmethod
    def given(cls, distribution: Distribution, score: float, correlation: float) -> "Heights":
        """Those that go with the normal score of another quantity, by a normal copula."""
        spread = math.sqrt((1.0 - correlation) * (1.0 + correlation))
        scores = correlation * score + spread * np.array([-END, -_QUARTER, _QUARTER, END])
        low, lower, upper, high = distribution.of_scores(scores)

        def density(z: Floats) -> Floats:
            own = distribution.scores(z)
            with np.errstate(all="ignore"):
                lean = np.exp(0.5 * own**2 - 0.5 * ((own - correlation * score) / spread) ** 2) / spread
            return np.where(np.isfinite(own), distribution.density(z) * lean, 0.0)

        return cls(density, float(low), float(high), float(upper - lower))


class Rule(NamedTuple):
    """A rule to integrate over a normal score with."""

    scores: Floats
    weights: Floats
    """Their sum is 1."""

    @classmethod
    def smooth(cls, order: int) -> "Rule":
        """Gauss's rule for what is smooth."""
        scores, weights = np.polynomial.hermite_e.hermegauss(order)
        return cls(scores, weights / weights.sum())

    @classmethod
    def between(cls, cuts: list[float], order: int) -> "Rule":
        """Gauss's rule for what is smooth in the root of the distance to ``cuts``: ``order`` scores in each part."""
        ends = np.unique(np.clip([-_LAST, *cuts, _LAST], -_LAST, _LAST))
        nodes, weights = np.polynomial.legendre.leggauss(order)
        y, weights = 0.5 * (1.0 + nodes), 0.5 * weights
        scores, shares = [], []
        for low, high in pairwise(ends):
            begins, ends_there = low > -_LAST, high < _LAST
            if begins and ends_there:
                way, speed = y * y * (3.0 - 2.0 * y), 6.0 * y * (1.0 - y)
            elif begins:
                way, speed = y * y, 2.0 * y
            elif ends_there:
                way, speed = y * (2.0 - y), 2.0 * (1.0 - y)
            else:
                way, speed = y, np.ones_like(y)
            scores.append(low + (high - low) * way)
            shares.append((high - low) * speed * weights)
        at = np.concatenate(scores)
        return cls(at, np.concatenate(shares) * np.exp(-0.5 * at**2) / math.sqrt(2.0 * math.pi))


class Nodes(NamedTuple):
    """Asperities that stand for all."""

    share: Floats
    """Of all asperities: [node]; their sum is 1."""
    parameters: dict[str, Floats]
    """[node]"""
    heights: tuple[Heights, ...]
    """[node]"""


def nodes_of(law: AsperityLaw, rule: Rule) -> Nodes:
    """Nodes at the scores of a rule, for each shape parameter that is not a constant."""
    found = [_of_population(law, population, rule) for population in law.populations]
    names = law.populations[0].parameters
    return Nodes(
        np.concatenate([nodes.share for nodes in found]),
        {name: np.concatenate([nodes.parameters[name] for nodes in found]) for name in names},
        tuple(heights for nodes in found for heights in nodes.heights),
    )


def _of_population(law: AsperityLaw, population: Population, rule: Rule) -> Nodes:
    drawn, order = population.drawn, rule.scores.size
    numbers = np.indices((order,) * len(drawn)).reshape(len(drawn), order ** len(drawn))
    share = population.share * np.prod(rule.weights[numbers], axis=0)
    own = dict(zip(drawn, rule.scores[numbers], strict=True))
    parameters = {
        name: entry.of_scores(own.get(name, np.zeros(share.size))) for name, entry in population.parameters.items()
    }
    if law.correlated in own:
        known = {score: Heights.given(population.height, score, law.score_correlation) for score in rule.scores}
        return Nodes(share, parameters, tuple(known[score] for score in own[law.correlated]))
    return Nodes(share, parameters, (Heights.of(population.height),) * share.size)

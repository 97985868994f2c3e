"""The distribution of asperities as a few of them with weights: shape parameters at nodes, heights by their density."""

import math
from collections.abc import Callable
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from roughmdr.ensemble.random.distributions import Distribution
from roughmdr.ensemble.random.population import Population, Populations
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.gauss import unit_gauss

END = 10.0
"""The normal score beyond which heights are left out where tails are light: their share is 1e-23."""
_NEARER_ENDS = (END, 8.0, 6.5, 5.0)  # of these the first that the inverse of a distribution leads to
_FARTHER_ENDS = (12.0, 14.0, 17.0, 20.0, 24.0, 28.0, 32.0, 37.0)  # where the upper tail is heavy; 37 is the last
_BULK = 3.0  # normal scores between which most heights lie: 99.7 %
LAST = 8.5
"""The normal score beyond which a rule with cuts leaves parameters out: their share is 1e-17."""
_QUARTER = 0.6745  # normal score that a quarter of all heights lie above
_STEEPEST = 3.0  # no force grows faster with the indentation than to this power: exponents above 1/2
_NEGLIGIBLE = 1e-16  # of the force that the bulk bears
_NEXT_TO_LOC = 1e-14  # of the scale
_POINT = 2.0**-48  # of a height, or of the scale of the distribution: no heights lie nearer together than that
_WIDEST = 1e100  # of the scale: farther heights are not integrated


class UpperTail(NamedTuple):
    """The heights that are left out above."""

    share: float
    """Of all heights."""
    xi: float
    """Index of extreme values: heights grow as share^-xi."""

    def over_edge(self, growth: float) -> float:
        """The force of the tail over that of one height at its edge, where a force grows as the height^growth."""
        return self.share * float(mean_over_edge(np.array(growth * self.xi)))


class Heights(NamedTuple):
    """The heights of the summits of one node, as differences y = z - origin: near a pole they keep their digits."""

    density: Callable[[Floats], Floats]
    """y [m] -> the density [1/m]; inf at a pole."""
    fractions: Callable[[Floats], tuple[Floats, Floats]] | None
    """y [m] -> the fractions of all heights below and above; None where the density is smooth and its integral 1."""
    edges: tuple[float, ...]
    """y [m], rising; next to no summit is lower than the first, ``tail`` are those above the last."""
    scale: float
    """[m]; half of the summits lie so near to each other, or nearly all of the upper half within three times that."""
    tail: UpperTail
    origin: float
    """[m]"""

    @property
    def low(self) -> float:
        """[m]; next to no summit is lower."""
        return self.origin + self.edges[0]

    @property
    def high(self) -> float:
        """[m]; next to no summit is higher."""
        return self.origin + self.edges[-1]

    @classmethod
    def of(cls, distribution: Distribution) -> "Heights":
        """Heights that have a distribution of their own."""
        own = distribution.from_loc
        return cls(own.density, own.fractions, *_extent(own.of_scores, own.scale), distribution.loc)

    @classmethod
    def given(cls, distribution: Distribution, score: float, correlation: float) -> "Heights":
        """Those that go with the normal score of another quantity, by a normal copula."""
        own = distribution.from_loc
        middle, spread = correlation * score, math.sqrt((1.0 - correlation) * (1.0 + correlation))

        def of_scores(scores: Floats) -> Floats:
            return own.of_scores(middle + spread * scores)

        def fractions(y: Floats) -> tuple[Floats, Floats]:
            from scipy.special import ndtr

            scores = (own.scores(y) - middle) / spread
            return np.asarray(ndtr(scores)), np.asarray(ndtr(-scores))

        def density(y: Floats) -> Floats:
            scores = own.scores(y)
            with np.errstate(all="ignore"):
                lean = np.exp(0.5 * scores**2 - 0.5 * ((scores - middle) / spread) ** 2) / spread
            return np.where(np.isfinite(scores), own.density(y) * lean, 0.0)

        return cls(density, fractions, *_extent(of_scores, own.scale), distribution.loc)


def _extent(of_scores: Callable[[Floats], Floats], unit: float) -> tuple[tuple[float, ...], float, UpperTail]:
    """Edges and scale of heights, and the tail beyond, from the heights y [m] that have some normal scores.

    ``unit`` is the scale of their distribution [m].
    """
    low_bulk, lower, median, upper, bulk = of_scores(np.array([-_BULK, -_QUARTER, 0.0, _QUARTER, _BULK])).tolist()
    point = _POINT * max(unit, abs(median))  # those that go with an extreme of another quantity may all be one
    # The highest count, where most heights are next to a pole.
    scale = max(upper - lower, (bulk - median) / _BULK, point)
    ends = np.array(_NEARER_ENDS)
    low = next((y for y in of_scores(-ends).tolist() if math.isfinite(y)), low_bulk)
    score, high = next(
        ((t, y) for t, y in zip(_NEARER_ENDS, of_scores(ends).tolist(), strict=True) if math.isfinite(y)), (_BULK, bulk)
    )
    if high - low < point:
        return (low - point, high + point), point, UpperTail(share_above(score), 0.0)
    if 0.0 < low < _NEXT_TO_LOC * scale:  # a pole may stand at loc: no float is as near to it as some heights
        low = 0.0
    edges, before = [low, low_bulk, bulk, high], (_BULK, bulk)
    if low < 0.0 < high:
        edges.append(0.0)  # where families that have a pole within have it
    for farther, y in zip(_FARTHER_ENDS, of_scores(np.array(_FARTHER_ENDS)).tolist(), strict=True):
        if score < END or not _is_felt(score, high / scale) or not high < y < _WIDEST * scale:
            break
        before, (score, high) = (score, high), (farther, y)
        edges.append(y)
    rising = 0.0 < before[1] < high and _is_felt(score, high / scale)
    xi = math.log(high / before[1]) / math.log(share_above(before[0]) / share_above(score)) if rising else 0.0
    return tuple(sorted(set(edges))), scale, UpperTail(share_above(score), xi)


def _is_felt(score: float, reach: float) -> bool:
    """Whether heights above a normal score, which ``reach`` so many times the scale, may add to a mean force."""
    return reach > 0.0 and math.log(share_above(score)) + _STEEPEST * math.log(reach) >= math.log(_NEGLIGIBLE)


def share_above(score: float) -> float:
    """The part of all that stands above a normal score."""
    from scipy.special import ndtr

    return float(ndtr(-score))


def mean_over_edge(index: Floats) -> Floats:
    """The mean over a tail, over the value at its edge, of what grows as share^-index; inf where it has no bound."""
    return np.where(index < 1.0, 1.0 / np.where(index < 1.0, 1.0 - index, 1.0), math.inf)


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
        ends = np.unique(np.clip([-LAST, *cuts, LAST], -LAST, LAST))
        y, weights = unit_gauss(order)
        scores, shares = [], []
        for low, high in pairwise(ends):
            begins, ends_there = low > -LAST, high < LAST
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


def nodes_of(law: Populations, rule: Rule) -> Nodes:
    """Nodes at the scores of a rule, for each shape parameter that is not a constant."""
    found = [_of_population(law, population, rule) for population in law.populations]
    names = law.populations[0].parameters
    return Nodes(
        np.concatenate([nodes.share for nodes in found]),
        {name: np.concatenate([nodes.parameters[name] for nodes in found]) for name in names},
        tuple(heights for nodes in found for heights in nodes.heights),
    )


def _of_population(law: Populations, population: Population, rule: Rule) -> Nodes:
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

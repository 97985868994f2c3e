"""Populations of asperities, one or two mixed: their draws, and quadrature nodes over heights and shape parameters."""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from roughmdr.ensemble.nodes import HEIGHT_END, Heights, Nodes, Rule, UpperTail, fraction_above
from roughmdr.ensemble.random.distribution import Distribution
from roughmdr.ensemble.random.distribution_families import ndtr, ndtri
from roughmdr.ensemble.streams import HEIGHT, POPULATION, SMALLEST_UNIFORM, Streams
from roughmdr.numerics.arguments import Floats

_COMBINATIONS = 729  # combinations of shape parameters between their tails: 3^6, odd numbers of values for up to three
# Normal scores at which edges may lie: on each side the farthest of _LIGHT_TAIL_ENDS with a finite quantile, and above
# it, if the upper tail is heavy, those of _HEAVY_TAIL_ENDS that still bear force.
_LIGHT_TAIL_ENDS = (HEIGHT_END, 8.0, 6.5, 5.0)
_HEAVY_TAIL_ENDS = (12.0, 14.0, 17.0, 20.0, 24.0, 28.0, 32.0, 37.0)
_BULK = 3.0  # normal scores between which most heights lie: 99.7 %
_QUARTILE = 0.6745  # normal score of the upper quartile
_MAX_FORCE_EXPONENT = 3.0  # forces grow as indentation^(1 + 1/n), n > 1/2
_NEGLIGIBLE_FORCE = 1e-16  # force of the heights above a score, over that of the bulk, that is lost in rounding
_NEXT_TO_LOC = 1e-14  # distance of a height from loc, over the scale, below which it counts as loc
_RESOLUTION = 2.0**-48  # smallest width of the heights, over a height or over the scale
_MAX_HEIGHT = 1e100  # largest height over the scale that is integrated


@dataclass(frozen=True)
class Population:
    """Asperities whose heights have one distribution, and each shape parameter another."""

    fraction: float  # of all asperities
    height: Distribution
    parameters: dict[str, Distribution]

    @property
    def random_parameters(self) -> list[str]:
        """The shape parameters that are not constant."""
        return [name for name, entry in self.parameters.items() if entry.constant is None]

    def between_tails(self, chance: float) -> dict[str, Floats]:
        """Return shape parameters [SI] in all combinations, each between its tails of this chance."""
        names = self.random_parameters
        count = round(_COMBINATIONS ** (1.0 / len(names))) if names else 1
        axes = np.meshgrid(*(self.parameters[name].between_tails(chance, count) for name in names))
        values = dict(zip(names, (axis.ravel() for axis in axes), strict=True))
        constant = np.ones(count ** len(names))
        return {name: values.get(name, constant * entry.loc) for name, entry in self.parameters.items()}


@dataclass(frozen=True)
class Populations:
    """One or two populations, in each of which one parameter may be correlated with the height."""

    members: tuple[Population, ...]
    parameter_streams: dict[str, int]  # the stream of random numbers of each parameter
    correlated: str = ""  # the parameter that is correlated with the height; empty for none
    rank_correlation: float = 0.0  # Spearman's coefficient of the two, in each population

    @property
    def score_correlation(self) -> float:
        """Pearson's coefficient of the normal scores, 2 sin(pi rank/6) (K. Pearson, 1907, Drapers' Company Research
        Memoirs, Biometric Series IV): the two are joined by a normal copula.
        """
        return 2.0 * math.sin(math.pi * self.rank_correlation / 6.0)

    @property
    def sigma(self) -> float:
        """Standard deviation of the heights [m]; inf or NaN where there is none."""
        origin = self.members[0].height.mean
        fractions = [each.fraction for each in self.members]
        means = [each.height.mean - origin for each in self.members]
        mean = sum(p * m for p, m in zip(fractions, means, strict=True))
        spreads = [math.hypot(each.height.std, m - mean) for each, m in zip(self.members, means, strict=True)]
        return math.hypot(*(math.sqrt(p) * s for p, s in zip(fractions, spreads, strict=True)))

    @property
    def random_streams(self) -> tuple[int, ...]:
        """The streams that draws depend on: that of the heights, and those of parameters that are not constant."""
        random = {name for each in self.members for name in each.random_parameters}
        streams = (stream for name, stream in self.parameter_streams.items() if name in random)
        return (HEIGHT, *((POPULATION,) if len(self.members) > 1 else ()), *streams)

    def extremes(self, chance: float) -> tuple[float, dict[str, Floats]]:
        """Return the height [m] that an asperity exceeds with this chance, and shape parameters [SI] that cover all but
        its tails of this chance, in all combinations; two populations share the chance.
        """
        highest, parts = -math.inf, list[dict[str, Floats]]()
        for each in self.members:
            own = chance / (len(self.members) * each.fraction) if each.fraction > 0.0 else 1.0
            if own < 1.0:
                highest = max(highest, float(each.height.between_tails(own, 2)[-1]))
                parts.append(each.between_tails(own))
        return highest, {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}

    def draw(self, streams: Streams, count: int) -> tuple[Floats, dict[str, Floats]]:
        """Draw heights [m] and shape parameters [SI] of ``count`` asperities."""
        level, random = streams(HEIGHT, count), self.random_streams
        levels = {
            name: streams(stream, count) if stream in random else level  # constants depend on no level
            for name, stream in self.parameter_streams.items()
        }
        if self.correlated:  # by the copula
            r, independent = self.score_correlation, ndtri(levels[self.correlated])
            joined = ndtr(r * ndtri(level) + math.sqrt((1.0 - r) * (1.0 + r)) * independent)
            levels[self.correlated] = np.clip(joined, SMALLEST_UNIFORM, 1.0 - SMALLEST_UNIFORM)
        first = self.members[0]
        height = first.height.quantile(level)
        parameters = {name: entry.quantile(levels[name]) for name, entry in first.parameters.items()}
        for other in self.members[1:]:
            belongs = streams(POPULATION, count) < other.fraction
            height[belongs] = other.height.quantile(level[belongs])
            for name, entry in other.parameters.items():
                parameters[name][belongs] = entry.quantile(levels[name][belongs])
        return height, parameters


def heights_of(distribution: Distribution) -> Heights:
    """Return heights of this distribution, whatever the shape parameters."""
    if distribution.constant is not None:
        return Heights.all_at(distribution.constant)
    relative = distribution.relative_to_loc
    edges, scale, tail = _edges(relative.from_scores, relative.scale)
    return Heights(relative.density, relative.fractions, edges, scale, tail, distribution.loc)


def heights_given(distribution: Distribution, score: float, correlation: float) -> Heights:
    """Return the heights given a normal score of another quantity, by a normal copula."""
    if distribution.constant is not None:
        return Heights.all_at(distribution.constant)
    relative = distribution.relative_to_loc
    mean, spread = correlation * score, math.sqrt((1.0 - correlation) * (1.0 + correlation))

    def from_scores(scores: Floats) -> Floats:
        return relative.from_scores(mean + spread * scores)

    def fractions(y: Floats) -> tuple[Floats, Floats]:
        scores = (relative.scores(y) - mean) / spread
        return ndtr(scores), ndtr(-scores)

    def density(y: Floats) -> Floats:
        scores = relative.scores(y)
        with np.errstate(all="ignore"):
            ratio = np.exp(0.5 * scores**2 - 0.5 * ((scores - mean) / spread) ** 2) / spread
        return np.where(np.isfinite(scores), relative.density(y) * ratio, 0.0)

    edges, scale, tail = _edges(from_scores, relative.scale)
    return Heights(density, fractions, edges, scale, tail, distribution.loc)


def _edges(from_scores: Callable[[Floats], Floats], unit: float) -> tuple[tuple[float, ...], float, UpperTail]:
    """Return edges [m], scale [m] and upper tail of heights y [m] at normal scores; ``unit`` is that of y [m]."""
    low_bulk, lower, median, upper, bulk = from_scores(np.array([-_BULK, -_QUARTILE, 0.0, _QUARTILE, _BULK])).tolist()
    narrowest = _RESOLUTION * max(unit, abs(median))  # heights that go with an extreme parameter may all be equal
    # Where most heights lie next to a pole, the upper ones set the scale.
    scale = max(upper - lower, (bulk - median) / _BULK, narrowest)
    ends = np.array(_LIGHT_TAIL_ENDS)
    low = next((y for y in from_scores(-ends).tolist() if math.isfinite(y)), low_bulk)
    at_ends = zip(_LIGHT_TAIL_ENDS, from_scores(ends).tolist(), strict=True)
    score, high = next(((t, y) for t, y in at_ends if math.isfinite(y)), (_BULK, bulk))
    if high - low < narrowest:
        return (low - narrowest, high + narrowest), narrowest, UpperTail(fraction_above(score), 0.0)
    if 0.0 < low < _NEXT_TO_LOC * scale:  # a pole may be at loc, and no float as near to it as some heights
        low = 0.0
    edges, before = [low, low_bulk, bulk, high], (_BULK, bulk)
    if low < 0.0 < high:
        edges.append(0.0)  # where families with an inner pole have it
    for farther, y in zip(_HEAVY_TAIL_ENDS, from_scores(np.array(_HEAVY_TAIL_ENDS)).tolist(), strict=True):
        if score < HEIGHT_END or not _bears_force(score, high / scale) or not high < y < _MAX_HEIGHT * scale:
            break
        before, (score, high) = (score, high), (farther, y)
        edges.append(y)
    heavy = 0.0 < before[1] < high and _bears_force(score, high / scale)
    xi = math.log(high / before[1]) / math.log(fraction_above(before[0]) / fraction_above(score)) if heavy else 0.0
    return tuple(sorted(set(edges))), scale, UpperTail(fraction_above(score), xi)


def _bears_force(score: float, ratio: float) -> bool:
    """Return whether heights above a normal score may add to a mean force; there they are ``ratio`` times the scale."""
    if ratio <= 0.0:
        return False
    return math.log(fraction_above(score)) + _MAX_FORCE_EXPONENT * math.log(ratio) >= math.log(_NEGLIGIBLE_FORCE)


def nodes_of(populations: Populations, *rules: Rule) -> Nodes:
    """Return nodes at the scores of one rule for all random shape parameters of all populations, or of one for each."""
    axes = sum(len(population.random_parameters) for population in populations.members)
    left, parts = list(rules if len(rules) > 1 else rules * axes), []
    for population in populations.members:
        count = len(population.random_parameters)
        parts.append(_nodes_of_one(populations, population, left[:count]))
        left = left[count:]
    names = populations.members[0].parameters
    return Nodes(
        np.concatenate([part.weights for part in parts]),
        {name: np.concatenate([part.parameters[name] for part in parts]) for name in names},
        tuple(heights for part in parts for heights in part.heights),
    )


def _nodes_of_one(populations: Populations, population: Population, rules: list[Rule]) -> Nodes:
    names, shape = population.random_parameters, tuple(rule.scores.size for rule in rules)
    indices = np.indices(shape).reshape(len(names), -1) if names else np.zeros((0, 1), dtype=int)
    weights, scores = np.full(indices.shape[1], population.fraction), {}
    for name, rule, index in zip(names, rules, indices, strict=True):
        weights, scores[name] = weights * rule.weights[index], rule.scores[index]
    parameters = {
        name: entry.from_scores(scores.get(name, np.zeros(weights.size)))
        for name, entry in population.parameters.items()
    }
    if populations.correlated in scores:
        correlated = scores[populations.correlated].tolist()
        at_score = {t: heights_given(population.height, t, populations.score_correlation) for t in set(correlated)}
        return Nodes(weights, parameters, tuple(at_score[t] for t in correlated))
    return Nodes(weights, parameters, (heights_of(population.height),) * weights.size)

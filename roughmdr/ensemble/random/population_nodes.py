"""Quadrature nodes of populations: random shape parameters at the scores of a rule, and the heights with them."""

import math
from collections.abc import Callable

import numpy as np

from roughmdr.ensemble.nodes import HEIGHT_END, Heights, Nodes, Rule, UpperTail, fraction_above
from roughmdr.ensemble.random.distribution import Distribution
from roughmdr.ensemble.random.distribution_families import ndtr
from roughmdr.ensemble.random.population import Population, Populations
from roughmdr.numerics.arguments import Floats

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

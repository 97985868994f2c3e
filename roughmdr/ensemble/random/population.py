"""Populations of asperities with common distributions of height and shape parameters: one, or two mixed."""

import math
from dataclasses import dataclass

import numpy as np

from roughmdr.ensemble.random.distribution import Distribution
from roughmdr.ensemble.random.distribution_families import ndtr, ndtri
from roughmdr.ensemble.streams import HEIGHT, POPULATION, SMALLEST_UNIFORM, Streams
from roughmdr.numerics.arguments import Floats

_COMBINATIONS = 729  # combinations of shape parameters between their tails: 3^6, odd numbers of values for up to three


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

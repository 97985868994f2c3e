"""The law that heights and shape parameters are drawn from: one population of asperities, or two mixed."""

import math
from dataclasses import dataclass

import numpy as np

from roughmdr.ensemble.random.distributions import Distribution
from roughmdr.ensemble.streams import HEIGHT, POPULATION, SMALLEST_UNIFORM, Streams
from roughmdr.numerics.arguments import Floats


@dataclass(frozen=True)
class Population:
    """Asperities that have their height and each shape parameter from the same distributions."""

    share: float
    """Of all asperities."""
    height: Distribution
    parameters: dict[str, Distribution]

    @property
    def drawn(self) -> list[str]:
        """The shape parameters that are not always the same."""
        return [name for name, entry in self.parameters.items() if entry.constant is None]


@dataclass(frozen=True)
class Populations:
    """One or two populations, in which one parameter may go with the height."""

    populations: tuple[Population, ...]
    streams: dict[str, int]
    """The stream of random numbers of each parameter."""
    correlated: str = ""
    """The parameter that goes with the height; empty for none."""
    rank_correlation: float = 0.0
    """Spearman's coefficient between the two, in each population."""

    @property
    def score_correlation(self) -> float:
        """Pearson's coefficient of the normal scores, 2 sin(pi rank/6) (K. Pearson, 1907, Drapers' Company Research
        Memoirs, Biometric Series IV): the two are joined by a normal copula.
        """
        return 2.0 * math.sin(math.pi * self.rank_correlation / 6.0)

    @property
    def sigma(self) -> float:
        """Standard deviation of the heights [m]; inf or NaN where there is none."""
        if len(self.populations) == 1:
            return self.populations[0].height.std
        middle = self.populations[0].height.mean
        means = [each.height.mean - middle for each in self.populations]
        mean = sum(each.share * own for each, own in zip(self.populations, means, strict=True))
        spreads = [math.hypot(each.height.std, own - mean) for each, own in zip(self.populations, means, strict=True)]
        return math.hypot(*(math.sqrt(each.share) * own for each, own in zip(self.populations, spreads, strict=True)))

    @property
    def varied(self) -> tuple[int, ...]:
        """The streams that are drawn from, but for those whose quantity is always the same."""
        names = [
            name for name in self.streams if any(each.parameters[name].constant is None for each in self.populations)
        ]
        mixed = (POPULATION,) if len(self.populations) > 1 else ()
        return (HEIGHT, *mixed, *(self.streams[name] for name in names))

    def draw(self, draws: Streams, count: int) -> tuple[Floats, dict[str, Floats]]:
        """Heights [m] and shape parameters [SI] of ``count`` asperities."""
        level = draws(HEIGHT, count)
        levels = {name: draws(stream, count) for name, stream in self.streams.items()}
        if self.correlated:
            levels[self.correlated] = self._joined(level, levels[self.correlated])
        first = self.populations[0]
        height = first.height.quantile(level)
        parameters = {name: entry.quantile(levels[name]) for name, entry in first.parameters.items()}
        for other in self.populations[1:]:
            belongs = draws(POPULATION, count) < other.share
            height[belongs] = other.height.quantile(level[belongs])
            for name, entry in other.parameters.items():
                parameters[name][belongs] = entry.quantile(levels[name][belongs])
        return height, parameters

    def _joined(self, level: Floats, own: Floats) -> Floats:
        """Levels that go with those of the heights as the copula says."""
        from scipy.special import ndtr, ndtri

        r = self.score_correlation
        joined = ndtr(r * ndtri(level) + math.sqrt((1.0 - r) * (1.0 + r)) * ndtri(own))
        return np.clip(joined, SMALLEST_UNIFORM, 1.0 - SMALLEST_UNIFORM)

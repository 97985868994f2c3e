"""source = "random": heights and shape parameters drawn from distributions."""

from collections.abc import Callable, Iterator
from functools import cached_property
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import BeforeValidator, model_validator

from roughmdr.ensemble.ensemble import Ensemble
from roughmdr.ensemble.nodes import Nodes, Rule, nodes_of
from roughmdr.ensemble.patch import PatchSource
from roughmdr.ensemble.random.count import poisson
from roughmdr.ensemble.random.distributions import Distribution
from roughmdr.ensemble.random.population import Population, Populations
from roughmdr.ensemble.random.reader import DistributionReader
from roughmdr.ensemble.streams import HEIGHT, PARAMETER, independent, spread
from roughmdr.errors import RoughmdrError
from roughmdr.numerics.arguments import Floats
from roughmdr.schema.quantities import EntryError, Quantity, Section, WholeNumber
from roughmdr.schema.units import DIMENSIONLESS
from roughmdr.shapes import SHAPES

_MOST = 1_000_000_000
_Height = Annotated[Distribution, BeforeValidator(DistributionReader("m", mean=0.0))]


class Second(Section):
    """[asperities.second]: a second population, this share of all asperities; what it leaves out is as in the first."""

    share: Annotated[float, BeforeValidator(Quantity(DIMENSIONLESS, above=0.0, at_most=1.0))]
    height: _Height | None = None


class Correlation(Section):
    """[asperities.correlation]: Spearman's rank correlation between the height and one shape parameter."""


class RandomAsperities(PatchSource):
    """[asperities] with source = "random": ``count`` asperities, or a ``density``, on a square of side ``patch``."""

    source: Literal["random"]
    count: Annotated[int, BeforeValidator(WholeNumber(1, _MOST))] | None = None
    density: Annotated[float, BeforeValidator(Quantity("m-2", above=0.0))] | None = None
    height: _Height
    second: Second | None = None
    correlation: Correlation | None = None

    @model_validator(mode="after")
    def _parameters_describe_the_shape(self) -> "RandomAsperities":
        if self.fixed is None:
            SHAPES[self.shape].parameter_set(set(self.distributions))
        if self.count is None and self.density is None:
            raise RoughmdrError("needs count, or a density from which the number in each realisation is drawn")
        if self.count is not None and self.density is not None:
            raise EntryError("density", self.density, "does not go with count; leave one of them out")
        if self.density is not None and not self.expected_count <= _MOST:
            raise EntryError(
                "density", self.density, f"puts {self.expected_count:.3g} asperities on the patch; at most {_MOST:g}"
            )
        return self

    @model_validator(mode="after")
    def _populations_fit(self) -> "RandomAsperities":
        for name in _given(self.second, self.shape):
            if name not in self.distributions:
                raise EntryError(f"second.{name}", None, f"is not given for the first population: {self._spelled}")
        for population in self.law.populations:
            _check_order(self.shape, population)
        name = self.law.correlated
        if self.correlation is not None and not name:
            raise EntryError("correlation", None, f"names no parameter of the {self.shape}; it takes {self._spelled}")
        if len(_given(self.correlation, self.shape)) > 1:
            raise EntryError("correlation", None, "takes one parameter: it goes with the height")
        for other in (name, "height") if name else ():
            if all(self._entry(each, other).constant is not None for each in self.law.populations):
                raise EntryError(f"correlation.{name}", None, f"needs a {other} that is not always the same")
        return self

    @property
    def _spelled(self) -> str:
        return ", ".join(self.distributions) or "none"

    @staticmethod
    def _entry(population: Population, name: str) -> Distribution:
        return population.height if name == "height" else population.parameters[name]

    @cached_property
    def law(self) -> Populations:
        """What heights and parameters are drawn from."""
        first = Population(1.0, self.height, self.distributions)
        populations = [first]
        if self.second is not None:
            share = self.second.share
            parameters = {**self.distributions, **_given(self.second, self.shape)}
            second = Population(share, self.second.height or self.height, parameters)
            populations = [Population(1.0 - share, self.height, self.distributions), second]
        order = list(SHAPES[self.shape].units)
        streams = {name: PARAMETER + order.index(name) for name in self.distributions}
        correlated = _given(self.correlation, self.shape)
        name = next((name for name in correlated if name in self.distributions), "")
        return Populations(tuple(populations), streams, name, correlated.get(name, 0.0))

    @property
    def least_exponent(self) -> float:
        """The least exponent among the tips."""
        if self.fixed is not None:
            return self.fixed.least_exponent(np.asarray(self.fixed.nondimensional()[2])[None])
        exponents = [
            each.parameters["exponent"].least for each in self.law.populations if "exponent" in each.parameters
        ]
        return min(exponents, default=np.inf)

    @property
    def distributions(self) -> dict[str, Distribution]:
        """The distribution of each shape parameter that was given."""
        return {} if self.fixed is not None else _given(self, self.shape)

    def sampled(self, count: int) -> "RandomAsperities":
        """The same with at most about ``count`` asperities."""
        if self.count is not None:
            return self.model_copy(update={"count": min(count, self.count)})
        return self.model_copy(update={"density": min(count, self.expected_count) / self.patch / self.patch})

    @property
    def expected_count(self) -> float:
        """How many asperities there are, on average."""
        return self.density * self.patch * self.patch if self.density is not None else float(self.count or 0)

    @property
    def warnings(self) -> tuple[str, ...]:
        """Heights by scipy's own parameters whose place was left to scipy, and is not about z = 0."""
        second = None if self.second is None else self.second.height
        heights = {"height": self.height} | ({} if second is None else {"second.height": second})
        return tuple(
            f"asperities.{key}: {entry.family} with its own parameters is that of scipy.stats, loc = 0, and its mean "
            "is not at z = 0; say loc = 0 if that is meant, or mean = 0 to move it there"
            for key, entry in heights.items()
            if entry.off_centre
        )

    @property
    def far_reaching(self) -> tuple[int, ...]:
        """Of the heights, and of the shape parameters."""
        populations = self.law.populations
        heights = (HEIGHT,) if any(each.height.long_tailed for each in populations) else ()
        names = [name for name in self.distributions if any(each.parameters[name].many_sized for each in populations)]
        return (*heights, *(self.law.streams[name] for name in names))

    def at_levels(self, stream: int, levels: Floats, count: int) -> Iterator[Ensemble]:
        """For each level in (0, 1) ``count`` asperities at it in one of the streams, evenly spread in the others."""
        others = spread(0, 0, self.law.varied)
        for level in levels:

            def draws(asked: int, number: int, level: float = level) -> Floats:
                return np.full(number, level) if asked == stream else others(asked, number)

            yield Ensemble.sorted(self.shape, *self.law.draw(draws, count), self.nominal_area, fixed=self.fixed)

    @property
    def sigma(self) -> float:
        """Standard deviation of the heights [m]."""
        return self.law.sigma

    def unfit_for(self, estimator: str) -> str:
        """The expected law needs heights that are spread, and parameters that do not follow from them."""
        if estimator != "expected":
            return ""
        if any(each.height.constant is not None for each in self.law.populations):
            return "all heights are the same"
        if abs(self.law.rank_correlation) == 1.0:
            return "the height alone tells the parameter that is correlated with it"
        return ""

    @property
    def one_parameter(self) -> bool:
        """Whether just one shape parameter is drawn, and from one distribution."""
        first, *others = self.law.populations
        return len(first.drawn) == 1 and not others

    @property
    def drawn_parameters(self) -> list[Callable[[Floats], Floats]]:
        """The shape parameters that are drawn, of each population: normal scores -> values [SI]."""
        return [each.parameters[name].of_scores for each in self.law.populations for name in each.drawn]

    def node_count(self, order: int) -> int:
        """One for each set of scores of the parameters that are drawn."""
        return sum(order ** len(population.drawn) for population in self.law.populations)

    def nodes(self, rule: Rule) -> Nodes:
        """Nodes at the scores of a rule, for each shape parameter that is not a constant."""
        return nodes_of(self.law, rule)

    def ensemble(self, seed: int, realization: int, *, stratified: bool = False, placed: bool = False) -> Ensemble:
        """The asperities of one realization; their number is the nearest to the mean where they are stratified."""
        draws = spread(seed, realization, self.law.varied) if stratified else independent(seed, realization)
        if self.count is not None or stratified:
            count = round(self.expected_count)
        else:
            count = poisson(draws, self.expected_count)
        height, parameters = self.law.draw(draws, count)
        positions = self.positions(draws, count) if placed else {}
        attrs: dict[str, float | int | str] = {"patch": self.patch, "seed": seed, "realization": realization}
        return Ensemble.sorted(self.shape, height, parameters, self.nominal_area, positions, attrs, self.fixed)


def _given(section: Section | None, shape: str) -> dict[str, Any]:
    """What a section says of the shape parameters, by their names."""
    if section is None:
        return {}
    entries = {name: getattr(section, name, None) for name in SHAPES[shape].units}
    return {name: entry for name, entry in entries.items() if entry is not None}


def _check_order(shape: str, population: Population) -> None:
    for name, floor, reason in SHAPES[shape].not_below:
        entry, least = population.parameters[name], population.parameters[floor]
        if entry.least < least.greatest:
            raise EntryError(
                name,
                f"from {entry.least:.3g}",
                f"must not be below {floor}, which can be as high as {least.greatest:.3g}: {reason}",
            )

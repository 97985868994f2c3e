"""source = "random": the part that the sections of all shapes have in common."""

import math
from collections.abc import Callable, Iterator, Mapping
from functools import cached_property
from itertools import product
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import model_validator

from roughmdr.ensemble.ensemble import Ensemble
from roughmdr.ensemble.lattice import LATTICES, check_pitch, with_sites_counted
from roughmdr.ensemble.nodes import Nodes, Rule
from roughmdr.ensemble.patch_source import MAX_COUNT, PatchSource
from roughmdr.ensemble.random.distribution import Distribution
from roughmdr.ensemble.random.distribution_reader import DistributionReader
from roughmdr.ensemble.random.population import Population, Populations, nodes_of
from roughmdr.ensemble.streams import HEIGHT, PARAMETER, Streams, make_streams, poisson
from roughmdr.errors import RoughmdrError
from roughmdr.numerics.arguments import Floats
from roughmdr.schema.quantities import EntryError, Quantity, WholeNumber
from roughmdr.schema.section import Length, Section
from roughmdr.schema.units import DIMENSIONLESS, format_quantity
from roughmdr.shapes import SHAPES

_Height = Annotated[Distribution, DistributionReader("m", mean=0.0)]


class Second(Section):
    """[asperities.second]: a second population, ``share`` of all asperities; keys left out are as in the first."""

    share: Annotated[float, Quantity(DIMENSIONLESS, above=0.0, at_most=1.0, example="0.2")]
    """Share of all asperities."""
    height: _Height | None = None
    """Heights of the summits above the datum plane z = 0; with a std alone their mean is 0: the second population."""


class Correlation(Section):
    """[asperities.correlation]: Spearman's rank correlation between the height and one shape parameter."""


class RandomAsperities(PatchSource):
    """[asperities] with source = "random": ``count`` asperities, or a ``density``, on a square of side ``patch``."""

    examples: ClassVar[Mapping[str, str]] = {
        "source": '"random"',
        "shape": '"paraboloid"',
        "count": "2000",
        "patch": '"1 mm"',
        "height": '{ distribution = "normal", std = "1 um" }',
        "radius": '"50 um"',
    }

    source: Literal["random"]
    count: Annotated[int, WholeNumber(1, MAX_COUNT)] | None = None
    """Number of asperities."""
    density: Annotated[float, Quantity("m-2", above=0.0)] | None = None
    """Mean number of asperities per area, in place of count: a Poisson number in each realisation."""
    pitch: Length | None = None
    """Distance of neighbours on a lattice, in place of count: the sites on the patch are counted."""
    height: _Height
    """Heights of the summits above the datum plane z = 0; with a std alone their mean is 0."""
    second: Second | None = None
    """A second population; keys left out are as in the first."""
    correlation: Correlation | None = None
    """Spearman's rank correlation of the height with one shape parameter."""

    _fill_lattice = model_validator(mode="before")(with_sites_counted)

    @model_validator(mode="after")
    def _check_parameters_and_count(self) -> "RandomAsperities":
        if self.shared_profile is None:
            SHAPES[self.shape].parameter_set(set(self.distributions))
        check_pitch(self.pitch, self.placement, self.vacancies)
        if self.count is None and self.density is None:
            raise RoughmdrError(
                "needs count, the pitch of a lattice, or a density from which the number in each realisation is drawn"
            )
        if self.count is not None and self.density is not None:
            raise EntryError("density", self.density, "does not go with count; leave one of them out")
        if self.density is not None and not self.expected_count <= MAX_COUNT:
            message = f"puts {self.expected_count:.3g} asperities on the patch; at most {MAX_COUNT:g}"
            raise EntryError("density", self.density, message)
        if self.density is not None and self.placement in LATTICES and not self.vacancies:
            message = "needs count or pitch: a density, with a random number of asperities, fills no lattice"
            raise EntryError("placement", self.placement, message)
        self.check_lattice()
        return self

    @model_validator(mode="after")
    def _check_populations(self) -> "RandomAsperities":
        names = ", ".join(self.distributions) or "none"
        in_second = _parameters_of(self.second, self.shape)
        for name in in_second:
            if name not in self.distributions:
                raise EntryError(f"second.{name}", None, f"is not given for the first population: {names}")
        members, bounds = enumerate(self.populations.members), SHAPES[self.shape].not_below
        for (number, population), (name, floor, reason) in product(members, bounds):
            entry, lower = population.parameters[name], population.parameters[floor]
            if entry.smallest < lower.largest:
                units = SHAPES[self.shape].units
                lowest = format_quantity(entry.smallest, units[name])
                limit = format_quantity(lower.largest, units[floor])
                given = lowest if entry.constant is not None else f"from {lowest}"
                limit = limit if lower.constant is not None else f"which can be as high as {limit}"
                key = f"second.{name}" if number > 0 and name in in_second else name
                raise EntryError(key, given, f"must not be below {floor}, {limit}: {reason}")
        if self.correlation is None:
            return self
        correlated = self.populations.correlated
        if not correlated:
            raise EntryError("correlation", None, f"names no parameter of the {self.shape}; it takes {names}")
        if len(_parameters_of(self.correlation, self.shape)) > 1:
            raise EntryError("correlation", None, "takes one parameter: it goes with the height")
        for name in (correlated, "height"):
            entries = [{"height": each.height, **each.parameters}[name] for each in self.populations.members]
            if all(entry.constant is not None for entry in entries):
                raise EntryError(f"correlation.{correlated}", None, f"needs a {name} that is not always the same")
        return self

    @property
    def distributions(self) -> dict[str, Distribution]:
        """The distribution of each shape parameter that was given."""
        return {} if self.shared_profile is not None else _parameters_of(self, self.shape)

    @cached_property
    def populations(self) -> Populations:
        """The populations that the asperities are drawn from."""
        first, share = self.distributions, self.second.share if self.second else 0.0
        members = [Population(1.0 - share, self.height, first)]
        if self.second is not None:
            parameters = {**first, **_parameters_of(self.second, self.shape)}
            members.append(Population(share, self.second.height or self.height, parameters))
        order = list(SHAPES[self.shape].units)
        streams = {name: PARAMETER + order.index(name) for name in first}
        correlations = _parameters_of(self.correlation, self.shape)
        name = next((name for name in correlations if name in first), "")
        return Populations(tuple(members), streams, name, correlations.get(name, 0.0))

    @property
    def min_exponent(self) -> float:
        if self.shared_profile is not None:
            return self.shared_profile.least_exponent(np.asarray(self.shared_profile.nondimensional()[2])[None])
        parameters = [each.parameters for each in self.populations.members]
        return min((each["exponent"].smallest for each in parameters if "exponent" in each), default=np.inf)

    def limited_to(self, count: int) -> "RandomAsperities":
        if self.lattice is not None:
            count = self.at_most(count)
        patch = self.patch * math.sqrt(min(1.0, count / self.expected_count))
        limited = {} if self.count is None else {"count": min(count, self.count)}
        return self.model_copy(update={"patch": patch, **limited})

    @property
    def expected_count(self) -> float:
        return self.density * self.patch * self.patch if self.density is not None else float(self.count or 0)

    @property
    def warnings(self) -> tuple[str, ...]:
        """Warnings of heights with scipy's own parameters but no location, and a mean that is not at z = 0."""
        heights = {"height": self.height, "second.height": self.second.height if self.second else None}
        return tuple(
            f"asperities.{key}: {entry.family} with its own parameters is that of scipy.stats, loc = 0, and its mean "
            "is not at z = 0; say loc = 0 if that is meant, or mean = 0 to move it there"
            for key, entry in heights.items()
            if entry is not None and entry.mean_off_zero
        )

    @property
    def heavy_tailed_streams(self) -> tuple[int, ...]:
        members = self.populations.members
        heights = (HEIGHT,) if any(each.height.long_tailed for each in members) else ()
        names = [name for name in self.distributions if any(each.parameters[name].broad for each in members)]
        return (*heights, *(self.populations.parameter_streams[name] for name in names))

    def ensembles_at_levels(self, stream: int, levels: Floats, count: int) -> Iterator[Ensemble]:
        others = make_streams(0, 0, self.populations.random_streams)
        for level in levels:

            def streams(number: int, size: int, level: float = level) -> Floats:
                return np.full(size, level) if number == stream else others(number, size)

            yield self._drawn(streams, count, {}, {})

    @property
    def sigma(self) -> float:
        return self.populations.sigma

    def reason_against(self, estimator: str) -> str:
        """Return why the expected law is impossible: where random heights are a function of the parameters."""
        if estimator == "expected" and abs(self.populations.rank_correlation) == 1.0:
            return "the height alone determines the parameter that is correlated with it"
        return ""

    @property
    def equal_heights(self) -> bool:
        return any(each.height.constant is not None for each in self.populations.members)

    @property
    def drawn_parameters(self) -> list[Callable[[Floats], Floats]]:
        members = self.populations.members
        return [each.parameters[name].from_scores for each in members for name in each.random_parameters]

    @property
    def node_axes(self) -> tuple[int, ...]:
        return tuple(len(population.random_parameters) for population in self.populations.members)

    @property
    def heights_depend(self) -> bool:
        return any(self.populations.correlated in each.random_parameters for each in self.populations.members)

    def nodes(self, *rules: Rule) -> Nodes:
        return nodes_of(self.populations, *rules)

    def extremes(self, chance: float) -> Ensemble:
        highest, parameters = self.populations.extremes(chance)
        count = next((column.size for column in parameters.values()), 1)
        heights = np.full(count, highest)
        return Ensemble(self.shape, heights, parameters, self.nominal_area, shared_profile=self.shared_profile)

    def ensemble(
        self, seed: int, realization: int, *, stratified: bool = False, with_positions: bool = False
    ) -> Ensemble:
        """Return the asperities of one realisation; of a density, stratified ones are the mean number, rounded."""
        streams = make_streams(seed, realization, self.populations.random_streams if stratified else ())
        is_fixed = self.count is not None or stratified
        count = round(self.expected_count) if is_fixed else poisson(streams, self.expected_count)
        positions = self.positions(streams, count) if with_positions else {}
        attrs = {**self.patch_attrs, "seed": seed, "realization": realization}
        return self._drawn(streams, count, positions, attrs)

    def _drawn(self, streams: Streams, count: int, positions: dict[str, Floats], attrs: dict[str, Any]) -> Ensemble:
        height, parameters = self.populations.draw(streams, count)
        return Ensemble(
            self.shape, height, parameters, self.nominal_area, positions, attrs, self.shared_profile
        ).sorted()


def _parameters_of(section: Section | None, shape: str) -> dict[str, Any]:
    """Return the entries of a section for the parameters of a shape, by their names."""
    entries = {name: getattr(section, name, None) for name in SHAPES[shape].units}
    return {name: entry for name, entry in entries.items() if entry is not None}

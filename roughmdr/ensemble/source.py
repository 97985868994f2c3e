"""The interface of all sources of asperities, which scenes, plans and runs use."""

import math
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Annotated, ClassVar

from roughmdr.ensemble.ensemble import Ensemble
from roughmdr.ensemble.maps.height_map import HeightMap
from roughmdr.ensemble.nodes import Nodes, Rule
from roughmdr.numerics.arguments import Floats
from roughmdr.schema.quantities import Quantity
from roughmdr.schema.section import Section
from roughmdr.shapes import SharedProfile

Patch = Annotated[float, Quantity("m", at_least=1e-150, at_most=1e150)]
"""Side of a patch, whose square is a float."""


class Source(Section):
    """[asperities]: a source declares its keys, overrides what raises NotImplementedError, and defaults as needed."""

    is_random: ClassVar[bool] = True
    """Whether realisations differ."""

    of_surface: ClassVar[bool] = False
    """Whether the asperities are the summits of a continuous surface."""

    papers: ClassVar[dict[str, str]] = {}
    """Subject of each paper on such summits, by its key in report/papers.bib."""

    source: str
    """"random": from distributions; "nayak": summits of a Gaussian surface; "spectrum": hills or summits of maps of
    one; "surface": those of a height map; "file": a saved ensemble."""

    @property
    def shape_name(self) -> str:
        """The shape of the asperities."""
        raise NotImplementedError

    @property
    def shared_profile(self) -> SharedProfile | None:
        """The profile of all asperities, for a shape whose parameters are not plain numbers."""
        return None

    @property
    def min_exponent(self) -> float:
        """The smallest exponent of the profiles at their tips."""
        return math.inf

    @property
    def inputs(self) -> tuple[Path, ...]:
        """The files that the asperities are read from."""
        return ()

    @property
    def warnings(self) -> tuple[str, ...]:
        """Warnings of entries that users may misunderstand."""
        return ()

    @property
    def description(self) -> tuple[str, ...]:
        """Lines on the measurement that the asperities are from; none where they are from none."""
        return ()

    @property
    def lattice_in_words(self) -> str:
        """The lattice that the asperities fill, with its pitch and patch; empty where they fill none."""
        return ""

    @property
    def repeats(self) -> bool:
        """Whether the surface is one period of an infinite one."""
        return True

    @property
    def goes_on(self) -> bool:
        """Whether the asperities, by density or a lattice, are a sample of a surface that goes on beyond the patch."""
        return False

    def height_map(self, seed: int, realization: int) -> HeightMap | None:
        """Return the map on which the asperities of a realisation were found; None where there is none."""
        return None

    @property
    def map_points(self) -> int:
        """The number of points of the map that each realisation draws; 0 where it draws none."""
        return 0

    @property
    def expected_count(self) -> float:
        """The mean number of asperities."""
        raise NotImplementedError

    @property
    def given_count(self) -> int | None:
        """The key ``count`` of sources that have it: the same number in all realisations; None of all others."""
        count: int | None = getattr(self, "count", None)
        return count

    @property
    def nominal_area(self) -> float | None:
        """Nominal area [m2]; None where it is unknown."""
        raise NotImplementedError

    @property
    def sides(self) -> tuple[float, float]:
        """Sides of the patch along x and y [m]; of a square where only the nominal area is known, which must be."""
        side = math.sqrt(self.nominal_area or 0.0)
        return side, side

    @property
    def exclusion_distance(self) -> float:
        """Radius [m] of the empty disc around an asperity that stands for its lack of near neighbours; 0 for none."""
        return 0.0

    @property
    def sigma(self) -> float:
        """Standard deviation of the heights [m]."""
        raise NotImplementedError

    def ensemble(
        self, seed: int, realization: int, *, stratified: bool = False, with_positions: bool = False
    ) -> Ensemble:
        """Return the asperities of one realisation; ``stratified`` ones cover their distributions evenly."""
        raise NotImplementedError

    def evenly_drawn(self, seed: int, *, with_positions: bool = False) -> Ensemble:
        """Return the asperities of the first realisation, stratified where they can be."""
        return self.ensemble(seed, 0, stratified=not self.reason_against("stratified"), with_positions=with_positions)

    def extremes(self, chance: float) -> Ensemble:
        """Return asperities of the height that one exceeds with this chance, with shape parameters that cover all but
        tails of this chance; all asperities themselves where nothing is drawn.
        """
        raise NotImplementedError

    @property
    def unbounded(self) -> "Source":
        """The source with a density in place of a count: a part of a surface that continues beyond the patch."""
        if self.given_count is None or self.nominal_area is None:
            return self
        return self.model_copy(update={"count": None, "density": self.given_count / self.nominal_area})

    def limited_to(self, count: int) -> "Source":
        """Return a source of about ``count`` asperities at most, on a smaller patch; itself where that cannot be."""
        return self

    def reason_against(self, estimator: str) -> str:
        """Return why the estimator "stratified" or "expected" is impossible; empty where it is possible."""
        return "" if self.is_random else f"nothing of source {self.source!r} is drawn"

    @property
    def equal_heights(self) -> bool:
        """Whether all asperities of a population have one height."""
        return False

    @property
    def all_alike(self) -> bool:
        """Whether they are a given number of equal asperities, without random draws."""
        return self.equal_heights and self.given_count is not None and self.node_count(2) == 1

    @property
    def one_parameter(self) -> bool:
        """Whether just one shape parameter is random, in one population."""
        return self.node_axes == (1,)

    @property
    def drawn_parameters(self) -> list[Callable[[Floats], Floats]]:
        """Each random shape parameter of each population as a function: normal scores -> values [SI]."""
        return []

    @property
    def node_axes(self) -> tuple[int, ...]:
        """For each population the number of scores that vary over its ``nodes``: the last one varies fastest."""
        return ()

    def node_count(self, order: int) -> int:
        """Return the number of ``nodes`` of a rule with so many scores."""
        return sum(order**axes for axes in self.node_axes)

    @property
    def heights_depend(self) -> bool:
        """Whether the heights depend on a random shape parameter, so that each of the ``nodes`` has its own."""
        return False

    def nodes(self, *rules: Rule) -> Nodes:
        """Return quadrature nodes that stand for all asperities, at the scores of one rule for all random parameters
        of all populations, or of one for each.
        """
        raise NotImplementedError

    @property
    def heavy_tailed_streams(self) -> tuple[int, ...]:
        """The streams of quantities with rare values that are far from the usual ones by factors."""
        return ()

    def ensembles_at_levels(self, stream: int, levels: Floats, count: int) -> Iterator[Ensemble]:
        """Yield, for each level in (0, 1) of one stream, ``count`` asperities stratified in the other streams."""
        raise NotImplementedError

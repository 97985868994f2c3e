"""What every source of asperities has in common: what a scene, a plan and a run ask of it."""

import math
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import ClassVar

from roughmdr.ensemble.ensemble import Ensemble
from roughmdr.ensemble.nodes import Nodes, Rule
from roughmdr.numerics.arguments import Floats
from roughmdr.schema.quantities import Section
from roughmdr.shapes import SharedProfile


class Source(Section):
    """[asperities]; each source declares its keys and answers what stands here."""

    drawn: ClassVar[bool] = True
    """Whether realisations differ."""

    source: str

    @property
    def shape_name(self) -> str:
        """The shape of the asperities."""
        raise NotImplementedError

    @property
    def fixed(self) -> SharedProfile | None:
        """The one profile of all asperities, where the shape's parameters are no plain numbers."""
        return None

    @property
    def least_exponent(self) -> float:
        """The least exponent among the tips."""
        return math.inf

    @property
    def inputs(self) -> tuple[Path, ...]:
        """The files that the asperities are read from."""
        return ()

    @property
    def content(self) -> str:
        """A hash of what is in those files; empty where there are none."""
        return ""

    @property
    def warnings(self) -> tuple[str, ...]:
        """Warn, in words, of the parts of the section that may not be as they were meant."""
        return ()

    @property
    def expected_count(self) -> float:
        """How many asperities there are, on average."""
        raise NotImplementedError

    @property
    def nominal_area(self) -> float | None:
        """[m2]; None where it is not known."""
        raise NotImplementedError

    def unfit_for(self, estimator: str) -> str:
        """Why the asperities cannot be "stratified" or their "expected" law be taken; empty where they can."""
        return "" if self.drawn else f"nothing of source {self.source!r} is drawn"

    @property
    def one_parameter(self) -> bool:
        """Whether just one shape parameter is drawn, and from one distribution."""
        return False

    @property
    def drawn_parameters(self) -> list[Callable[[Floats], Floats]]:
        """The shape parameters that are drawn, of each population: normal scores -> values [SI]."""
        return []

    def node_count(self, order: int) -> int:
        """How many ``nodes`` a rule of this order has."""
        raise NotImplementedError

    def nodes(self, rule: Rule) -> Nodes:
        """Asperities with weights that stand for all: at the scores of a rule for each parameter that is drawn."""
        raise NotImplementedError

    @property
    def far_reaching(self) -> tuple[int, ...]:
        """The streams of quantities that are, though seldom, many times larger or smaller than mostly."""
        return ()

    def at_levels(self, stream: int, levels: Floats, count: int) -> Iterator[Ensemble]:
        """For each level in (0, 1) ``count`` asperities at it in one of the streams, evenly spread in the others."""
        raise NotImplementedError

    def sampled(self, count: int) -> "Source":
        """The same with about ``count`` asperities at most, where that can be."""
        return self

    @property
    def sigma(self) -> float:
        """Standard deviation of the heights [m]."""
        raise NotImplementedError

    def ensemble(self, seed: int, realization: int, *, stratified: bool = False, placed: bool = False) -> Ensemble:
        """The asperities of one realization.

        ``stratified`` draws them evenly spread over their distribution, ``placed`` gives them positions.
        """
        raise NotImplementedError

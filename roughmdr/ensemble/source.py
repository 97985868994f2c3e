"""The interface of all sources of asperities: what a scene, a plan and a run ask of them."""

import math
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Annotated, ClassVar, Literal

from pydantic import BeforeValidator, StrictBool, ValidationInfo, field_validator, model_validator

from roughmdr.ensemble.ensemble import Ensemble
from roughmdr.ensemble.lattice import LATTICES, Lattice, at_most, lattice_of, nearest_that_fit
from roughmdr.ensemble.maps.height_map import HeightMap
from roughmdr.ensemble.nodes import Nodes, Rule
from roughmdr.ensemble.streams import Streams
from roughmdr.errors import RoughmdrError
from roughmdr.numerics.arguments import Floats
from roughmdr.schema.quantities import EntryError, Length, Quantity, Section
from roughmdr.schema.units import format_quantity
from roughmdr.shapes import SharedProfile

MAX_COUNT = 1_000_000_000
"""Asperities that a patch may hold."""

_SIDES = "patch_x", "patch_y"
LATTICE_CONSTANTS = {"square": 3.90026492, "hexagonal": 3.92103158}
"""Minus the sum of 1/r over a lattice of unit density in a uniform background of the opposite sign: twice the energy of
an electron in such a crystal (L. Bonsall, A. A. Maradudin, Phys. Rev. B 15 (1977) 1959).
"""


class Source(Section):
    """[asperities]: a source declares its keys and overrides what raises NotImplementedError, and defaults as
    needed.
    """

    is_random: ClassVar[bool] = True
    """Whether realisations differ."""

    of_surface: ClassVar[bool] = False
    """Whether the asperities are the summits of a continuous surface."""

    source: str

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
    def content_hash(self) -> str:
        """A hash of the contents of those files; empty where there are none."""
        return ""

    @property
    def warnings(self) -> tuple[str, ...]:
        """Warnings of entries that may not mean what the user thinks."""
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
        """Whether the surface is one period of one without end."""
        return True

    def height_map(self, seed: int, realization: int) -> HeightMap | None:
        """Return the map on which the asperities of a realisation were found; None where there is none."""
        return None

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
        """[m2]; None where it is unknown."""
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

    def extremes(self, chance: float) -> Ensemble:
        """Return asperities as high as an asperity is with this chance, with shape parameters that cover all but tails
        of this chance; all asperities themselves where nothing is drawn.
        """
        raise NotImplementedError

    @property
    def unbounded(self) -> "Source":
        """The source as a part of a surface that goes on beyond the patch: with a density in place of a count."""
        if self.given_count is None or self.nominal_area is None:
            return self
        return self.model_copy(update={"count": None, "density": self.given_count / self.nominal_area})

    def limited_to(self, count: int) -> "Source":
        """Return a source like this one with about ``count`` asperities at most, on so much smaller a patch, or itself
        where that cannot be.
        """
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
        """Whether they are a given number of equal asperities, of which nothing is drawn."""
        return False

    @property
    def one_parameter(self) -> bool:
        """Whether just one shape parameter is random, in one population."""
        return False

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
        raise NotImplementedError

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
        """The streams of quantities with rare values many times larger, or smaller, than the usual ones."""
        return ()

    def ensembles_at_levels(self, stream: int, levels: Floats, count: int) -> Iterator[Ensemble]:
        """Yield, for each level in (0, 1) of one stream, ``count`` asperities stratified in the other streams."""
        raise NotImplementedError


class PatchSource(Source):
    """A source whose asperities lie on a square of side ``patch``, or fill a lattice on an oblong of that area."""

    has_usual_distance: ClassVar[bool] = False
    """Whether ``core_distance`` is known without min_distance."""

    shape: str
    patch: Annotated[float, BeforeValidator(Quantity("m", at_least=1e-150, at_most=1e150))]  # its square is a float
    placement: Literal["random", "hard_core", "square", "hexagonal"] = "random"
    min_distance: Length | None = None
    vacancies: StrictBool = False

    @field_validator("min_distance")
    @classmethod
    def _only_with_hard_core(cls, value: float | None, info: ValidationInfo) -> float | None:
        if value is not None and info.data.get("placement", "hard_core") != "hard_core":
            raise RoughmdrError('goes with placement = "hard_core" only')
        return value

    @model_validator(mode="after")
    def _hard_core_has_a_distance(self) -> "PatchSource":
        if self.placement == "hard_core" and self.min_distance is None and not self.has_usual_distance:
            raise RoughmdrError('placement = "hard_core" needs min_distance')
        return self

    @model_validator(mode="after")
    def _vacancies_are_of_a_lattice(self) -> "PatchSource":
        if self.vacancies and self.placement != "hexagonal":
            raise EntryError("vacancies", True, 'goes with placement = "hexagonal" only')
        return self

    def check_lattice(self) -> None:
        """Raise EntryError where the asperities fill no lattice though they are placed on one."""
        if self.placement in LATTICES and not self.vacancies and self.lattice is None:
            count = round(self.expected_count)
            others = " or ".join(map(str, nearest_that_fit(self.placement, count)))
            message = f"{count} asperities fill no {self.placement} lattice on a patch that repeats; {others} do"
            vacancies = "; vacancies = true leaves sites empty" if self.placement == "hexagonal" else ""
            raise EntryError("placement", self.placement, f"{message}{vacancies}")

    def at_most(self, count: int) -> int:
        """Return how many asperities are ``count`` at most, or all; on a lattice, as many as fill one."""
        whole = round(self.expected_count)
        return at_most(self.placement, count) if self.lattice is not None and count < whole else min(count, whole)

    @property
    def lattice(self) -> Lattice | None:
        """The lattice that the asperities fill; None where they fill none."""
        if self.placement not in LATTICES or self.vacancies:
            return None
        return lattice_of(self.placement, round(self.expected_count), self.nominal_area)

    @property
    def lattice_in_words(self) -> str:
        lattice = self.lattice
        if lattice is None:
            return ""
        sides = " x ".join(format_quantity(side, "m") for side in lattice.sides)
        pitch = format_quantity(lattice.pitch, "m")
        return f"{lattice.kind} lattice, {lattice.rows} rows of {lattice.columns}, pitch {pitch}, patch {sides}"

    @property
    def shape_name(self) -> str:
        return self.shape

    @property
    def core_distance(self) -> float:
        """Least distance of two asperities [m] under placement "hard_core"; else 0."""
        return self.min_distance or 0.0

    @property
    def exclusion_distance(self) -> float:
        if self.placement in LATTICES:
            return 0.5 * LATTICE_CONSTANTS[self.placement] / math.pi * self.patch / math.sqrt(self.expected_count)
        return self.core_distance

    @property
    def nominal_area(self) -> float:
        return self.patch * self.patch

    @property
    def sides(self) -> tuple[float, float]:
        return (self.patch, self.patch) if (lattice := self.lattice) is None else lattice.sides

    @property
    def patch_attrs(self) -> dict[str, float | int | str]:
        """The sides of the patch, and ``exclusion_distance`` where there is one, as attributes of ensembles."""
        sides = {"patch": self.patch} if self.lattice is None else dict(zip(_SIDES, self.sides, strict=True))
        return {**sides, **({"exclusion_distance": self.exclusion_distance} if self.exclusion_distance > 0.0 else {})}

    def positions(self, streams: Streams, count: int) -> dict[str, Floats]:
        """Return x and y [m] of ``count`` asperities; OutOfRange where they do not fit at the distance asked for."""
        from roughmdr.ensemble import placement

        if (lattice := self.lattice) is not None:
            x, y = lattice.positions()
        elif self.placement == "hard_core":
            x, y = placement.hard_core_positions(streams, count, self.patch, self.core_distance)
        elif self.placement == "hexagonal":
            x, y = placement.nearly_hexagonal_positions(count, self.patch)
        else:
            x, y = placement.random_positions(streams, count, self.patch)
        return {"x": x, "y": y}

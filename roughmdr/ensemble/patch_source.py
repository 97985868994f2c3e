"""The interface of sources whose asperities lie on a patch: at random, apart from each other or on a lattice."""

import math
from typing import ClassVar, Literal

from pydantic import StrictBool, ValidationInfo, field_validator, model_validator

from roughmdr.ensemble.lattice import LATTICES, Lattice, at_most, lattice_of, nearest_that_fit
from roughmdr.ensemble.source import Patch, Source
from roughmdr.ensemble.streams import POSITION, Streams
from roughmdr.errors import RoughmdrError
from roughmdr.numerics.arguments import Floats
from roughmdr.schema.quantities import EntryError
from roughmdr.schema.section import Length
from roughmdr.schema.units import format_quantity

MAX_COUNT = 1_000_000_000
"""Asperities that a patch may hold."""

_SIDES = "patch_x", "patch_y"
LATTICE_CONSTANTS = {"square": 3.90026492, "hexagonal": 3.92103158}
"""Minus the sum of 1/r over a lattice of unit density in a uniform background of the opposite sign: twice the energy of
an electron in such a crystal (L. Bonsall, A. A. Maradudin, Phys. Rev. B 15 (1977) 1959).
"""


class PatchSource(Source):
    """A source whose asperities lie on a square of side ``patch``, or fill a lattice on an oblong of that area."""

    has_usual_distance: ClassVar[bool] = False
    """Whether ``core_distance`` is known without min_distance."""

    shape: str
    """Shape of the asperities, which decides the other keys."""
    patch: Patch
    """Side of the square nominal area, or of the square of the same area where a lattice has an oblong one."""
    placement: Literal["random", "hard_core", "square", "hexagonal"] = "random"
    """Positions, for [interaction]: "random", "hard_core" with min_distance, "square" or "hexagonal"."""
    min_distance: Length | None = None
    """Least distance of two asperities, for placement = "hard_core"."""
    vacancies: StrictBool = False
    """Whether a lattice on a square patch, only nearly hexagonal, may have empty sites."""

    @field_validator("min_distance")
    @classmethod
    def _only_with_hard_core(cls, value: float | None, info: ValidationInfo) -> float | None:
        if value is not None and info.data.get("placement", "hard_core") != "hard_core":
            raise RoughmdrError('goes with placement = "hard_core" only')
        return value

    @model_validator(mode="after")
    def _check_placement(self) -> "PatchSource":
        if self.placement == "hard_core" and self.min_distance is None and not self.has_usual_distance:
            raise RoughmdrError('placement = "hard_core" needs min_distance')
        if self.vacancies and self.placement != "hexagonal":
            raise EntryError("vacancies", True, 'goes with placement = "hexagonal" only')
        return self

    def check_lattice(self) -> None:
        """Raise EntryError where placement is on a lattice and the asperities do not fill one."""
        if self.placement in LATTICES and not self.vacancies and self.lattice is None:
            count = round(self.expected_count)
            others = " or ".join(map(str, nearest_that_fit(self.placement, count)))
            message = f"{count} asperities fill no {self.placement} lattice on a patch that repeats; {others} do"
            vacancies = "; vacancies = true leaves sites empty" if self.placement == "hexagonal" else ""
            raise EntryError("placement", self.placement, f"{message}{vacancies}")

    def at_most(self, count: int) -> int:
        """Return the number of asperities, or ``count`` if that is less; on a lattice, a number that fills one."""
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
    def goes_on(self) -> bool:
        return self.given_count is None or self.lattice is not None

    @property
    def patch_attrs(self) -> dict[str, float | int | str]:
        """The sides of the patch, and ``goes_on`` and ``exclusion_distance`` if above 0, as attributes of ensembles."""
        sides = {"patch": self.patch} if self.lattice is None else dict(zip(_SIDES, self.sides, strict=True))
        others = {"goes_on": int(self.goes_on), "exclusion_distance": self.exclusion_distance}
        return {**sides, **{name: value for name, value in others.items() if value > 0.0}}

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
            x, y = streams(POSITION, 2 * count).reshape(count, 2).T * self.patch
        return {"x": x, "y": y}

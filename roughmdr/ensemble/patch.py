"""Sources whose asperities lie on a square patch, and the keys that place them there."""

from typing import Annotated, Literal

from pydantic import BeforeValidator, ValidationInfo, field_validator, model_validator

from roughmdr.ensemble.source import Source
from roughmdr.ensemble.streams import Streams
from roughmdr.errors import RoughmdrError
from roughmdr.numerics.arguments import Floats
from roughmdr.schema.quantities import Length, Quantity

MAX_COUNT = 1_000_000_000
"""Asperities that a patch may hold."""


class PatchSource(Source):
    """A source whose asperities lie on a square of side ``patch``."""

    shape: str
    patch: Annotated[float, BeforeValidator(Quantity("m", at_least=1e-150, at_most=1e150))]  # its square is a float
    placement: Literal["random", "hard_core", "hexagonal"] = "random"
    min_distance: Length | None = None

    @field_validator("min_distance")
    @classmethod
    def _only_with_hard_core(cls, value: float | None, info: ValidationInfo) -> float | None:
        if value is not None and info.data.get("placement", "hard_core") != "hard_core":
            raise RoughmdrError('goes with placement = "hard_core" only')
        return value

    @model_validator(mode="after")
    def _hard_core_has_a_distance(self) -> "PatchSource":
        if self.placement == "hard_core" and self.min_distance is None:
            raise RoughmdrError('placement = "hard_core" needs min_distance')
        return self

    @property
    def shape_name(self) -> str:
        return self.shape

    @property
    def nominal_area(self) -> float:
        return self.patch * self.patch

    def positions(self, streams: Streams, count: int) -> dict[str, Floats]:
        """Return x and y [m] of ``count`` asperities; OutOfRange where they do not fit at the distance asked for."""
        from roughmdr.ensemble import placement

        if self.min_distance is not None:
            x, y = placement.hard_core_positions(streams, count, self.patch, self.min_distance)
        elif self.placement == "hexagonal":
            x, y = placement.hexagonal_positions(count, self.patch)
        else:
            x, y = placement.random_positions(streams, count, self.patch)
        return {"x": x, "y": y}

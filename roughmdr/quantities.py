"""What sections of a scene are declared with: a section refuses keys that it does not know, a quantity reads units."""

from typing import Annotated

from pydantic import BaseModel, BeforeValidator, ConfigDict

from roughmdr.errors import RoughmdrError
from roughmdr.units import quantity


class Section(BaseModel):
    """A table of a scene. Keys that it does not declare are errors; it cannot be changed afterwards."""

    model_config = ConfigDict(extra="forbid", frozen=True, arbitrary_types_allowed=True)


def reading(
    dimension: str, *, above: float | None = None, least: float | None = None, most: float | None = None
) -> BeforeValidator:
    """For a float in SI, read from a number or a string with a unit, within the given bounds."""

    def read(value: object) -> float:
        number = quantity(value, dimension)
        if above is not None and not number > above:
            raise RoughmdrError(f"must be above {above:g}")
        if least is not None and not number >= least:
            raise RoughmdrError(f"must be at least {least:g}")
        if most is not None and not number <= most:
            raise RoughmdrError(f"must be at most {most:g}")
        return number

    return BeforeValidator(read)


def whole_number(least: int, most: int) -> BeforeValidator:
    """For an integer within the given bounds."""

    def read(value: object) -> int:
        if isinstance(value, bool) or not isinstance(value, int):
            raise RoughmdrError("expected a whole number")
        if not least <= value <= most:
            raise RoughmdrError(f"must be from {least} to {most}")
        return value

    return BeforeValidator(read)


Length = Annotated[float, reading("m", above=0.0)]

"""What sections of a scene are declared with: a section refuses keys that it does not know, a reader checks a value.

A reader is a callable that turns what stands in the scene into a value, or raises RoughmdrError; its ``dimension`` says
what it reads.
"""

from dataclasses import dataclass
from typing import Annotated, Any, ClassVar, Protocol, runtime_checkable

from pydantic import BaseModel, BeforeValidator, ConfigDict

from roughmdr.errors import RoughmdrError
from roughmdr.schema.units import DIMENSIONLESS, quantity


class Section(BaseModel):
    """A table of a scene. Keys that it does not declare are errors; it cannot be changed afterwards."""

    model_config = ConfigDict(extra="forbid", frozen=True, arbitrary_types_allowed=True)


@runtime_checkable
class Reader(Protocol):
    """What reads one value of a scene."""

    @property
    def dimension(self) -> str:
        """As in ``units``."""
        ...

    def __call__(self, value: object) -> Any:
        """The value in SI; RoughmdrError where there is none."""


class EntryError(RoughmdrError):
    """A fault of one entry of the table that a reader was given."""

    def __init__(self, key: str, value: object, message: str) -> None:
        super().__init__(message)
        self.key, self.value = key, value


@dataclass(frozen=True)
class Quantity:
    """Reads a float in SI from a number or a string with a unit, within the given bounds."""

    dimension: str
    above: float | None = None
    least: float | None = None
    most: float | None = None

    def __call__(self, value: object) -> float:
        """The number in SI."""
        number = quantity(value, self.dimension)
        if self.above is not None and not number > self.above:
            raise RoughmdrError(f"must be above {self.above:g}")
        if self.least is not None and not number >= self.least:
            raise RoughmdrError(f"must be at least {self.least:g}")
        if self.most is not None and not number <= self.most:
            raise RoughmdrError(f"must be at most {self.most:g}")
        return number


@dataclass(frozen=True)
class WholeNumber:
    """Reads an integer within the given bounds."""

    least: int
    most: int
    dimension: ClassVar[str] = DIMENSIONLESS

    def __call__(self, value: object) -> int:
        """The integer."""
        if isinstance(value, bool) or not isinstance(value, int):
            raise RoughmdrError("expected a whole number")
        if not self.least <= value <= self.most:
            raise RoughmdrError(f"must be from {self.least} to {self.most}")
        return value


Length = Annotated[float, BeforeValidator(Quantity("m", above=0.0))]

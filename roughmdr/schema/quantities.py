"""Building blocks of a scene's sections: a section refuses unknown keys, a reader checks and converts one value.

A reader is a callable that converts a value of the scene or raises RoughmdrError; ``dimension`` is its SI unit.
"""

from dataclasses import dataclass
from typing import Annotated, Any, ClassVar, Protocol, runtime_checkable

from pydantic import BaseModel, BeforeValidator, ConfigDict

from roughmdr.errors import RoughmdrError
from roughmdr.schema.units import DIMENSIONLESS, quantity


class Section(BaseModel):
    """A table of a scene: keys that it does not declare are errors, and it is immutable."""

    model_config = ConfigDict(extra="forbid", frozen=True, arbitrary_types_allowed=True)


@runtime_checkable
class Reader(Protocol):
    """Converts one value of a scene."""

    @property
    def dimension(self) -> str:
        """SI unit, as in ``units``; empty for names."""
        ...

    def __call__(self, value: object) -> Any:
        """Return the value in SI; RoughmdrError if it is not allowed."""


class EntryError(RoughmdrError):
    """Raised by the reader of a table for the one entry that is wrong."""

    def __init__(self, key: str, value: object, message: str) -> None:
        super().__init__(message)
        self.key, self.value = key, value


@dataclass(frozen=True)
class Quantity:
    """Reads a float in SI from a number or a string with a unit, within the given bounds."""

    dimension: str
    above: float | None = None
    at_least: float | None = None
    at_most: float | None = None

    def __call__(self, value: object) -> float:
        """Return the number in SI."""
        number = quantity(value, self.dimension)
        if self.above is not None and not number > self.above:
            raise RoughmdrError(f"must be above {self.above:g}")
        if self.at_least is not None and not number >= self.at_least:
            raise RoughmdrError(f"must be at least {self.at_least:g}")
        if self.at_most is not None and not number <= self.at_most:
            raise RoughmdrError(f"must be at most {self.at_most:g}")
        return number


@dataclass(frozen=True)
class WholeNumber:
    """Reads an integer within the given bounds."""

    minimum: int
    maximum: int
    dimension: ClassVar[str] = DIMENSIONLESS

    def __call__(self, value: object) -> int:
        """Return the integer."""
        if isinstance(value, bool) or not isinstance(value, int):
            raise RoughmdrError("expected a whole number")
        if not self.minimum <= value <= self.maximum:
            raise RoughmdrError(f"must be from {self.minimum} to {self.maximum}")
        return value


Length = Annotated[float, BeforeValidator(Quantity("m", above=0.0))]

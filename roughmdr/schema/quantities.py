"""Building blocks of a scene's sections: a section refuses unknown keys, a reader checks and converts one value.

A reader is a callable that converts a value of the scene or raises RoughmdrError; ``dimension`` is its SI unit.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Protocol, runtime_checkable

from pydantic import BaseModel, BeforeValidator, ConfigDict

from roughmdr.errors import RoughmdrError
from roughmdr.schema.json_schema import JsonSchema
from roughmdr.schema.units import DIMENSIONLESS, example_of_unit, quantity, quantity_pattern

if TYPE_CHECKING:
    from pydantic._internal._model_construction import ModelMetaclass
else:
    ModelMetaclass = type(BaseModel)

_OF_PYDANTIC = {name for name in dir(BaseModel) if not name.startswith("__")}


class _Listed(ModelMetaclass):
    """Lists of a section its own names, not those of pydantic."""

    def __dir__(self) -> list[str]:
        return sorted({*super().__dir__()} - _OF_PYDANTIC)


class Section(BaseModel, metaclass=_Listed):
    """A table of a scene: keys that it does not declare are errors, and it is immutable."""

    model_config = ConfigDict(extra="forbid", frozen=True, arbitrary_types_allowed=True)

    examples: ClassVar[Mapping[str, str]] = {}
    """Values of its keys in TOML, for messages on what is missing."""

    def __dir__(self) -> list[str]:
        return sorted({*super().__dir__()} - _OF_PYDANTIC)


@runtime_checkable
class Reader(Protocol):
    """Converts one value of a scene."""

    @property
    def dimension(self) -> str:
        """SI unit, as in ``units``; empty for names."""
        ...

    def __call__(self, value: object) -> Any:
        """Return the value in SI; RoughmdrError if it is not allowed."""

    def json_schema(self) -> JsonSchema:
        """Return the JSON Schema of all values that are allowed, and of as few others as it can tell apart."""


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

    def json_schema(self) -> JsonSchema:
        """Return the schema of a number within the bounds, or of a string with a unit."""
        bounds = {"exclusiveMinimum": self.above, "minimum": self.at_least, "maximum": self.at_most}
        within = {name: bound for name, bound in bounds.items() if bound is not None}
        return {"type": ["number", "string"], **within, "pattern": quantity_pattern(self.dimension)}

    def __str__(self) -> str:
        bounds = {"above": self.above, "at least": self.at_least, "at most": self.at_most}
        limits = " and ".join(f"{name} {bound:g}" for name, bound in bounds.items() if bound is not None)
        unit = f"a number in {self.dimension} or a string with a unit, as {example_of_unit(self.dimension)}"
        return ", ".join(filter(None, ("a number" if self.dimension == DIMENSIONLESS else unit, limits)))


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

    def json_schema(self) -> JsonSchema:
        """Return the schema of an integer within the bounds."""
        return {"type": "integer", "minimum": self.minimum, "maximum": self.maximum}

    def __str__(self) -> str:
        return f"a whole number from {self.minimum} to {self.maximum}"


def adheres(table: dict[str, Any]) -> bool:
    """Return whether a scene, as a table, has a work of adhesion above 0 in any of its cells."""
    section, swept = table.get("adhesion", {}), table.get("sweep", {}).get("adhesion.work")
    if isinstance(swept, dict):
        swept = next((ends for name, ends in swept.items() if name in ("linspace", "logspace")), [])
    works = [section.get("work", 0.0)] if swept is None else swept
    return "adhesion" in table and any(Quantity("J/m^2")(work) > 0.0 for work in works)


Length = Annotated[float, BeforeValidator(Quantity("m", above=0.0))]

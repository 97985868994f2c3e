"""Declarations of arguments: the unit and range of a number, from which scenes, Python arguments and messages follow.

A reader is declared once and converts a value wherever it is given: a field of a section of a scene is annotated with
it, a function in Python calls ``argument``. pydantic is not loaded before there is a section.
"""

import math
from dataclasses import dataclass
from numbers import Integral
from typing import TYPE_CHECKING, Any

from roughmdr.errors import OutOfRange, RoughmdrError, warn_limits
from roughmdr.schema.json_schema import JsonSchema
from roughmdr.schema.units import DIMENSIONLESS, as_text, example_of_unit, millipascals, quantity, quantity_pattern
from roughmdr.schema.wording import short_repr

if TYPE_CHECKING:
    from pydantic import GetCoreSchemaHandler
    from pydantic_core import CoreSchema


@dataclass(frozen=True, kw_only=True)
class Reader:
    """Converts one value of a scene."""

    example: str = ""
    """A value as a scene has it, for messages on what is missing."""
    dimension = ""
    """SI unit, as in ``units``; empty for names."""

    def __call__(self, value: object) -> Any:
        """Return the value in SI; RoughmdrError if it is not allowed."""
        raise NotImplementedError

    def json_schema(self) -> JsonSchema:
        """Return the JSON Schema of all values that are allowed, and of as few others as it can tell apart."""
        raise NotImplementedError

    def __get_pydantic_core_schema__(self, source: Any, handler: "GetCoreSchemaHandler") -> "CoreSchema":
        """Let pydantic convert the values of fields that are annotated with it."""
        from pydantic_core import core_schema

        return core_schema.no_info_before_validator_function(self, handler(source))


class EntryError(RoughmdrError):
    """Raised by the reader of a table for the one entry that is wrong."""

    def __init__(self, key: str, value: object, message: str) -> None:
        super().__init__(message)
        self.key, self.value = key, value


@dataclass(frozen=True)
class Quantity(Reader):
    """Reads a float in SI from a number or a string with a unit, within the given bounds."""

    dimension: str
    above: float | None = None
    at_least: float | None = None
    at_most: float | None = None

    def __call__(self, value: object) -> float:
        """Return the number in SI."""
        number = quantity(value, self.dimension)
        if limit := self._broken(number):
            raise RoughmdrError(f"must be {limit}")
        return number

    def argument(self, name: str, value: Any) -> float:
        """Return the argument ``name`` of a Python function in SI; OutOfRange unless it is within the bounds."""
        unit = "" if self.dimension == DIMENSIONLESS else f" {self.dimension}"
        try:
            value = as_text(value)
            number = from_text(name, value, self.dimension) if isinstance(value, str) else float(value)
        except OutOfRange:
            raise
        except (TypeError, ValueError, OverflowError):
            raise OutOfRange(f"{name} is {short_repr(value)}; it must be {self._allowed(unit)}") from None
        if not math.isfinite(number) or self._broken(number):
            raise OutOfRange(f"{name} is {number:g}{unit}; it must be {self._allowed(unit)}")
        return number

    def _broken(self, number: float) -> str:
        """Return the bound that a number is not within; empty if it is within all."""
        if self.above is not None and not number > self.above:
            return f"above {self.above:g}"
        if self.at_least is not None and not number >= self.at_least:
            return f"at least {self.at_least:g}"
        if self.at_most is not None and not number <= self.at_most:
            return f"at most {self.at_most:g}"
        return ""

    def _bounds(self, unit: str) -> str:
        bounds = {"above": self.above, "at least": self.at_least, "at most": self.at_most}
        return " and ".join(f"{name} {bound:g}{unit}" for name, bound in bounds.items() if bound is not None)

    def _allowed(self, unit: str) -> str:
        number = "a finite number" if self.at_most is None else "a number"
        return f"{number} {'of ' if self.above is None else ''}{self._bounds(unit)}"

    def json_schema(self) -> JsonSchema:
        """Return the schema of a number within the bounds, or of a string with a unit."""
        bounds = {"exclusiveMinimum": self.above, "minimum": self.at_least, "maximum": self.at_most}
        within = {name: bound for name, bound in bounds.items() if bound is not None}
        return {"type": ["number", "string"], **within, "pattern": quantity_pattern(self.dimension)}

    def __str__(self) -> str:
        unit = f"a number in {self.dimension} or a string with a unit, as {example_of_unit(self.dimension)}"
        return ", ".join(filter(None, ("a number" if self.dimension == DIMENSIONLESS else unit, self._bounds(""))))


@dataclass(frozen=True)
class WholeNumber(Reader):
    """Reads an integer within the given bounds."""

    minimum: int
    maximum: int
    dimension = DIMENSIONLESS

    def __call__(self, value: object) -> int:
        """Return the integer."""
        if isinstance(value, bool) or not isinstance(value, Integral):
            raise RoughmdrError("expected a whole number")
        if not self.minimum <= int(value) <= self.maximum:
            raise RoughmdrError(f"must be from {self.minimum} to {self.maximum}")
        return int(value)

    def argument(self, name: str, value: object) -> int:
        """Return the argument ``name`` of a Python function; OutOfRange unless it is such a number."""
        try:
            return self(value)
        except RoughmdrError:
            raise OutOfRange(f"{name} is {short_repr(value)}; it must be {self}") from None

    def json_schema(self) -> JsonSchema:
        """Return the schema of an integer within the bounds."""
        return {"type": "integer", "minimum": self.minimum, "maximum": self.maximum}

    def __str__(self) -> str:
        return f"a whole number from {self.minimum} to {self.maximum}"


@dataclass(frozen=True)
class Name(Reader):
    """Reads the name of a model, a distribution or a file."""

    choices: tuple[str, ...] = ()
    """The names that there are, which the section itself holds it to; empty for any."""

    def __call__(self, value: object) -> str:
        """Return the name."""
        if not isinstance(value, str):
            raise RoughmdrError("expected a name")
        return value

    def json_schema(self) -> JsonSchema:
        """Return the schema of the names."""
        if not self.choices:
            return {"type": "string"}
        return {"enum": list(self.choices)} if len(self.choices) > 1 else {"const": self.choices[0]}

    def __str__(self) -> str:
        return ""


def from_text(name: str, text: str, dimension: str) -> float:
    """Return a string with a unit, an argument of a Python function, in SI; OutOfRange where it cannot be read."""
    try:
        number = quantity(text, dimension)
    except RoughmdrError as error:
        raise OutOfRange(f"{name} is {short_repr(text)}: {error}") from None
    if doubt := millipascals(text):
        warn_limits([f"{name} is {short_repr(text)}: {doubt}"])
    return number


def adheres(table: dict[str, Any]) -> bool:
    """Return whether a scene, as a table, has a work of adhesion above 0 in any of its cells."""
    section, swept = table.get("adhesion", {}), table.get("sweep", {}).get("adhesion.work")
    if isinstance(swept, dict):
        swept = next((ends for name, ends in swept.items() if name in ("linspace", "logspace")), [])
    works = [section.get("work", 0.0)] if swept is None else swept
    return "adhesion" in table and any(Quantity("J/m^2")(work) > 0.0 for work in works)

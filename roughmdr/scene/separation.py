"""One separation of a path: a length, standard deviations of the heights, "clear", or what is to be reached there."""

import re
from dataclasses import dataclass
from typing import Annotated, NamedTuple

from pydantic import model_validator

from roughmdr.errors import RoughmdrError
from roughmdr.schema.json_schema import JsonSchema
from roughmdr.schema.quantities import Quantity, Reader
from roughmdr.schema.section import Section
from roughmdr.schema.units import DIMENSIONLESS, NUMBER, format_quantity, quantity, quantity_pattern
from roughmdr.variables import CURVE_VARIABLES

_SIGMA = re.compile(rf"\s*({NUMBER})\s*sigma\s*")


class Separation(NamedTuple):
    """A separation in metres, or in standard deviations of the heights."""

    value: float
    in_sigma: bool

    def metres(self, sigma: float) -> float:
        """Return it in metres, where the heights' standard deviation is sigma [m]."""
        return self.value * sigma if self.in_sigma else self.value


CLEAR = "clear"
"""The start of a path where no asperity touches, or attracts: the default."""


@dataclass(frozen=True)
class SeparationReader(Reader):
    """Reads a separation; where ``clear`` is allowed, that is None."""

    clear: bool = False
    other: str = ""  # in messages: other entries that are allowed
    dimension = "m"

    def __call__(self, value: object) -> Separation | None:
        """Return the separation, in metres or in sigma."""
        if self.clear and value == CLEAR:
            return None
        if isinstance(value, str) and (match := _SIGMA.fullmatch(value)):
            return Separation(quantity(match[1], DIMENSIONLESS), in_sigma=True)
        try:
            return Separation(quantity(value, self.dimension), in_sigma=False)
        except RoughmdrError as error:
            sigma = 'in standard deviations of the heights, like "4 sigma"'
            raise RoughmdrError(f"{error}, or {sigma}{self.other}") from None

    def json_schema(self) -> JsonSchema:
        """Return the schema of a length, a multiple of sigma or, where it is allowed, "clear"."""
        alternatives = [
            quantity_pattern(self.dimension),
            f"^{_SIGMA.pattern}$",
            *([f"^{CLEAR}$"] if self.clear else []),
        ]
        default = {"default": CLEAR} if self.clear else {}
        return {"type": ["number", "string"], "pattern": "|".join(alternatives), **default}

    def __str__(self) -> str:
        clear = f', or "{CLEAR}"' if self.clear else ""
        return f'a length, a number in m or a string as "1 um", or in standard deviations, as "4 sigma"{clear}'


class Target(Section):
    """The largest separation at which loading reaches a contact fraction [1] or a pressure [Pa]."""

    contact_fraction: Annotated[float, Quantity(DIMENSIONLESS, above=0.0, at_most=1.0)] | None = None
    """Contact area over nominal area at which loading ends."""
    pressure: Annotated[float, Quantity("Pa", above=0.0)] | None = None
    """Force over nominal area at which loading ends."""

    @model_validator(mode="after")
    def _one_of_them(self) -> "Target":
        if (self.contact_fraction is None) == (self.pressure is None):
            raise RoughmdrError("takes either contact_fraction or pressure")
        return self

    @property
    def variable(self) -> str:
        """The variable that is to be reached."""
        return "pressure" if self.contact_fraction is None else "contact_fraction"

    @property
    def value(self) -> float:
        """The value that is to be reached, in SI."""
        return self.pressure or self.contact_fraction or 0.0


def end_in_words(end: Separation | Target | float, unit: str) -> str:
    """Return an end of a range with its unit."""
    if isinstance(end, Target):
        value = format_quantity(end.value, CURVE_VARIABLES[end.variable].units)
        return f"a {end.variable.replace('_', ' ')} of {value}"
    if isinstance(end, Separation):
        return f"{end.value:g} sigma" if end.in_sigma else format_quantity(end.value, unit)
    return format_quantity(end, unit)

"""The sections of source = "random", one for each shape, with a key for each parameter of the shape."""

from functools import cached_property
from typing import TYPE_CHECKING, Annotated, Any, Literal, TypeVar, Union

from pydantic import BeforeValidator, Field, ValidationInfo, create_model, field_validator

from roughmdr.ensemble.random.distribution import Distribution
from roughmdr.ensemble.random.distribution_reader import DistributionReader
from roughmdr.ensemble.random.section import Correlation, RandomAsperities, Second
from roughmdr.errors import RoughmdrError
from roughmdr.schema.quantities import EntryError, Quantity, Section
from roughmdr.schema.units import DIMENSIONLESS, quantity
from roughmdr.shapes import SHAPES, PowerSeries, Shape, SharedProfile, Tabulated

_Section = TypeVar("_Section", bound=Section)


def _read_terms(value: object) -> dict[str, float]:
    """Read the terms of a power series, { "exponent" = coefficient }."""
    if not isinstance(value, dict) or not value:
        raise RoughmdrError('must be a table of exponents and coefficients, as { "2" = 1e4, "4" = 1e14 }')
    terms = {}
    for exponent, coefficient in value.items():
        try:
            float(exponent)
        except ValueError:
            raise EntryError(exponent, coefficient, 'the exponent must be a number, as in { "2" = 1e4 }') from None
        try:
            terms[exponent] = quantity(coefficient, DIMENSIONLESS)
        except RoughmdrError as error:
            hint = '; an exponent with a point needs quotes, as "2.5"' if isinstance(coefficient, dict) else ""
            raise EntryError(exponent, coefficient, f"{error}{hint}") from None
    PowerSeries(terms)
    return terms


def _read_lengths(value: object) -> list[float]:
    """Read a list of lengths."""
    if not isinstance(value, list):
        raise RoughmdrError('must be a list of lengths, as [0, "1 um", "2 um"]')
    return [quantity(entry, "m") for entry in value]


class RandomPowerSeries(RandomAsperities):
    """Asperities with one power series as their common profile."""

    shape: Literal["power_series"]
    terms: Annotated[dict[str, float], BeforeValidator(_read_terms)]

    @cached_property
    def shared_profile(self) -> SharedProfile:
        """The series; ShapeError where it is not valid."""
        return PowerSeries({float(exponent): coefficient for exponent, coefficient in self.terms.items()})


class RandomTabulated(RandomAsperities):
    """Asperities with one measured profile."""

    shape: Literal["tabulated"]
    r: Annotated[list[float], BeforeValidator(_read_lengths)]
    f: Annotated[list[float], BeforeValidator(_read_lengths)]

    @field_validator("f")
    @classmethod
    def _is_a_profile(cls, value: list[float], info: ValidationInfo) -> list[float]:
        if "r" in info.data:
            Tabulated(info.data["r"], value)
        return value

    @cached_property
    def shared_profile(self) -> SharedProfile:
        """The table; ShapeError where it is not valid."""
        return Tabulated(self.r, self.f)


def _section(shape: type[Shape]) -> type[RandomAsperities]:
    """Return the section of one shape, with a key for each of its parameters."""
    required = set.intersection(*(set(names) for names in shape.parameter_sets))
    rank = Annotated[float, BeforeValidator(Quantity(DIMENSIONLESS, at_least=-1.0, at_most=1.0))]
    keys: dict[str, Any] = {}
    second_keys: dict[str, Any] = {}
    correlation_keys: dict[str, Any] = {}
    for name, unit in shape.units.items():
        entry = Annotated[Distribution, BeforeValidator(DistributionReader(unit, positive=True))]
        keys[name] = (entry, ...) if name in required else (entry | None, None)
        second_keys[name] = (entry | None, None)
        correlation_keys[name] = (rank | None, None)
    second = _published(create_model(f"Second{shape.__name__}", __base__=Second, **second_keys))
    correlation = _published(create_model(f"Correlation{shape.__name__}", __base__=Correlation, **correlation_keys))
    keys["shape"] = (Literal[shape.name], ...)
    keys["second"] = (second | None, None)
    keys["correlation"] = (correlation | None, None)
    return _published(create_model(f"Random{shape.__name__}", __base__=RandomAsperities, **keys))


def _published(section: type[_Section]) -> type[_Section]:
    """Put a section under its name into this module, where another process finds it."""
    section.__module__ = __name__
    globals()[section.__name__] = section
    return section


if TYPE_CHECKING:
    AnyRandomAsperities = RandomAsperities
else:
    AnyRandomAsperities = Annotated[
        Union[
            RandomPowerSeries,
            RandomTabulated,
            *(_section(shape) for shape in SHAPES.values() if not shape.shared),
        ],
        Field(discriminator="shape"),
    ]

"""The sections with source = "random", one for each shape, with its parameters as keys."""

from functools import cached_property
from typing import TYPE_CHECKING, Annotated, Any, Literal, TypeVar, Union

from pydantic import BeforeValidator, Field, ValidationInfo, WithJsonSchema, create_model, field_validator

from roughmdr.ensemble.random.distribution import Distribution
from roughmdr.ensemble.random.distribution_reader import DistributionReader
from roughmdr.ensemble.random.section import Correlation, RandomAsperities, Second
from roughmdr.errors import RoughmdrError
from roughmdr.schema.json_schema import JsonSchema
from roughmdr.schema.quantities import EntryError, Quantity
from roughmdr.schema.section import Section
from roughmdr.schema.units import DIMENSIONLESS, quantity
from roughmdr.shapes import SCENE_SHAPES, PowerSeries, Shape, SharedProfile, Tabulated

_Section = TypeVar("_Section", bound=Section)
_Rank = Annotated[float, Quantity(DIMENSIONLESS, at_least=-1.0, at_most=1.0)]
PARAMETERS = {
    "radius": ("Radius: of curvature at the tip, of the sphere, or of the flat punch", ""),
    "slope": ("Slope of the flank, the tangent of its angle to the plane", "0.1"),
    "exponent": ("Exponent n of the profile; above 1/2 with adhesion", "2.0"),
    "coefficient": ("Coefficient c of the profile c r^n, in m^(1-n)", ""),
    "width": ("Radius at which the profile has its rise", ""),
    "rise": ("Height of the profile at its width", ""),
    "flat_radius": ("Radius of the flat end", '"1 um"'),
    "blend_radius": ("Radius at which the rounded tip meets the flank", '"1 um"'),
    "cap_radius": ("Radius of curvature of the cap; not below radius", '"100 um"'),
    "edge_radius": ("Radius of curvature of the edge", '"1 um"'),
}
"""The meaning of each parameter of the shapes, and an example for messages on what is missing."""
TERMS: JsonSchema = {
    "type": "object",
    "minProperties": 1,
    "propertyNames": {"pattern": r"^\s*[-+]?[\d._]+(?:[eE][-+]?\d+)?\s*$"},
    "additionalProperties": Quantity(DIMENSIONLESS).json_schema(),
}
_TERMS = '{ "2" = 1e4, "4" = 1e14 }'
LENGTHS: JsonSchema = {"type": "array", "items": Quantity("m").json_schema()}


def read_terms(value: object) -> dict[str, float]:
    """Read the terms of a power series, { "exponent" = coefficient }."""
    if not isinstance(value, dict) or not value:
        raise RoughmdrError(f"must be a table of exponents and coefficients, as {_TERMS}")
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


def read_lengths(value: object) -> list[float]:
    """Read a list of lengths."""
    if not isinstance(value, list):
        raise RoughmdrError('must be a list of lengths, as [0, "1 um", "2 um"]')
    return [quantity(entry, "m") for entry in value]


_Lengths = Annotated[list[float], BeforeValidator(read_lengths), WithJsonSchema(LENGTHS)]


class RandomPowerSeries(RandomAsperities):
    """Asperities with one power series as their common profile."""

    shape: Literal["power_series"]
    terms: Annotated[dict[str, float], BeforeValidator(read_terms), WithJsonSchema(TERMS), Field(examples=[_TERMS])]
    """Terms of the power series, { "exponent" = coefficient }."""

    @cached_property
    def shared_profile(self) -> SharedProfile:
        """The series; ShapeError where it is not valid."""
        return PowerSeries({float(exponent): coefficient for exponent, coefficient in self.terms.items()})


class RandomTabulated(RandomAsperities):
    """Asperities with one measured profile."""

    shape: Literal["tabulated"]
    r: Annotated[_Lengths, Field(examples=['[0, "1 um", "2 um"]'])]
    """Radii of the tabulated profile, rising from 0."""
    f: Annotated[_Lengths, Field(examples=['[0, "10 nm", "50 nm"]'])]
    """Heights of the tabulated profile at r, from 0."""

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


def _published(name: str, base: type[_Section], keys: dict[str, Any]) -> type[_Section]:
    """Return a section with further keys, put under its name into this module, where another process finds it."""
    section = create_model(name, __base__=base, __module__=__name__, **keys)
    globals()[name] = section
    return section


def _section(shape: type[Shape]) -> type[RandomAsperities]:
    """Return the section of one shape, with a key for each of its parameters."""
    required = set.intersection(*map(set, shape.parameter_sets))
    readers = {name: DistributionReader(unit, positive=True) for name, unit in shape.units.items()}

    def keys(annotations: dict[str, Any], of: str) -> dict[str, Any]:
        return {name: (kind, Field(None, description=PARAMETERS[name][0] + of)) for name, kind in annotations.items()}

    optional = {name: Annotated[Distribution, reader] | None for name, reader in readers.items()}
    second = _published(f"Second{shape.__name__}", Second, keys(optional, ": the second population"))
    ranks = keys(dict.fromkeys(readers, _Rank | None), ": its correlation with the height")
    correlation = _published(f"Correlation{shape.__name__}", Correlation, ranks)
    own = keys(optional, "")
    for name in required:
        meaning, example = PARAMETERS[name]
        own[name] = Annotated[Distribution, readers[name]], Field(description=meaning, examples=[example])
    own |= {"shape": (Literal[shape.name], ...), "second": (second | None, None)}
    return _published(f"Random{shape.__name__}", RandomAsperities, own | {"correlation": (correlation | None, None)})


if TYPE_CHECKING:
    AnyRandomAsperities = RandomAsperities
else:
    _sections = [_section(shape) for shape in SCENE_SHAPES.values() if not shape.shared]
    AnyRandomAsperities = Annotated[Union[RandomPowerSeries, RandomTabulated, *_sections], Field(discriminator="shape")]

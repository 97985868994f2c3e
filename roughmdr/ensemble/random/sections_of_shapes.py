"""The sections with source = "random", one for each shape, with its parameters as keys."""

from functools import cached_property
from typing import TYPE_CHECKING, Annotated, Any, Literal, TypeVar, Union

from pydantic import BeforeValidator, Field, ValidationInfo, WithJsonSchema, create_model, field_validator

from roughmdr.ensemble.random.distribution import Distribution
from roughmdr.ensemble.random.distribution_reader import DistributionReader
from roughmdr.ensemble.random.profile_readers import LENGTHS, TERMS, read_lengths, read_terms
from roughmdr.ensemble.random.section import Correlation, RandomAsperities, Second
from roughmdr.schema.quantities import Quantity, Section
from roughmdr.schema.units import DIMENSIONLESS
from roughmdr.shapes import SCENE_SHAPES, PowerSeries, Shape, SharedProfile, Tabulated

_Section = TypeVar("_Section", bound=Section)
_Rank = Annotated[float, BeforeValidator(Quantity(DIMENSIONLESS, at_least=-1.0, at_most=1.0))]


class RandomPowerSeries(RandomAsperities):
    """Asperities with one power series as their common profile."""

    shape: Literal["power_series"]
    terms: Annotated[dict[str, float], BeforeValidator(read_terms), WithJsonSchema(TERMS)]

    @cached_property
    def shared_profile(self) -> SharedProfile:
        """The series; ShapeError where it is not valid."""
        return PowerSeries({float(exponent): coefficient for exponent, coefficient in self.terms.items()})


class RandomTabulated(RandomAsperities):
    """Asperities with one measured profile."""

    shape: Literal["tabulated"]
    r: Annotated[list[float], BeforeValidator(read_lengths), WithJsonSchema(LENGTHS)]
    f: Annotated[list[float], BeforeValidator(read_lengths), WithJsonSchema(LENGTHS)]

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
    readers = {name: BeforeValidator(DistributionReader(unit, positive=True)) for name, unit in shape.units.items()}
    optional: dict[str, Any] = {
        name: (Annotated[Distribution, reader] | None, None) for name, reader in readers.items()
    }
    keys = optional | {name: (Annotated[Distribution, readers[name]], ...) for name in required}
    second = _published(f"Second{shape.__name__}", Second, optional)
    ranks = dict.fromkeys(shape.units, (_Rank | None, None))
    correlation = _published(f"Correlation{shape.__name__}", Correlation, ranks)
    keys |= {"shape": (Literal[shape.name], ...), "second": (second | None, None)}
    keys |= {"correlation": (correlation | None, None)}
    return _published(f"Random{shape.__name__}", RandomAsperities, keys)


if TYPE_CHECKING:
    AnyRandomAsperities = RandomAsperities
else:
    _sections = [_section(shape) for shape in SCENE_SHAPES.values() if not shape.shared]
    AnyRandomAsperities = Annotated[Union[RandomPowerSeries, RandomTabulated, *_sections], Field(discriminator="shape")]

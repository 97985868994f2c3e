"""source = "random": heights and shape parameters drawn from distributions, independent of each other."""

import math
from functools import cached_property
from typing import TYPE_CHECKING, Annotated, Any, Literal, Union

import numpy as np
from pydantic import BeforeValidator, Field, ValidationInfo, create_model, field_validator, model_validator

from roughmdr.ensemble.distributions import Distribution
from roughmdr.ensemble.drawn import Drawn
from roughmdr.ensemble.draws import HEIGHT, PARAMETER, independent, spread
from roughmdr.ensemble.ensemble import Ensemble
from roughmdr.ensemble.patch import PatchSource
from roughmdr.errors import RoughmdrError
from roughmdr.quantities import EntryError, WholeNumber
from roughmdr.shapes import SHAPES, Common, PowerSeries, Shape, Tabulated
from roughmdr.units import DIMENSIONLESS, quantity


class RandomAsperities(PatchSource):
    """[asperities] with source = "random": ``count`` asperities on a square of side ``patch``."""

    source: Literal["random"]
    shape: str
    count: Annotated[int, BeforeValidator(WholeNumber(1, 1_000_000_000))]
    height: Annotated[Distribution, BeforeValidator(Drawn("m", mean=0.0))]

    @model_validator(mode="after")
    def _parameters_describe_the_shape(self) -> "RandomAsperities":
        if self.fixed is None:
            SHAPES[self.shape].spelling(set(self.distributions))
        return self

    @model_validator(mode="after")
    def _parameters_go_together(self) -> "RandomAsperities":
        for name, floor, reason in SHAPES[self.shape].not_below:
            entry, least = self.distributions[name], self.distributions[floor]
            if entry.least < least.greatest:
                raise EntryError(
                    name,
                    f"from {entry.least:.3g}",
                    f"must not be below {floor}, which can be as high as {least.greatest:.3g}: {reason}",
                )
        return self

    @cached_property
    def fixed(self) -> Common | None:
        """The one profile of all asperities, where the shape's parameters are no plain numbers."""
        return None

    @property
    def least_exponent(self) -> float:
        """The least exponent among the tips."""
        if self.fixed is not None:
            return self.fixed.least_exponent(np.asarray(self.fixed.stretched()[2])[None])
        exponent = self.distributions.get("exponent")
        return math.inf if exponent is None else exponent.least

    @property
    def distributions(self) -> dict[str, Distribution]:
        """The distribution of each shape parameter that was given."""
        if self.fixed is not None:
            return {}
        entries = {name: getattr(self, name) for name in SHAPES[self.shape].units}
        return {name: entry for name, entry in entries.items() if entry is not None}

    def sampled(self, count: int) -> "RandomAsperities":
        """The same with at most ``count`` asperities."""
        return self.model_copy(update={"count": min(count, self.count)})

    @property
    def expected_count(self) -> float:
        """How many asperities there are."""
        return float(self.count)

    @property
    def sigma(self) -> float:
        """Standard deviation of the heights [m]."""
        return self.height.std

    def ensemble(self, seed: int, realization: int, *, stratified: bool = False, placed: bool = False) -> Ensemble:
        """The asperities of one realization."""
        order = list(SHAPES[self.shape].units)
        streams = {name: PARAMETER + order.index(name) for name in self.distributions}
        varied = tuple(streams[name] for name, entry in self.distributions.items() if entry.constant is None)
        draws = spread(seed, realization, (HEIGHT, *varied)) if stratified else independent(seed, realization)
        height = self.height.quantile(draws(HEIGHT, self.count))
        parameters = {
            name: entry.quantile(draws(streams[name], self.count)) for name, entry in self.distributions.items()
        }
        attrs: dict[str, float | int | str] = {"patch": self.patch, "seed": seed, "realization": realization}
        return Ensemble.sorted(self.shape, height, parameters, self.patch * self.patch, attrs=attrs, fixed=self.fixed)


def _terms(value: object) -> dict[str, float]:
    """Reads the terms of a power series, { "exponent" = coefficient }."""
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


def _lengths(value: object) -> list[float]:
    """Reads a list of lengths."""
    if not isinstance(value, list):
        raise RoughmdrError('must be a list of lengths, as [0, "1 um", "2 um"]')
    return [quantity(entry, "m") for entry in value]


class RandomPowerSeries(RandomAsperities):
    """Asperities that are all the same power series."""

    shape: Literal["power_series"]
    terms: Annotated[dict[str, float], BeforeValidator(_terms)]

    @cached_property
    def fixed(self) -> Common:
        """The series; ShapeError where it is none."""
        return PowerSeries({float(exponent): coefficient for exponent, coefficient in self.terms.items()})


class RandomTabulated(RandomAsperities):
    """Asperities that all have the same measured profile."""

    shape: Literal["tabulated"]
    r: Annotated[list[float], BeforeValidator(_lengths)]
    f: Annotated[list[float], BeforeValidator(_lengths)]

    @field_validator("f")
    @classmethod
    def _is_a_profile(cls, value: list[float], info: ValidationInfo) -> list[float]:
        if "r" in info.data:
            Tabulated(info.data["r"], value)
        return value

    @cached_property
    def fixed(self) -> Common:
        """The table; ShapeError where it is none."""
        return Tabulated(self.r, self.f)


def _section(shape: type[Shape]) -> type[RandomAsperities]:
    """The section of one shape, with a key for each of its parameters."""
    always = set.intersection(*(set(spelling) for spelling in shape.spellings))
    keys: dict[str, Any] = {}
    for name, unit in shape.units.items():
        kind = Annotated[Distribution, BeforeValidator(Drawn(unit, positive=True))]
        keys[name] = (kind, ...) if name in always else (kind | None, None)
    keys["shape"] = (Literal[shape.name], ...)
    return create_model(f"Random{shape.__name__}", __base__=RandomAsperities, **keys)


if TYPE_CHECKING:
    AnyRandomAsperities = RandomAsperities
else:
    AnyRandomAsperities = Annotated[
        Union[
            RandomPowerSeries,
            RandomTabulated,
            *(_section(shape) for shape in SHAPES.values() if not issubclass(shape, Common)),
        ],
        Field(discriminator="shape"),
    ]

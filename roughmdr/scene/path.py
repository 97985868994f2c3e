"""[path]: the separations of the rigid flat."""

import math
import re
from typing import Annotated, NamedTuple

import numpy as np
from pydantic import BeforeValidator, Discriminator, Field, StrictBool, Tag

from roughmdr.errors import RoughmdrError, SceneError
from roughmdr.numerics.arguments import Floats
from roughmdr.schema.quantities import Section, WholeNumber
from roughmdr.schema.units import DIMENSIONLESS, quantity

_SIGMA = re.compile(r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*sigma\s*")


class Separation(NamedTuple):
    """A separation in metres, or in standard deviations of the heights."""

    value: float
    in_sigma: bool


class SeparationReader:
    """Reads a separation."""

    dimension = "m"

    def __call__(self, value: object) -> Separation:
        """Return the separation, in metres or in sigma."""
        if isinstance(value, str) and (match := _SIGMA.fullmatch(value)):
            return Separation(quantity(match[1], DIMENSIONLESS), in_sigma=True)
        try:
            return Separation(quantity(value, self.dimension), in_sigma=False)
        except RoughmdrError as error:
            raise RoughmdrError(f'{error}, or in standard deviations of the heights, like "4 sigma"') from None


_Separation = Annotated[Separation, BeforeValidator(SeparationReader())]


class Range(Section):
    """``steps`` separations from ``start`` to ``stop``, both included."""

    start: _Separation
    stop: _Separation
    steps: Annotated[int, BeforeValidator(WholeNumber(2, 10_000_000))]


class FlatPath(Section):
    """[path]: a range or a list of separations; ``unload`` appends the same separations in reverse."""

    separation: Annotated[
        Annotated[Range, Tag("range")] | Annotated[list[_Separation], Field(min_length=1), Tag("list")],
        Discriminator(
            lambda value: {dict: "range", Range: "range", list: "list"}.get(type(value)),
            custom_error_type="neither",
            custom_error_message="must be a table with start, stop and steps, or a list",
        ),
    ]
    unload: StrictBool = False

    @property
    def _given(self) -> list[Separation]:
        path = self.separation
        return [path.start, path.stop] if isinstance(path, Range) else path

    @property
    def uses_sigma(self) -> bool:
        """Whether a separation is given in standard deviations of the heights."""
        return any(separation.in_sigma for separation in self._given)

    def sigma_fault(self, sigma: float) -> str:
        """Return why separations cannot be given in sigma [m]; empty if they can, or are not."""
        if not self.uses_sigma or 0.0 < sigma < np.inf:
            return ""
        return f"cannot be given in sigma: the heights' standard deviation is {sigma:g} m"

    def separations(self, sigma: float) -> Floats:
        """Return the separations [m] without the appended unloading; sigma [m] is the heights' standard deviation.

        SceneError if the path is given in sigma and there is none, or if it is not finite.
        """
        if fault := self.sigma_fault(sigma):
            raise SceneError(f"path.separation: {fault}")
        path = np.array([each.value * sigma if each.in_sigma else each.value for each in self._given])
        if isinstance(self.separation, Range):
            start, stop = path.tolist()
            finite = math.isfinite(stop - start)
            path = np.linspace(start, stop, self.separation.steps) if finite else np.array([np.inf])
        if not np.isfinite(path).all():
            raise SceneError("path.separation: reaches beyond the largest float")
        return path

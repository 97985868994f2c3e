"""What every axisymmetric profile offers: f, g and G over arrays, and its reduction to width, rise and form."""

from abc import ABC, abstractmethod
from dataclasses import fields
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from roughmdr.arguments import Floats
from roughmdr.errors import OutOfRange, ShapeError


class Shape(ABC):
    """An axisymmetric profile with its tip at f(0) = 0, pointing at the flat. Its parameters are floats in SI.

    A shape is a dimensionless form, stretched sideways by a width and upwards by a rise: that triple is all that
    the kernels see.
    """

    name: ClassVar[str]
    units: ClassVar[dict[str, str]]
    """Unit of each parameter, in the order of the arguments."""
    spellings: ClassVar[tuple[tuple[str, ...], ...]]
    """The sets of parameters that describe the shape, any one of them whole."""

    @abstractmethod
    def f(self, r: ArrayLike) -> Floats:
        """Profile at radius r >= 0 [m], as [m]."""

    @abstractmethod
    def g(self, x: ArrayLike) -> Floats:
        """MDR profile at x >= 0 [m], as [m]: g = |x| ∫_0^x f'(r)/sqrt(x^2 - r^2) dr (H 17)."""

    @abstractmethod
    def G(self, a: ArrayLike) -> Floats:
        """∫_0^a g dx at a >= 0 [m], as [m2]."""

    @classmethod
    @abstractmethod
    def stretch(cls, parameters: dict[str, Floats]) -> tuple[Floats, Floats, Floats]:
        """Width [m], rise [m] and form [1] of asperities whose parameters come as equally long arrays."""

    @classmethod
    def spelling(cls, given: set[str]) -> tuple[str, ...]:
        """The set of parameters that ``given`` names; ShapeError where it names none, or more than one."""
        for spelling in cls.spellings:
            if given == set(spelling):
                return spelling
        allowed = ", or ".join(" and ".join(spelling) for spelling in cls.spellings)
        got = " and ".join(name for name in cls.units if name in given) or "nothing"
        raise ShapeError(f"{cls.name}: got {got}; it takes {allowed}")

    @property
    def parameters(self) -> dict[str, float]:
        """The parameters that were given, by name."""
        values = {field.name: getattr(self, field.name) for field in fields(self)}  # type: ignore[arg-type]
        return {name: value for name, value in values.items() if value is not None}

    def stretched(self) -> tuple[float, float, float]:
        """Width [m], rise [m] and form [1] of this one."""
        columns = self.stretch({name: np.array([value], dtype=np.float64) for name, value in self.parameters.items()})
        width, rise, form = (float(column[0]) for column in columns)
        return width, rise, form

    def __post_init__(self) -> None:
        parameters = self.parameters
        type(self).spelling(set(parameters))
        for name, value in parameters.items():
            if isinstance(value, bool) or np.ndim(value) != 0:
                raise ShapeError(f"{type(self).name}: {name} is {value!r}; it must be one number")
            check_positive(type(self).name, name, value)


def radii(name: str, values: ArrayLike) -> Floats:
    """``values`` as floats; OutOfRange unless all are finite and at least 0."""
    numbers = np.asarray(values, dtype=np.float64)
    wrong = ~(np.isfinite(numbers) & (numbers >= 0.0))
    if wrong.any():
        raise OutOfRange(f"{name} is {numbers[wrong].flat[0]:g} m; it must be finite and at least 0")
    return numbers


def check_positive(owner: str, name: str, values: ArrayLike) -> None:
    """ShapeError, naming the first of ``values`` that is not a finite number above 0."""
    try:
        numbers = np.atleast_1d(np.asarray(values, dtype=np.float64))
    except (TypeError, ValueError):
        raise ShapeError(f"{owner}: {name} is {values!r}; it must be a number above 0") from None
    bad = ~(np.isfinite(numbers) & (numbers > 0.0))
    if bad.any():
        where = "" if numbers.size == 1 else f" at asperity {int(np.argmax(bad))}"
        raise ShapeError(f"{owner}: {name} is {numbers[bad][0]:g}{where}; it must be a finite number above 0")

"""The interface of every axisymmetric profile: f, g and G over arrays, and its reduction to width, rise and params."""

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import fields
from functools import cache
from inspect import signature
from typing import Any, ClassVar, Self, cast

import numpy as np
from numpy.typing import ArrayLike

from roughmdr.errors import OutOfRange, RoughmdrError, ShapeError
from roughmdr.numerics import vector_math
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.rebind import rebuilt
from roughmdr.schema.arguments import floats_in_si
from roughmdr.schema.keywords import check_keywords
from roughmdr.schema.units import quantity
from roughmdr.schema.wording import short_repr
from roughmdr.shapes.profile import Profile, zero


class Shape(ABC):
    """An axisymmetric profile with its tip at f(0) = 0, pointing at the flat. Its parameters are floats in SI.

    A parameter may be given as a string with a unit, such as "10 um". The kernels see a shape as a dimensionless
    profile, scaled sideways by a width and upwards by a rise.
    """

    name: ClassVar[str]
    units: ClassVar[dict[str, str]]  # the unit of each parameter, in the order of the arguments
    parameter_sets: ClassVar[tuple[tuple[str, ...], ...]]
    """The sets of parameters that each describe the shape; by default all parameters together."""
    not_below: ClassVar[tuple[tuple[str, str, str], ...]] = ()
    """(parameter, lower bound, reason) for each parameter that must not be below another one."""
    pinned: ClassVar[bool] = False  # the contact radius is the shape's own under every load, as that of a flat punch
    uses_profile: ClassVar[bool] = False
    """Whether its kernels are made from its ``Profile`` and describe a contact by the parameter t of that."""
    similar: ClassVar[bool] = False  # width and rise say all of a shape
    shared: ClassVar[bool] = False  # all asperities of an ensemble have one profile
    flat: ClassVar[bool] = False  # the tip is flat to one width
    corner: ClassVar[bool] = False  # g' jumps to infinity, at the edge of a flat or of a blunter tip
    body_radius: ClassVar[tuple[str, ...]] = ()
    """The parameters whose sum is the radius where the body that the profile stands for ends."""
    papers: ClassVar[Mapping[str, str]] = {}
    """Subject of each paper, "contact" or "adhesion", by its key in report/papers.bib."""

    def __new__(cls, *_: Any, **given: Any) -> Self:
        """Raise TypeError where a keyword is no parameter of the shape."""
        if given:
            check_keywords(cls.__name__, given, _arguments_of(cls))
        return super().__new__(cls)

    def __init_subclass__(cls, **kwargs: Any) -> None:
        super().__init_subclass__(**kwargs)
        if "units" in vars(cls) and "parameter_sets" not in vars(cls):
            cls.parameter_sets = (tuple(cls.units),)

    @abstractmethod
    def f(self, r: ArrayLike) -> Floats:
        """Return the profile [m] at radii r >= 0 [m], which may be strings with a unit, such as "1 um"."""

    def df(self, r: ArrayLike) -> Floats:
        """Return f'(r) [1] at radii r >= 0 [m]."""
        with np.errstate(all="ignore"):
            return self.slopes(self.nondimensional(), check_radii("r", r))

    @abstractmethod
    def g(self, x: ArrayLike) -> Floats:
        """Return the MDR profile [m] at x >= 0 [m]: g = |x| ∫_0^x f'(r)/sqrt(x^2 - r^2) dr (H 17)."""

    @abstractmethod
    def G(self, a: ArrayLike) -> Floats:
        """Return ∫_0^a g dx [m2] at a >= 0 [m]."""

    @classmethod
    @abstractmethod
    def slopes(cls, columns: tuple[Any, Any, Any], r: Floats) -> Floats:
        """Return f'(r) [1] at radii [m] of one asperity, or of one each, whose width, rise and params are given."""

    @classmethod
    @abstractmethod
    def nondimensionalise(cls, parameters: dict[str, Floats]) -> tuple[Floats, Floats, Floats]:
        """Return width [m], rise [m] and params [1] of asperities whose parameters are equally long arrays."""

    @property
    def limit(self) -> float:
        """The radius [m] beyond which there is no profile; inf where it goes on for ever."""
        return math.inf

    @property
    def breakpoints(self) -> Floats:
        """The radii [m] at which the profile is not smooth, besides where it ends."""
        return np.zeros(0)

    @property
    def end(self) -> float:
        """The radius [m] where the profile, or the body it stands for, ends; inf where it never does."""
        return float(self.ends({name: np.array(value) for name, value in self.parameters.items()}))

    @classmethod
    def ends(cls, parameters: dict[str, Floats]) -> Floats:
        """Return ``end`` [m] of asperities."""
        lengths = [parameters[name] for name in cls.body_radius]
        return np.asarray(sum(lengths[1:], lengths[0]) if lengths else math.inf)

    @classmethod
    def branched(cls) -> bool:
        """Return whether there can be more than one stable branch with adhesion."""
        return False

    @classmethod
    def parameter_set(cls, given: set[str]) -> tuple[str, ...]:
        """Return the set of parameters that ``given`` names; ShapeError where it names none, or more than one."""
        for names in cls.parameter_sets:
            if given == set(names):
                return names
        allowed = ", or ".join(" and ".join(names) for names in cls.parameter_sets)
        got = " and ".join(name for name in cls.units if name in given) or "nothing"
        raise ShapeError(f"{cls.name}: got {got}; it takes {allowed}")

    @classmethod
    def least_exponent(cls, params: Floats) -> float:
        """Return the least n among tips f ~ r^n of asperities; inf where the exponent is no parameter."""
        return math.inf

    @classmethod
    def example(cls) -> dict[str, Any]:
        """Return parameters of an example of the shape."""
        return dict.fromkeys(cls.parameter_sets[0], 1.0)

    @property
    def parameters(self) -> dict[str, float]:
        """The parameters that were given, by name."""
        values = {field.name: getattr(self, field.name) for field in fields(self)}  # type: ignore[arg-type]
        return {name: value for name, value in values.items() if value is not None}

    def nondimensional(self) -> tuple[float, float, Any]:
        """Return width [m], rise [m] and params [1] of this asperity."""
        parameters = {name: np.array([value], dtype=np.float64) for name, value in self.parameters.items()}
        with np.errstate(all="ignore"):  # what no float can hold is refused where a contact is looked for
            columns = self.nondimensionalise(parameters)
        width, rise, params = (float(column[0]) for column in columns)
        return width, rise, params

    def __post_init__(self) -> None:
        parameters = self.parameters
        self.parameter_set(set(parameters))
        for name, value in parameters.items():
            if isinstance(value, str) or hasattr(value, "magnitude"):
                try:
                    parameters[name] = quantity(value, self.units[name])
                except RoughmdrError as error:
                    raise ShapeError(f"{self.name}: {name} is {short_repr(value)}: {error}") from None
            check_one(self.name, name, parameters[name])
        self.check(parameters)
        for name, value in parameters.items():
            object.__setattr__(self, name, float(value))

    @classmethod
    def check(cls, parameters: Mapping[str, ArrayLike]) -> None:
        """Raise ShapeError where a parameter, a number or an array over asperities, is out of its range."""
        for name, values in parameters.items():
            check_positive(cls.name, name, values)
        for name, bound, reason in cls.not_below:
            values, lowest = np.atleast_1d(parameters[name]), np.atleast_1d(parameters[bound])
            below = values < lowest
            if below.any():
                where = "" if below.size == 1 else f" at asperity {int(np.argmax(below))}"
                limit = f"it must be at least {bound}, {lowest[below][0]:g}: {reason}"
                raise ShapeError(f"{cls.name}: {name} is {values[below][0]:g}{where}; {limit}")


@cache
def _arguments_of(kind: type[Shape]) -> tuple[str, ...]:
    """Return the names of the arguments of a shape."""
    return tuple(signature(kind.__init__).parameters)[1:]


@cache
def _of_mpmath(function: Callable[..., Any]) -> Callable[..., Any]:
    """Return a function of a profile for numbers of mpmath, without the series that floats need."""
    from mpmath import mp

    if function.__module__ == vector_math.__name__ and hasattr(mp, function.__name__):
        return cast(Callable[..., Any], getattr(mp, function.__name__))
    return rebuilt(function, {"math": mp, "SERIES_UP_TO": -1.0}, _of_mpmath)


class ProfileShape(Shape):
    """A shape given by the functions of its ``Profile``, compiled when they are first used."""

    profile: ClassVar[Profile]
    uses_profile = True

    def __init_subclass__(cls, **kwargs: Any) -> None:
        super().__init_subclass__(**kwargs)
        if "profile" in vars(cls):
            cls.flat, cls.corner = cls.profile.flat, cls.profile.corner

    @property
    def limit(self) -> float:
        return math.inf if math.isinf(self.profile.end) else self.profile.end * self.nondimensional()[0]

    @property
    def breakpoints(self) -> Floats:
        width, _, params = self.nondimensional()
        radii = [self.profile.breakpoint(index, params)[0] for index in range(self.profile.breakpoint_count(params))]
        return width * np.array(radii, dtype=np.float64)

    @classmethod
    def branched(cls) -> bool:
        return cls.profile.softening_count is not zero

    def precisely(self, t: float) -> tuple[Any, Any, Any]:
        """Return a [m], g [m] and a g - G [m2] at t with 40 digits."""
        from mpmath import mp

        lost = max(0.0, -math.log10(t)) if t > 0.0 else 0.0  # of the digits, in each power of t that cancels
        with mp.workdps(40 + int(4.0 * lost)):
            exact = {name: np.array([mp.mpf(value)]) for name, value in self.parameters.items()}
            width, rise, params = (column[0] for column in self.nondimensionalise(exact))
            a, _, g, _ = _of_mpmath(self.profile.mdr_profile)(mp.mpf(t), [params])
            return width * a, rise * g, width * rise * _of_mpmath(self.profile.reduced_load)(mp.mpf(t), [params])

    def f(self, r: ArrayLike) -> Floats:
        from roughmdr.shapes import evaluate  # it alone needs the compiler

        return evaluate.f_and_slopes(self.profile, self.name, self.nondimensional(), check_radii("r", r, self.limit))[0]

    @classmethod
    def slopes(cls, columns: tuple[Any, Any, Any], r: Floats) -> Floats:
        from roughmdr.shapes import evaluate

        return evaluate.f_and_slopes(cls.profile, cls.name, columns, r)[1]

    def g(self, x: ArrayLike) -> Floats:
        from roughmdr.shapes import evaluate

        return evaluate.g(self.profile, self.name, self.nondimensional(), check_radii("x", x))

    def G(self, a: ArrayLike) -> Floats:
        from roughmdr.shapes import evaluate

        return evaluate.G(self.profile, self.name, self.nondimensional(), check_radii("a", a))


def check_radii(name: str, values: ArrayLike, limit: float = math.inf) -> Floats:
    """Return ``values``, numbers or strings with units, in metres; OutOfRange unless all are from 0 to ``limit``."""
    numbers = floats_in_si(name, values, "m", "numbers, finite and at least 0")
    wrong = ~(np.isfinite(numbers) & (numbers >= 0.0) & (numbers <= limit))
    if wrong.any():
        above = "" if math.isinf(limit) else f" and at most {limit:g} m"
        raise OutOfRange(f"{name} is {numbers[wrong].flat[0]:g} m; it must be finite and at least 0{above}")
    return numbers


def check_one(owner: str, name: str, value: object) -> None:
    """Raise ShapeError unless ``value`` is a single thing that can be a number."""
    if isinstance(value, bool | str | bytes) or np.ndim(value) != 0:  # type: ignore[arg-type]
        raise ShapeError(f"{owner}: {name} is {value!r}; it must be one number")


def check_positive(owner: str, name: str, values: ArrayLike) -> None:
    """Raise ShapeError, naming the first of ``values`` that is not a finite number above 0."""
    try:
        numbers = np.atleast_1d(np.asarray(values, dtype=np.float64))
    except (TypeError, ValueError, OverflowError):
        raise ShapeError(f"{owner}: {name} is {values!r}; it must be a finite number above 0") from None
    bad = ~(np.isfinite(numbers) & (numbers > 0.0))
    if bad.any():
        where = "" if numbers.size == 1 else f" at asperity {int(np.argmax(bad))}"
        raise ShapeError(f"{owner}: {name} is {numbers[bad][0]:g}{where}; it must be a finite number above 0")

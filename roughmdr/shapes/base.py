"""What every axisymmetric profile offers: f, g and G over arrays, and its reduction to width, rise and form."""

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import fields
from typing import Any, ClassVar, cast

import numpy as np
from numpy.typing import ArrayLike

from roughmdr.errors import OutOfRange, RoughmdrError, ShapeError
from roughmdr.numerics import vector_math
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.rebind import rebuilt
from roughmdr.schema.units import quantity
from roughmdr.schema.wording import shown
from roughmdr.shapes.profile import Profile, never_softens


class Shape(ABC):
    """An axisymmetric profile with its tip at f(0) = 0, pointing at the flat. Its parameters are floats in SI.

    A parameter may be given as a string with a unit, such as "10 um".

    A shape is a dimensionless form, stretched sideways by a width and upwards by a rise: that triple is all that
    the kernels see.
    """

    name: ClassVar[str]
    units: ClassVar[dict[str, str]]
    """Unit of each parameter, in the order of the arguments."""
    spellings: ClassVar[tuple[tuple[str, ...], ...]]
    """The sets of parameters that describe the shape, any one of them whole."""
    not_below: ClassVar[tuple[tuple[str, str, str], ...]] = ()
    """Pairs of parameters of which the first must not be below the second, and why."""
    pinned: ClassVar[bool] = False
    """Whether the contact radius is the shape's own under every load, as that of a flat punch is."""
    uses_profile: ClassVar[bool] = False
    """Whether its kernels are made from its ``Profile`` and describe a contact by the parameter t of that."""
    flat: ClassVar[bool] = False
    """Whether the tip is flat to one width."""

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
    def slopes(cls, parameters: dict[str, Floats], r: Floats) -> Floats:
        """f'(r) [1] of asperities at one radius r [m] each."""

    def df(self, r: ArrayLike) -> Floats:
        """f'(r) [1] at radius r >= 0 [m]."""
        r = radii("r", r)
        with np.errstate(all="ignore"):
            return self.slopes({name: np.full_like(r, value) for name, value in self.parameters.items()}, r)

    @property
    def end(self) -> float:
        """The radius [m] where the profile, or the body it stands for, ends; inf where it never does."""
        return float(self.ends({name: np.array([value]) for name, value in self.parameters.items()})[0])

    @classmethod
    def ends(cls, parameters: dict[str, Floats]) -> Floats:
        """The radius [m] where the profile, or the body it stands for, ends; inf where it never does."""
        return np.full(np.shape(next(iter(parameters.values()))), np.inf)

    @property
    def limit(self) -> float:
        """The radius [m] beyond which there is no profile; inf where it goes on for ever."""
        return math.inf

    @classmethod
    @abstractmethod
    def nondimensionalise(cls, parameters: dict[str, Floats]) -> tuple[Floats, Floats, Floats]:
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

    @classmethod
    def least_exponent(cls, params: Floats) -> float:
        """The least n among the tips f ~ r^n of asperities, from the third column of ``nondimensionalise``."""
        return math.inf

    @classmethod
    def example(cls) -> dict[str, Any]:
        """The parameters of any one of them."""
        return dict.fromkeys(cls.spellings[0], 1.0)

    @property
    def parameters(self) -> dict[str, float]:
        """The parameters that were given, by name."""
        values = {field.name: getattr(self, field.name) for field in fields(self)}  # type: ignore[arg-type]
        return {name: value for name, value in values.items() if value is not None}

    def nondimensional(self) -> tuple[float, float, Any]:
        """Width [m], rise [m] and form [1] of this one."""
        parameters = {name: np.array([value], dtype=np.float64) for name, value in self.parameters.items()}
        with np.errstate(all="ignore"):  # what no float can hold is refused where a contact is looked for
            columns = self.nondimensionalise(parameters)
        width, rise, params = (float(column[0]) for column in columns)
        return width, rise, params

    def __post_init__(self) -> None:
        parameters = self.parameters
        type(self).spelling(set(parameters))
        for name, value in parameters.items():
            if isinstance(value, str):
                parameters[name] = _in_si(type(self).name, name, value, self.units[name])
            check_one(type(self).name, name, parameters[name])
        self.check(parameters)
        for name, value in parameters.items():
            object.__setattr__(self, name, float(value))

    @classmethod
    def check(cls, parameters: Mapping[str, ArrayLike]) -> None:
        """ShapeError where a parameter, a number or an array over asperities, is out of its range."""
        for name, values in parameters.items():
            check_positive(cls.name, name, values)
        for name, floor, reason in cls.not_below:
            values, least = np.atleast_1d(parameters[name]), np.atleast_1d(parameters[floor])
            below = values < least
            if below.any():
                where = "" if below.size == 1 else f" at asperity {int(np.argmax(below))}"
                raise ShapeError(
                    f"{cls.name}: {name} is {values[below][0]:g}{where}; it must be at least {floor}, "
                    f"{least[below][0]:g}: {reason}"
                )


class ProfileShape(Shape):
    """A shape whose MDR profile comes from the functions of its ``Profile``, compiled when they are first used."""

    profile: ClassVar[Profile]
    common: ClassVar[bool] = False
    """Whether all asperities of an ensemble have the same profile."""

    @classmethod
    def branched(cls) -> bool:
        """Whether there can be more than one stable branch with adhesion."""
        return cls.profile.softening_count is not never_softens

    uses_profile = True

    def __init_subclass__(cls, **kwargs: Any) -> None:
        super().__init_subclass__(**kwargs)
        if "profile" in vars(cls):
            cls.flat = cls.profile.flat

    @property
    def limit(self) -> float:
        return math.inf if math.isinf(self.profile.end) else self.profile.end * self.nondimensional()[0]

    def precisely(self, t: float) -> tuple[Any, Any, Any]:
        """a [m], g [m] and a g - G [m2] at t with 40 digits."""
        from mpmath import mp

        def remake(function: Callable[..., Any]) -> Callable[..., Any]:
            if function.__module__ == vector_math.__name__ and hasattr(mp, function.__name__):
                return cast(Callable[..., Any], getattr(mp, function.__name__))
            return rebuilt(function, {"math": mp, "SERIES_UP_TO": -1.0}, remake)

        lost = max(0.0, -math.log10(t)) if t > 0.0 else 0.0  # of the digits, in each power of t that cancels
        with mp.workdps(40 + int(4.0 * lost)):
            exact = {name: np.array([mp.mpf(value)]) for name, value in self.parameters.items()}
            width, rise, params = (column[0] for column in self.nondimensionalise(exact))
            a, _, g, _ = remake(self.profile.mdr_profile)(mp.mpf(t), [params])
            return width * a, rise * g, width * rise * remake(self.profile.reduced_load)(mp.mpf(t), [params])

    def g(self, x: ArrayLike) -> Floats:
        return self._along(radii("x", x), lambda curve, swept, t, params: curve(t, params)[2])

    def G(self, a: ArrayLike) -> Floats:
        width = self.nondimensional()[0]
        return width * self._along(radii("a", a), lambda curve, swept, t, params: swept(t, params))

    def _along(self, radius: Floats, value: Callable[..., float]) -> Floats:
        """The rise times ``value`` at each contact radius; 0 on the flat."""
        from roughmdr.numerics.jit import compiled  # it alone needs the compiler

        width, rise, params = self.nondimensional()
        curve, swept, place = (
            compiled(part) for part in (self.profile.mdr_profile, self.profile.mdr_integral, self.profile.t_of_radius)
        )
        numbers = np.atleast_1d(np.asarray(params, dtype=np.float64))
        begin = width if self.profile.flat else 0.0
        flat = [value(curve, swept, place(a, width, numbers), numbers) if a > begin else 0.0 for a in radius.flat]
        results = rise * np.array(flat, dtype=np.float64).reshape(radius.shape)
        if not np.isfinite(results).all():
            worst = radius[~np.isfinite(results)].flat[0]
            raise OutOfRange(f"{self.name}: a radius of {worst:g} m lies beyond what it can touch, or a float can hold")
        return results


class SharedProfile(ProfileShape):
    """A curved shape that all asperities of an ensemble share, since its parameters are no plain numbers."""

    common: ClassVar[bool] = True
    along: ClassVar[str]
    """The dimension that the columns of an ensemble's Dataset lie over."""

    @property
    @abstractmethod
    def columns(self) -> dict[str, Floats]:
        """The parameters as equally long arrays."""

    @classmethod
    @abstractmethod
    def of_columns(cls, columns: dict[str, Floats]) -> "SharedProfile":
        """The shape of such arrays; ShapeError as the shape itself."""

    @classmethod
    def slopes(cls, parameters: dict[str, Any], r: Floats) -> Floats:
        return cls(**parameters).df(r)

    @classmethod
    def nondimensionalise(cls, parameters: dict[str, Any]) -> tuple[Any, Any, Any]:
        return cls(**parameters).nondimensional()

    @property
    def end(self) -> float:
        return math.inf


def radii(name: str, values: ArrayLike, most: float = math.inf) -> Floats:
    """``values`` as floats; OutOfRange unless all are finite, at least 0 and at most ``most``."""
    try:
        numbers = np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        raise OutOfRange(f"{name} is {values!r}; it must be numbers, finite and at least 0") from None
    wrong = ~(np.isfinite(numbers) & (numbers >= 0.0) & (numbers <= most))
    if wrong.any():
        above = "" if math.isinf(most) else f" and at most {most:g} m"
        raise OutOfRange(f"{name} is {numbers[wrong].flat[0]:g} m; it must be finite and at least 0{above}")
    return numbers


def _in_si(owner: str, name: str, text: str, dimension: str) -> float:
    try:
        return quantity(text, dimension)
    except RoughmdrError as error:
        raise ShapeError(f"{owner}: {name} is {shown(text)}: {error}") from None


def check_one(owner: str, name: str, value: object) -> None:
    """ShapeError unless ``value`` is a single thing that can be a number."""
    if isinstance(value, bool | str | bytes) or np.ndim(value) != 0:  # type: ignore[arg-type]
        raise ShapeError(f"{owner}: {name} is {value!r}; it must be one number")


def check_positive(owner: str, name: str, values: ArrayLike) -> None:
    """ShapeError, naming the first of ``values`` that is not a finite number above 0."""
    try:
        numbers = np.atleast_1d(np.asarray(values, dtype=np.float64))
    except (TypeError, ValueError, OverflowError):
        raise ShapeError(f"{owner}: {name} is {values!r}; it must be a finite number above 0") from None
    bad = ~(np.isfinite(numbers) & (numbers > 0.0))
    if bad.any():
        where = "" if numbers.size == 1 else f" at asperity {int(np.argmax(bad))}"
        raise ShapeError(f"{owner}: {name} is {numbers[bad][0]:g}{where}; it must be a finite number above 0")

"""Distributions by their scipy.stats name, sampled through their inverse, so that draws can be shared and compared."""

import difflib
import math
from dataclasses import dataclass

import numpy as np

from roughmdr.ensemble.families import Family, find_family, known_families
from roughmdr.errors import RoughmdrError
from roughmdr.shapes.base import Floats
from roughmdr.units import DIMENSIONLESS, quantity

_FRIENDLY = {
    "normal": "norm",
    "lognormal": "lognorm",
    "exponential": "expon",
    "weibull": "weibull_min",
}
_BITS = 52
SMALLEST_UNIFORM = 0.5 * 2.0**-_BITS


@dataclass(frozen=True)
class Distribution:
    """A distribution of a quantity in SI, or a constant: ``loc``, with ``scale`` 0 and no family."""

    family: str
    """Name in scipy.stats; empty for a constant."""
    own: tuple[float, ...]
    """The family's own shape parameters."""
    loc: float
    scale: float

    @property
    def constant(self) -> float | None:
        """The value, where every draw has the same."""
        return None if self.family else self.loc

    @property
    def _standard(self) -> Family:
        family = find_family(self.family)
        if family is None:
            raise AssertionError("checked when the distribution was read")
        return family

    def quantile(self, uniform: Floats) -> Floats:
        """The values below which the given fractions lie."""
        if not self.family:
            return np.full_like(uniform, self.loc)
        # From the nearer tail: 1 - u is exact, and the inverse near 1 may round to infinity.
        values = np.empty_like(uniform)
        upper = uniform > 0.5
        with np.errstate(all="ignore"):  # what overflows is refused when the distribution is read
            values[~upper] = self._standard.lower(uniform[~upper], *self.own)
            values[upper] = self._standard.upper(1.0 - uniform[upper], *self.own)
            return values * self.scale + self.loc

    @property
    def std(self) -> float:
        """Standard deviation; inf or NaN where the distribution has none."""
        return self.scale * math.sqrt(self._standard.moments(*self.own)[1]) if self.family else 0.0

    @property
    def least(self) -> float:
        """The lowest value that can be drawn."""
        return float(self.quantile(np.array([SMALLEST_UNIFORM]))[0])

    @property
    def greatest(self) -> float:
        """The greatest value that can be drawn."""
        return float(self.quantile(np.array([1.0 - SMALLEST_UNIFORM]))[0])


def uniforms(seed: int, realization: int, quantity_index: int, count: int) -> Floats:
    """``count`` numbers in (0, 1), never 0 or 1, from the stream of one quantity of one realization.

    The raw bits of Philox are the same in every version of numpy; a longer draw begins with the shorter one.
    """
    stream = np.random.Philox(np.random.SeedSequence(seed, spawn_key=(realization, quantity_index)))
    leading: Floats = (stream.random_raw(count) >> np.uint64(64 - _BITS)).astype(np.float64)
    return (leading + 0.5) * 2.0**-_BITS


def read_distribution(value: object, dimension: str, *, mean: float | None = None) -> Distribution:
    """A distribution from a scene: a plain quantity, or a table with ``distribution`` and its parameters.

    The parameters are scipy's own (shape parameters, loc, scale) or mean and std; ``mean`` is their default mean.
    Raises RoughmdrError, with the names that would do, where it cannot be read.
    """
    if not isinstance(value, dict):
        return Distribution("", (), quantity(value, dimension), 0.0)
    table = dict(value)
    given = table.pop("distribution", None)
    if not isinstance(given, str):
        raise RoughmdrError('needs a distribution by name, as in { distribution = "normal", std = ... }')
    name = _FRIENDLY.get(given, given)
    family = find_family(name)
    if family is None:
        raise RoughmdrError(f"unknown distribution {given!r}{_near(given)}; any continuous one of scipy.stats will do")
    for key in table:
        if key not in _parameters(family):
            raise RoughmdrError(f"{given} has no parameter {key!r}; it takes {', '.join(_parameters(family))}")
    units = dict.fromkeys(family.shapes, DIMENSIONLESS)
    numbers = {key: _parameter(key, entry, units.get(key, dimension)) for key, entry in table.items()}
    try:
        distribution = Distribution(name, *_located(family, given, numbers, mean))
        ends = distribution.least, distribution.greatest
    except (ArithmeticError, RuntimeError) as error:
        raise RoughmdrError(f"{given} cannot be drawn from with {_listed(numbers)}: {error}") from None
    if not (math.isfinite(ends[0]) and math.isfinite(ends[1])):
        raise RoughmdrError(f"{given} cannot be drawn from with {_listed(numbers)}: its quantiles reach {ends}")
    return distribution


def _parameters(family: Family) -> list[str]:
    return [*family.shapes, "loc", "scale", "mean", "std"]


def _parameter(key: str, value: object, dimension: str) -> float:
    try:
        return quantity(value, dimension)
    except RoughmdrError as error:
        raise RoughmdrError(f"{key} = {value!r}: {error}") from None


def _located(
    family: Family, given: str, numbers: dict[str, float], default_mean: float | None
) -> tuple[tuple[float, ...], float, float]:
    """The family's own parameters, loc and scale, from mean and std where those are given."""
    mean, std = numbers.get("mean"), numbers.get("std")
    for key in ("std", "scale"):
        if numbers.get(key, 1.0) <= 0.0:
            raise RoughmdrError(f"{key} is {numbers[key]:g}; it must be above 0")
    if std is not None and "scale" in numbers:
        raise RoughmdrError(f"{given} takes std or scale, not both")
    if mean is not None and "loc" in numbers:
        raise RoughmdrError(f"{given} takes mean or loc, not both")
    if given == "lognormal" and "s" not in numbers:
        if mean is None or std is None or not mean > 0.0:
            raise RoughmdrError("lognormal takes a mean above 0 and a std (or scipy's s, loc and scale)")
        variance = math.log1p((std / mean) ** 2)
        return (math.sqrt(variance),), 0.0, mean * math.exp(-0.5 * variance)
    missing = [shape for shape in family.shapes if shape not in numbers]
    if missing:
        raise RoughmdrError(f"{given} needs {' and '.join(missing)}; it takes {', '.join(_parameters(family))}")
    if std is None and "scale" not in numbers:
        raise RoughmdrError(f"{given} needs a std or a scale")
    own = {shape: numbers[shape] for shape in family.shapes}
    if not family.defined(*own.values()):
        raise RoughmdrError(f"{given} is not defined for {_listed(own)}")
    unit_mean, unit_variance = family.moments(*own.values())
    if mean is None and "loc" not in numbers and math.isfinite(unit_mean):
        mean = default_mean
    scale = numbers["scale"] if std is None else std / math.sqrt(unit_variance)
    loc = numbers.get("loc", 0.0) if mean is None else mean - scale * unit_mean
    if not (math.isfinite(scale) and scale > 0.0 and math.isfinite(loc)):
        raise RoughmdrError(f"{given} has no finite mean and standard deviation with {_listed(numbers)}")
    return tuple(own.values()), loc, scale


def _listed(numbers: dict[str, float]) -> str:
    return ", ".join(f"{key} = {value:g}" for key, value in numbers.items())


def _near(name: str) -> str:
    near = difflib.get_close_matches(name, [*_FRIENDLY, *known_families()], n=3, cutoff=0.6)
    return f"; did you mean {' or '.join(repr(other) for other in near)}?" if near else ""

"""Distributions as a scene gives them: a plain quantity, or a scipy.stats name with parameters."""

import math
from dataclasses import dataclass
from functools import lru_cache

from roughmdr.ensemble.random.distributions import Distribution
from roughmdr.ensemble.random.families import Family, find_family, known_families
from roughmdr.errors import RoughmdrError
from roughmdr.schema.quantities import EntryError, Quantity
from roughmdr.schema.units import DIMENSIONLESS, quantity
from roughmdr.schema.wording import close_matches

_FRIENDLY = {
    "normal": "norm",
    "lognormal": "lognorm",
    "exponential": "expon",
    "weibull": "weibull_min",
}
_LOCATION = ("loc", "scale", "mean", "std")
_PLACING = ("loc", "mean", "std")  # the last by the default mean
_ENDS = ("min", "max")
_LEAST_SHARE = 1e-200  # of a distribution that is cut off: less has no digits left
_LEAST_OWN, _GREATEST_OWN = 1e-12, 1e12  # of a family's own parameters: far beyond, scipy can end the whole process


@dataclass(frozen=True)
class DistributionReader:
    """Reads a distribution: a plain quantity, or a table with ``distribution`` and its parameters.

    The parameters are scipy's own (shape parameters, loc, scale), with which the distribution is scipy's, loc = 0 by
    default; or mean and std, which move and stretch it. ``mean`` is the default mean of those that have a std.
    ``scale`` has no default: a length of 1 m is never meant. ``min`` and ``max`` cut off what the others describe.
    Raises RoughmdrError, with the names that would do, where it cannot be read.
    """

    dimension: str
    mean: float | None = None
    positive: bool = False
    """Whether every value that can be drawn must be above 0."""

    def __call__(self, value: object) -> Distribution:
        """The distribution in SI."""
        if not isinstance(value, dict):
            return self._allowed(Distribution("", (), quantity(value, self.dimension), 0.0))
        try:
            return self._known(tuple((key, type(entry), entry) for key, entry in value.items()))
        except TypeError:  # an entry that is no number
            return self._allowed(self._from_table(value))

    @lru_cache(maxsize=256)  # noqa: B019 - the cells of a sweep read the same ones over and over
    def _known(self, entries: tuple[tuple[str, type, object], ...]) -> Distribution:
        return self._allowed(self._from_table({key: entry for key, _, entry in entries}))

    def _allowed(self, distribution: Distribution) -> Distribution:
        if self.positive and not distribution.least > 0.0:
            raise RoughmdrError(
                f"can be as low as {distribution.least:.3g}; it must be above 0 (lognormal, for one, always is)"
            )
        return distribution

    def parameters(self, value: object) -> list[str]:
        """The names of the parameters that an entry can have."""
        given = value.get("distribution") if isinstance(value, dict) else None
        family = find_family(_FRIENDLY.get(given, given)) if isinstance(given, str) else None
        return [*_LOCATION, *_ENDS] if family is None else _parameters(family)

    def parameter(self, name: str) -> Quantity:
        """What reads one parameter of the table."""
        return Quantity(
            self.dimension if name in (*_LOCATION, *_ENDS) else DIMENSIONLESS,
            above=0.0 if name in ("std", "scale") else None,
        )

    def _number(self, name: str, value: object) -> float:
        try:
            return self.parameter(name)(value)
        except RoughmdrError as error:
            raise EntryError(name, value, str(error)) from None

    def _from_table(self, value: dict[str, object]) -> Distribution:
        table = dict(value)
        given = table.pop("distribution", None)
        if given is None:
            for meant in close_matches("distribution", table):
                raise EntryError(meant, table[meant], "unknown key; did you mean 'distribution'?")
            raise RoughmdrError('needs a distribution by name, as in { distribution = "normal", std = ... }')
        if not isinstance(given, str):
            raise EntryError("distribution", given, 'must be a name, like "normal"')
        name = _FRIENDLY.get(given, given)
        family = find_family(name)
        if family is None:
            raise EntryError(
                "distribution",
                given,
                f"not known{_suggestion(given)}; any continuous one of scipy.stats will do",
            )
        allowed = _parameters(family)
        for key, entry in table.items():
            if key not in allowed:
                raise EntryError(key, entry, f"{given} has no such parameter; it takes {', '.join(allowed)}")
        numbers = {key: self._number(key, entry) for key, entry in table.items()}
        least, most = numbers.pop("min", -math.inf), numbers.pop("max", math.inf)
        try:
            placed = not numbers.keys().isdisjoint(_PLACING)
            distribution = Distribution(name, *_located(family, given, numbers, self.mean), least, most, placed)
            _check_cut(distribution, given)
            ends = distribution.least, distribution.greatest
        except RoughmdrError:
            raise
        except (ArithmeticError, RuntimeError, ValueError) as error:  # of scipy, where its inverse leads nowhere
            raise RoughmdrError(f"{given} cannot be drawn from with {_listed(numbers)}: {error}") from None
        if not (math.isfinite(ends[0]) and math.isfinite(ends[1])):
            raise RoughmdrError(f"{given} cannot be drawn from with {_listed(numbers)}: its quantiles reach {ends}")
        return distribution


def _parameters(family: Family) -> list[str]:
    return [*family.shapes, *_LOCATION, *_ENDS]


def _check_cut(distribution: Distribution, given: str) -> None:
    if not distribution.cut:
        return
    if not distribution.min < distribution.max:
        raise EntryError("max", distribution.max, f"must be above min, {distribution.min:g}")
    if not distribution.share >= _LEAST_SHARE:
        raise RoughmdrError(
            f"{given} has next to nothing between min, {distribution.min:g}, and max, {distribution.max:g}"
        )


def _located(
    family: Family, given: str, numbers: dict[str, float], default_mean: float | None
) -> tuple[tuple[float, ...], float, float]:
    """The family's own parameters, loc and scale, from mean and std where those are given."""
    mean, std = numbers.get("mean"), numbers.get("std")
    if std is not None and "scale" in numbers:
        raise RoughmdrError(f"{given} takes std or scale, not both")
    if mean is not None and "loc" in numbers:
        raise RoughmdrError(f"{given} takes mean or loc, not both")
    if given == "lognormal" and "s" not in numbers:
        if mean is None or std is None:
            raise RoughmdrError("lognormal takes a mean above 0 and a std (or scipy's s, loc and scale)")
        if not mean > 0.0:
            raise EntryError("mean", mean, "must be above 0 in a lognormal distribution")
        variance = math.log1p((std / mean) ** 2)
        return _finite(given, numbers, (math.sqrt(variance),), 0.0, mean * math.exp(-0.5 * variance))
    missing = [shape for shape in family.shapes if shape not in numbers]
    if missing:
        raise RoughmdrError(f"{given} needs {' and '.join(missing)}; it takes {', '.join(_parameters(family))}")
    if std is None and "scale" not in numbers:
        raise RoughmdrError(f"{given} needs a std or a scale")
    own = {shape: numbers[shape] for shape in family.shapes}
    for shape, value in own.items():
        if value and not _LEAST_OWN <= abs(value) <= _GREATEST_OWN:
            raise EntryError(shape, value, f"must be 0, or {_LEAST_OWN:g} to {_GREATEST_OWN:g} in magnitude")
    if not family.defined(*own.values()):
        raise RoughmdrError(f"{given} is not defined for {_listed(own)}")
    unit_mean, unit_variance = family.moments(*own.values())
    if std is not None and mean is None and "loc" not in numbers:
        mean = default_mean
    scale = numbers["scale"] if std is None else std / math.sqrt(unit_variance)
    loc = numbers.get("loc", 0.0) if mean is None else mean - scale * unit_mean
    return _finite(given, numbers, tuple(own.values()), loc, scale)


def _finite(
    given: str, numbers: dict[str, float], own: tuple[float, ...], loc: float, scale: float
) -> tuple[tuple[float, ...], float, float]:
    if not (math.isfinite(scale) and scale > 0.0 and math.isfinite(loc)):
        raise RoughmdrError(f"{given} has no finite mean and standard deviation with {_listed(numbers)}")
    return own, loc, scale


def _listed(numbers: dict[str, float]) -> str:
    return ", ".join(f"{key} = {value:g}" for key, value in numbers.items())


def _suggestion(name: str) -> str:
    meant = close_matches(name, [*_FRIENDLY, *known_families()], count=3)
    return f"; did you mean {' or '.join(map(repr, meant))}?" if meant else ""

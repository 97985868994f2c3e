"""Read a distribution as a scene gives it, a plain quantity or a table of a family and parameters; its JSON Schema."""

import math
from dataclasses import dataclass
from functools import lru_cache

from roughmdr.ensemble.random.distribution import Distribution
from roughmdr.ensemble.random.distribution_families import ALIASES, Family, find_family, known_families
from roughmdr.errors import RoughmdrError
from roughmdr.schema.json_schema import JsonSchema, described, of_any_type
from roughmdr.schema.quantities import EntryError, Quantity, Reader
from roughmdr.schema.units import DIMENSIONLESS, format_quantity, quantity
from roughmdr.schema.wording import close_matches

_COMMON = {
    "loc": "scipy's loc. Default: 0",
    "scale": "scipy's scale",
    "mean": "Mean, to which the distribution is moved",
    "std": "Standard deviation, to which it is stretched",
    "min": "Least value: those below are not drawn",
    "max": "Greatest value: those above are not drawn",
}
"""Parameters of every family, in the unit of the quantity, with their meaning in the JSON Schema."""
_FAMILIES = "families_of_distributions"  # name of the schema that tells which family has which parameters
_LOCATION = ("loc", "mean", "std")  # any of these determines it: std together with the default mean
_MIN_FRACTION = 1e-200  # least probability that a truncated distribution keeps: less has no digits left
_MIN_PARAMETER, _MAX_PARAMETER = 1e-12, 1e12  # limits of a parameter's magnitude: far beyond, scipy can crash


def _definition_of(dimension: str) -> str:
    """Return the name of the JSON Schema of the table of a distribution."""
    return "distribution" if dimension == DIMENSIONLESS else f"distribution_of_{dimension}"


@dataclass(frozen=True)
class DistributionReader(Reader):
    """Reads a distribution: a plain quantity, or a table with ``distribution`` and its parameters.

    The parameters are scipy's (the family's own, loc, scale), with which the distribution is scipy's, loc = 0 by
    default; or mean and std, to which it is moved and scaled. ``mean`` is used where a std is given but neither mean
    nor loc. ``scale`` has no default: a length of 1 m is never meant. ``min`` and ``max`` truncate what the others
    describe. Raises RoughmdrError, with the names that are allowed, where the entry cannot be read.
    """

    dimension: str
    mean: float | None = None
    positive: bool = False  # whether every value that can be drawn must be above 0

    def __call__(self, value: object) -> Distribution:
        """Return the distribution in SI."""
        if not isinstance(value, dict):
            distribution = Distribution("", (), quantity(value, self.dimension), 0.0)
        else:
            try:
                distribution = self._read_cached(tuple((key, type(entry), entry) for key, entry in value.items()))
            except TypeError:  # an entry that cannot be hashed
                distribution = self._from_table(value)
        if self.positive and not distribution.smallest > 0.0:
            if distribution.constant is not None:
                raise RoughmdrError("must be above 0")
            lowest = format_quantity(distribution.smallest, self.dimension)
            raise RoughmdrError(f"can be as low as {lowest}; it must be above 0 (lognormal, for one, always is)")
        return distribution

    @lru_cache(maxsize=256)  # noqa: B019 - the cells of a sweep read the same ones over and over
    def _read_cached(self, entries: tuple[tuple[str, type, object], ...]) -> Distribution:
        return self._from_table({key: entry for key, _, entry in entries})

    def parameters(self, value: object) -> list[str]:
        """Return the names of the parameters that an entry can have."""
        given = value.get("distribution") if isinstance(value, dict) else None
        family = find_family(ALIASES.get(given, given)) if isinstance(given, str) else None
        return [*(family.parameters if family else ()), *_COMMON]

    def parameter(self, name: str) -> Quantity:
        """Return the reader of one parameter of the table."""
        above = 0.0 if name in ("std", "scale") else None
        return Quantity(self.dimension if name in _COMMON else DIMENSIONLESS, above=above)

    def json_schema(self) -> JsonSchema:
        """Return the schema of a plain quantity or a table, which is ``distribution_schemas`` to describe."""
        plain = Quantity(self.dimension, above=0.0 if self.positive else None).json_schema()
        defined = [{"$ref": f"#/$defs/{_definition_of(self.dimension)}"}]
        return of_any_type(plain, {"type": "object", "required": ["distribution"], "allOf": defined})

    def __str__(self) -> str:
        plain = Quantity(self.dimension, above=0.0 if self.positive else None)
        return f'{plain}; or a table such as {{ distribution = "normal", mean = ..., std = ... }}'

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
        name = ALIASES.get(given, given)
        family = find_family(name)
        if family is None:
            meanings = close_matches(given, [*ALIASES, *known_families()], count=3)
            hint = f"; did you mean {' or '.join(map(repr, meanings))}?" if meanings else ""
            raise EntryError("distribution", given, f"not known{hint}; any continuous one of scipy.stats will do")
        allowed = self.parameters(value)
        for key, entry in table.items():
            if key not in allowed:
                raise EntryError(key, entry, f"{given} has no such parameter; it takes {', '.join(allowed)}")
        numbers = {key: self._number(key, entry) for key, entry in table.items()}
        low, high = numbers.pop("min", -math.inf), numbers.pop("max", math.inf)
        try:
            location_given = not numbers.keys().isdisjoint(_LOCATION)
            distribution = Distribution(name, *_located(family, given, numbers, self.mean), low, high, location_given)
            if not low < high:
                raise EntryError("max", high, f"must be above min, {low:g}")
            if not distribution.kept_fraction >= _MIN_FRACTION:
                raise RoughmdrError(f"{given} has next to nothing between min, {low:g}, and max, {high:g}")
            ends = distribution.smallest, distribution.largest
        except RoughmdrError:
            raise
        except (ArithmeticError, RuntimeError, ValueError) as error:  # of scipy, where its inverse does not converge
            raise RoughmdrError(f"{given} cannot be drawn from with {_listed(numbers)}: {error}") from None
        if not all(map(math.isfinite, ends)):
            raise RoughmdrError(f"{given} cannot be drawn from with {_listed(numbers)}: its quantiles reach {ends}")
        return distribution


def _located(
    family: Family, given: str, numbers: dict[str, float], default_mean: float | None
) -> tuple[tuple[float, ...], float, float]:
    """Return the family's own parameters, loc and scale, from mean and std where those are given."""
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
        parameters: tuple[float, ...] = (math.sqrt(variance),)
        loc, scale = 0.0, mean * math.exp(-0.5 * variance)
    else:
        parameters = _own_parameters(family, given, numbers)
        unit_mean, unit_variance = family.moments(*parameters)
        if std is not None and mean is None and "loc" not in numbers:
            mean = default_mean
        scale = numbers["scale"] if std is None else std / math.sqrt(unit_variance)
        loc = numbers.get("loc", 0.0) if mean is None else mean - scale * unit_mean
    if not (math.isfinite(scale) and scale > 0.0 and math.isfinite(loc)):
        raise RoughmdrError(f"{given} has no finite mean and standard deviation with {_listed(numbers)}")
    return parameters, loc, scale


def _own_parameters(family: Family, given: str, numbers: dict[str, float]) -> tuple[float, ...]:
    missing = [name for name in family.parameters if name not in numbers]
    if missing:
        allowed = ", ".join((*family.parameters, *_COMMON))
        raise RoughmdrError(f"{given} needs {' and '.join(missing)}; it takes {allowed}")
    if "std" not in numbers and "scale" not in numbers:
        raise RoughmdrError(f"{given} needs a std or a scale")
    parameters = {name: numbers[name] for name in family.parameters}
    for name, value in parameters.items():
        if value and not _MIN_PARAMETER <= abs(value) <= _MAX_PARAMETER:
            raise EntryError(name, value, f"must be 0, or {_MIN_PARAMETER:g} to {_MAX_PARAMETER:g} in magnitude")
    if not family.is_defined(*parameters.values()):
        raise RoughmdrError(f"{given} is not defined for {_listed(parameters)}")
    return tuple(parameters.values())


def _listed(numbers: dict[str, float]) -> str:
    return ", ".join(f"{key} = {value:g}" for key, value in numbers.items())


def distribution_names() -> list[str]:
    """Return all names of distributions that a scene can have, the usual ones first."""
    return [*ALIASES, *known_families()]


def own_parameters() -> dict[tuple[str, ...], list[str]]:
    """Return the names of distributions by the parameters that they have of their own."""
    names: dict[tuple[str, ...], list[str]] = {}
    for name in distribution_names():
        family = find_family(ALIASES.get(name, name))
        names.setdefault(() if family is None else family.parameters, []).append(name)
    return names


def distribution_schemas() -> dict[str, JsonSchema]:
    """Return the definitions that ``DistributionReader.json_schema`` refers to, by name."""
    families = own_parameters()
    own = dict.fromkeys(name for parameters in families for name in parameters)
    of_family = described(Quantity(DIMENSIONLESS).json_schema(), "a parameter of the family, as scipy.stats has it")
    tables = {}
    for dimension in ("m", DIMENSIONLESS):
        reader = DistributionReader(dimension)
        common = {name: described(reader.parameter(name).json_schema(), text) for name, text in _COMMON.items()}
        chosen = {"distribution": described({"enum": distribution_names()}, "a continuous distribution of scipy.stats")}
        tables[_definition_of(dimension)] = {
            "properties": {**chosen, **common, **dict.fromkeys(own, of_family)},
            "additionalProperties": False,
            "allOf": [{"$ref": f"#/$defs/{_FAMILIES}"}],
        }
    return {**tables, _FAMILIES: {"allOf": [_family(*each) for each in families.items()]}}


def _family(parameters: tuple[str, ...], names: list[str]) -> JsonSchema:
    """Return the rule that these distributions have no other parameters."""
    return {
        "if": {"properties": {"distribution": {"enum": names}}, "required": ["distribution"]},
        "then": {"propertyNames": {"enum": ["distribution", *parameters, *_COMMON]}},
    }

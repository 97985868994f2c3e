"""The JSON Schema of the table of a distribution: its families by name, each with its own parameters."""

from functools import cache

from roughmdr.ensemble.random.distribution_families import ALIASES, find_family, known_families
from roughmdr.ensemble.random.distribution_reader import COMMON, DistributionReader, definition_of
from roughmdr.schema.json_schema import JsonSchema, described
from roughmdr.schema.quantities import Quantity
from roughmdr.schema.units import DIMENSIONLESS

_FAMILIES = "families_of_distributions"
_MEANINGS = {
    "loc": "scipy's loc. Default: 0",
    "scale": "scipy's scale",
    "mean": "Mean, to which the distribution is moved",
    "std": "Standard deviation, to which it is stretched",
    "min": "Least value: those below are not drawn",
    "max": "Greatest value: those above are not drawn",
}


@cache
def distribution_names() -> list[str]:
    """Return all names of distributions that a scene can have, the usual ones first."""
    return [*ALIASES, *known_families()]


@cache
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
        common = {name: described(reader.parameter(name).json_schema(), text) for name, text in _MEANINGS.items()}
        chosen = {"distribution": described({"enum": distribution_names()}, "a continuous distribution of scipy.stats")}
        tables[definition_of(dimension)] = {
            "properties": {**chosen, **common, **dict.fromkeys(own, of_family)},
            "additionalProperties": False,
            "allOf": [{"$ref": f"#/$defs/{_FAMILIES}"}],
        }
    return {**tables, _FAMILIES: {"allOf": [_family(*each) for each in families.items()]}}


def _family(parameters: tuple[str, ...], names: list[str]) -> JsonSchema:
    """Return the rule that these distributions have no other parameters."""
    return {
        "if": {"properties": {"distribution": {"enum": names}}, "required": ["distribution"]},
        "then": {"propertyNames": {"enum": ["distribution", *parameters, *COMMON]}},
    }

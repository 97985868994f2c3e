"""The JSON Schema of [sweep]: the keys that can be swept, each with the values that it can have."""

import re

from roughmdr.scene.sweep import ENDS, NUM
from roughmdr.schema.json_schema import JsonSchema, described, of_any_type
from roughmdr.schema.quantities import Quantity
from roughmdr.schema.units import DIMENSIONLESS

Definitions = dict[str, JsonSchema]


def sweep_schema(entries: dict[str, list[JsonSchema]], of_families: list[str]) -> tuple[JsonSchema, Definitions]:
    """Return the schema of [sweep], and definitions that it refers to.

    ``entries`` are the schemas that an entry may have, by dotted key; ``of_families`` are the names of parameters that
    distributions have beside the common ones, which are keys too.
    """
    values = {key: _values(allowed) for key, allowed in entries.items()}
    values[_OF_FAMILY] = _values([Quantity(DIMENSIONLESS).json_schema()])
    distinct: list[JsonSchema] = []
    for each in values.values():
        if each not in distinct:
            distinct.append(each)
    references = {key: {"$ref": f"#/$defs/swept_{distinct.index(each)}"} for key, each in values.items()}
    schema = _table(references, "|".join(of_families), "")
    mode = described({"enum": ["product", "zip"], "default": "product"}, '"product": all combinations; "zip": in step')
    schema["properties"] = {"mode": mode, **schema["properties"]}
    return schema, {f"swept_{number}": each for number, each in enumerate(distinct)}


_OF_FAMILY = ""
"""Stands for the key of any parameter that a family has of its own."""


def _values(allowed: list[JsonSchema]) -> JsonSchema:
    """Return the schema of the values of one key: a list or, of numbers, two ends and a number."""
    entry = allowed[0] if len(allowed) == 1 else {"anyOf": allowed}
    listed = {"type": "array", "items": entry, "minItems": 1}
    if not any("number" in each.get("type", ()) or each.get("type") == "integer" for each in allowed):
        return described(listed, "values to run the scene with: a list of names")
    ends = {"type": "array", "items": entry, "minItems": 2, "maxItems": 2}
    spaced = {
        "type": "object",
        "properties": {**dict.fromkeys(ENDS, ends), "num": NUM.json_schema()},
        "additionalProperties": False,
    }
    told = "values to run the scene with: a list, or { linspace = [first, last], num = ... }, or with logspace"
    return described(of_any_type(listed, spaced), told)


def _table(references: dict[str, JsonSchema], of_families: str, at: str) -> JsonSchema:
    """Return the schema of a table of keys below ``at``: dotted, or in tables of their own."""
    inner = {key.removeprefix(at): value for key, value in references.items() if key.startswith(at) and key}
    properties = dict(inner)
    for first in dict.fromkeys(key.partition(".")[0] for key in inner if "." in key):
        below = _table(references, of_families, f"{at}{first}.")
        properties[first] = {"anyOf": [inner[first], below]} if first in inner else below
    schema: JsonSchema = {"type": "object", "properties": properties, "additionalProperties": False}
    if distributions := [key.removesuffix("distribution") for key in inner if key.split(".")[-1] == "distribution"]:
        pattern = f"^(?:{'|'.join(map(re.escape, distributions))})(?:{of_families})$"
        schema["patternProperties"] = {pattern: references[_OF_FAMILY]}
    return schema

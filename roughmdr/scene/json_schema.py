"""The JSON Schema of the scene file, for editors and for checks without roughmdr; made from the sections.

It allows all that ``read`` allows. What it cannot tell, such as keys that exclude each other, ``read`` finds.
"""

import json
import re
from types import NoneType, UnionType
from typing import Annotated, Any, Union, get_args, get_origin

from pydantic import WithJsonSchema
from pydantic.fields import FieldInfo

from roughmdr.ensemble.random import distribution_reader
from roughmdr.scene.keys import key_readers
from roughmdr.scene.scene import Scene
from roughmdr.scene.sweep import ENDS, NUM, may_be_swept
from roughmdr.schema.json_schema import JsonSchema, described, of_any_name, of_any_type, only_required, without_required
from roughmdr.schema.quantities import Quantity, Reader
from roughmdr.schema.section import Section, meanings, reader_of
from roughmdr.schema.units import DIMENSIONLESS

_DRAFT = "https://json-schema.org/draft/2020-12/schema"
Definitions = dict[str, JsonSchema]
_ASKS = {"required": ["accuracy"], "properties": {"accuracy": {"required": ["of"]}}}
"""Schema of scenes that ask for a quantity."""


def scene_schema() -> JsonSchema:
    """Return the schema of a scene."""
    scene = _section(Scene, "")
    for name in ("title", "path"):  # which is that of the file, or leads to where a quantity is asked for
        scene["required"].remove(name)
    swept: dict[str, list[JsonSchema]] = {}
    for key, reader in key_readers([Scene], {}):
        if may_be_swept(key) and (entry := _swept(key, reader)) not in swept.setdefault(key, []):
            swept[key].append(entry)
    sweep, definitions = sweep_schema(swept, sorted(set[str]().union(*distribution_reader.own_parameters())))
    scene["properties"]["sweep"] |= sweep
    # A key that is swept may be left out otherwise.
    required = {**only_required(scene), "if": _ASKS, "else": {"required": ["path"]}}
    unless_swept = {"if": {"not": {"required": ["sweep"]}}, "then": required}
    definitions |= distribution_reader.distribution_schemas()
    return {"$schema": _DRAFT, **without_required(scene), **unless_swept, "$defs": definitions}


def _swept(key: str, reader: Reader) -> JsonSchema:
    """Return the schema of one value of a swept key; of a distribution that is a plain one."""
    if isinstance(reader, distribution_reader.DistributionReader):
        return Quantity(reader.dimension).json_schema()
    return {"enum": distribution_reader.distribution_names()} if key.endswith(".distribution") else reader.json_schema()


def _section(section: type[Section], at: str) -> JsonSchema:
    """Return the schema of a section, whose keys begin with ``at``."""
    fields, told = section.model_fields, meanings(section)
    return {
        "type": "object",
        "properties": {name: _field(field, f"{at}{name}", told.get(name, "")) for name, field in fields.items()},
        "required": [name for name, field in fields.items() if field.is_required()],
        "additionalProperties": False,
    }


def _field(field: FieldInfo, key: str, meaning: str) -> JsonSchema:
    declared, default = (*field.metadata, field.annotation), field.default
    told = isinstance(default, bool | int | float | str | list) and not field.is_required()
    stated = str(reader_of(declared) or ""), f"Default: {json.dumps(default)}" if told else ""
    result = described(_value(declared, key), field.description or meaning, *stated)
    return {**result, "default": default} if told else result


def _value(declared: tuple[Any, ...], key: str) -> JsonSchema:
    """Return the schema of what is declared by an annotation, last, and what goes with it."""
    *metadata, annotation = declared
    for part in metadata:
        if isinstance(part, WithJsonSchema):
            return dict(part.json_schema or {})
        if isinstance(part, Reader):
            return part.json_schema()
    origin, inner = get_origin(annotation), get_args(annotation)
    if origin is Annotated:
        return _value((*inner[1:], inner[0]), key)
    if origin in (Union, UnionType):
        members = [_value((part,), key) for part in inner if part is not NoneType]
        tables = all(each.get("type") == "object" for each in members)
        return members[0] if len(members) == 1 else of_any_name(members) if tables else of_any_type(*members)
    if origin is list:
        return {"type": "array", "items": _value(inner, f"{key}[]"), "minItems": 1}
    if isinstance(annotation, type) and issubclass(annotation, Section):
        return _section(annotation, f"{key}.")
    if annotation is bool:
        return {"type": "boolean"}
    reader = reader_of((annotation,))
    return {} if reader is None else reader.json_schema()


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
    of_entries = {name: properties.pop(name) for name in list(properties) if "[0]" in name}
    schema: JsonSchema = {"type": "object", "properties": properties, "additionalProperties": False}
    if of_entries:
        any_entry = {re.escape(name).replace(r"\[0\]", r"\[\d+\]"): each for name, each in of_entries.items()}
        schema["patternProperties"] = {f"^{pattern}$": each for pattern, each in any_entry.items()}
    if distributions := [key.removesuffix("distribution") for key in inner if key.split(".")[-1] == "distribution"]:
        pattern = f"^(?:{'|'.join(map(re.escape, distributions))})(?:{of_families})$"
        schema.setdefault("patternProperties", {})[pattern] = references[_OF_FAMILY]
    return schema

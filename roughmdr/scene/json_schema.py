"""The JSON Schema of the scene file, for editors and for checks without roughmdr; made from the sections.

It allows all that ``read`` allows. What it cannot tell, such as keys that exclude each other, ``read`` finds.
"""

import json
import re
from collections.abc import Iterator
from types import NoneType, UnionType
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from pydantic import BeforeValidator, WithJsonSchema
from pydantic.fields import FieldInfo

from roughmdr.ensemble.random.distribution_reader import DistributionReader
from roughmdr.ensemble.random.distribution_schema import distribution_names, distribution_schemas, own_parameters
from roughmdr.scene.scene import Scene
from roughmdr.scene.sweep import ENDS, NUM, may_be_swept
from roughmdr.schema.descriptions import describe_key
from roughmdr.schema.json_schema import (
    JsonSchema,
    described,
    of_any_name,
    of_any_type,
    only_required,
    without_required,
)
from roughmdr.schema.quantities import Quantity, Reader, Section
from roughmdr.schema.units import DIMENSIONLESS
from roughmdr.stages import STAGES

_DRAFT = "https://json-schema.org/draft/2020-12/schema"
_TYPES: dict[Any, str] = {int: "integer", float: "number", str: "string"}
Definitions = dict[str, JsonSchema]


def scene_schema() -> JsonSchema:
    """Return the schema of a scene."""
    made = _Sections()
    scene = made.section(Scene, "")
    scene["required"].remove("title")  # which is that of the file
    swept = {key: entries for key, entries in made.values.items() if may_be_swept(key) and "[]" not in key}
    sweep, definitions = sweep_schema(swept, sorted({name for names in own_parameters() for name in names}))
    scene["properties"]["sweep"] |= sweep
    # A key that is swept may be left out otherwise.
    unless_swept = {"if": {"not": {"required": ["sweep"]}}, "then": only_required(scene)}
    definitions |= distribution_schemas()
    return {"$schema": _DRAFT, **without_required(scene), **unless_swept, "$defs": definitions}


class _Sections:
    """Makes the schemas of sections, and notes those of all single values by their dotted keys."""

    def __init__(self) -> None:
        self.values: dict[str, list[JsonSchema]] = {}

    def section(self, section: type[Section], at: str) -> JsonSchema:
        """Return the schema of a section, whose dotted key is ``at``."""
        fields = section.model_fields
        return {
            "type": "object",
            "properties": {name: self._field(name, field, at) for name, field in fields.items()},
            "required": [name for name, field in fields.items() if field.is_required()],
            "additionalProperties": False,
        }

    def _field(self, name: str, field: FieldInfo, at: str) -> JsonSchema:
        declared = (*field.metadata, field.annotation)
        schema = self._value(declared, f"{at}.{name}".removeprefix("."))
        reader = next(_readers(declared), None)
        default = field.default
        stated = isinstance(default, bool | int | float | str | list)
        told = f"Default: {_toml(default)}" if stated and not field.is_required() else ""
        result = described(schema, _describe(at, name), "" if reader is None else str(reader), told)
        return {**result, "default": default} if told else result

    def _value(self, declared: tuple[Any, ...], key: str) -> JsonSchema:
        """Return the schema of what is declared by an annotation, last, and what goes with it."""
        *metadata, annotation = declared
        if own := [part for part in metadata if isinstance(part, WithJsonSchema)]:
            return dict(own[0].json_schema or {})
        if reader := next(_readers(tuple(metadata)), None):
            return self._noted(key, reader.json_schema(), reader)
        origin, inner = get_origin(annotation), get_args(annotation)
        if origin is Annotated:
            return self._value((*inner[1:], inner[0]), key)
        if origin in (Union, UnionType):
            members = [self._value((part,), key) for part in inner if part is not NoneType]
            return members[0] if len(members) == 1 else self._any_of(members)
        if origin is Literal:
            return self._noted(key, {"const": inner[0]} if len(inner) == 1 else {"enum": list(inner)})
        if origin is list:
            return {"type": "array", "items": self._value(inner, f"{key}[]"), "minItems": 1}
        if isinstance(annotation, type) and issubclass(annotation, Section):
            return self.section(annotation, key)
        if annotation is bool:
            return {"type": "boolean"}
        return self._noted(key, {"type": _TYPES[annotation]}) if annotation in _TYPES else {}

    @staticmethod
    def _any_of(members: list[JsonSchema]) -> JsonSchema:
        tables = all(each.get("type") == "object" for each in members)
        return of_any_name(members) if tables else of_any_type(*members)

    def _noted(self, key: str, schema: JsonSchema, reader: Reader | None = None) -> JsonSchema:
        """Note the schema of a single value, and those of the parameters of a distribution, and return it."""
        noted = {key: schema}
        if isinstance(reader, DistributionReader):
            noted[key] = Quantity(reader.dimension).json_schema()
            noted[f"{key}.distribution"] = {"enum": distribution_names()}
            common = reader.parameters(None)
            noted |= {f"{key}.{name}": reader.parameter(name).json_schema() for name in common}
        for each, entry in noted.items():
            entries = self.values.setdefault(each, [])
            if entry not in entries:
                entries.append(entry)
        return schema


def _describe(at: str, name: str) -> str:
    """Return the line on a key of a section, whose dotted key is ``at``."""
    for stage in STAGES:
        if (at, name) == ("", stage.key):
            return stage.about
        if at.split(".", maxsplit=1)[0] == stage.key:
            return stage.words[f"{at}.{name}".removeprefix(f"{stage.key}.")]
    return describe_key(at, name)


def _readers(declared: tuple[Any, ...]) -> Iterator[Reader]:
    """Yield the readers among what is declared, also within an annotation."""
    for part in declared:
        if isinstance(part, BeforeValidator) and isinstance(part.func, Reader):
            yield part.func
        elif get_origin(part) in (Annotated, Union, UnionType) and not isinstance(part, type):
            yield from _readers(get_args(part))


def _toml(value: Any) -> str:
    return json.dumps(value)


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

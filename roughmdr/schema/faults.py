"""pydantic's validation errors as faults of a scene: the dotted key, its value, and what is allowed."""

import copy
from collections.abc import Mapping
from functools import reduce
from operator import getitem
from typing import Any, get_args

from pydantic import BaseModel, TypeAdapter, ValidationError
from pydantic.fields import FieldInfo
from pydantic_core import PydanticCustomError

from roughmdr.errors import Fault, SceneError
from roughmdr.schema.quantities import EntryError
from roughmdr.schema.section import reader_of
from roughmdr.schema.units import to_plain
from roughmdr.schema.wording import close_matches, printable, short_repr, suggestion

_Sections = list[type[BaseModel]]
_INCOMPLETE = ("is missing", "needs ", "must be a table")  # beginnings of messages that an example follows


def mismatch(key: str, message: str) -> PydanticCustomError:
    """Return the error that a section raises if ``key``, dotted from the top of the scene, does not go with others."""
    return PydanticCustomError("mismatch", "{message}", {"key": key, "message": message})


def validated(declared: Any, table: Mapping[str, Any], key: str) -> Any:
    """Return a table, the argument ``key`` of a Python function, as it is declared; SceneError with all its faults."""
    try:
        return TypeAdapter(declared).validate_python(to_plain(table))
    except ValidationError as error:
        faults = find_faults(error, dict(table), declared)
        raise SceneError.of([fault._replace(key=f"{key}.{fault.key}".removesuffix(".")) for fault in faults]) from None


def find_faults(error: ValidationError, data: dict[str, Any], declared: Any) -> list[Fault]:
    """Return all faults that pydantic found in ``data``, read as ``declared``: a section or a union of sections."""
    return [_with_example(_to_fault(fault, data, declared), declared) for fault in error.errors(include_url=False)]


def with_likely_names(error: ValidationError, data: dict[str, Any], declared: Any) -> dict[str, Any] | None:
    """Return the data with misspelt names that choose a section corrected, so that its other faults can be found.

    None if no such name is at fault.
    """
    corrected = copy.deepcopy(data)
    changed = False
    for fault in error.errors(include_url=False):
        if not fault["type"].startswith("union_tag"):
            continue
        keys, _, choices = _locate(fault["loc"], data, declared)
        name = fault["ctx"]["discriminator"].strip("'")
        table = reduce(getitem, keys, corrected)
        tags = _tags(choices, name)
        for key in [name] if name in table else close_matches(name, table):
            tag = table[key]
            if matches := [tag] if tag in tags else close_matches(str(tag), tags):
                del table[key]
                table[name] = matches[0]
                changed = True
    return corrected if changed else None


def sections_of(annotation: Any) -> _Sections:
    """Return the sections among which an annotation chooses."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return [annotation]
    return [section for part in get_args(annotation) for section in sections_of(part)]


def _with_example(fault: Fault, declared: Any) -> Fault:
    """Add an example of what to write to a fault where something is missing."""
    incomplete = fault.message.startswith(_INCOMPLETE) and "it can be" not in fault.message
    example = _example_of(fault.key, declared) if incomplete else ""
    return fault._replace(message=f"{fault.message}; for example: {example}") if example else fault


def _to_fault(fault: Any, data: dict[str, Any], declared: Any) -> Fault:
    keys, holders, choices = _locate(fault["loc"], data, declared)
    key = ".".join(keys)
    context = fault.get("ctx", {})
    value = "" if isinstance(fault["input"], dict) and fault["type"] == "value_error" else short_repr(fault["input"])
    match fault["type"]:
        case "mismatch":
            return Fault(context["key"], "", context["message"])
        case "extra_forbidden":
            allowed = sorted({name for section in holders for name in section.model_fields})
            return Fault(key, "", f"unknown key{suggestion(keys[-1], allowed)}")
        case "missing":
            return Fault(key, "", "is missing")
        case "union_tag_not_found":
            name = context["discriminator"].strip("'")
            if misspelt := close_matches(name, fault["input"]):
                return Fault(".".join([*keys, printable(misspelt[0])]), "", f"unknown key; did you mean {name!r}?")
            return Fault(".".join([*keys, name]), "", f"is missing; it can be {', '.join(_tags(choices, name))}")
        case "union_tag_invalid":
            tags = [tag.strip("'") for tag in context["expected_tags"].split(", ")]
            tag_key = ".".join([*keys, context["discriminator"].strip("'")])
            return Fault(tag_key, repr(context["tag"]), f"not available{suggestion(context['tag'], tags)}")
        case "literal_error":
            allowed = [name.strip("'") for name in context["expected"].replace(" or ", ", ").split(", ")]
            return Fault(key, value, f"not available{suggestion(str(fault['input']), allowed)}")
        case "value_error" if isinstance(error := context["error"], EntryError):
            entry = "" if error.value is None else short_repr(error.value)
            return Fault(".".join([*keys, error.key]), entry, str(error))
        case "value_error":
            return Fault(key, value, str(context["error"]))
        case "model_type" | "dict_type" | "model_attributes_type":
            return Fault(key, value, "must be a table")
        case _:
            return Fault(key, value, fault["msg"][0].lower() + fault["msg"][1:])


def _locate(loc: tuple[int | str, ...], data: Any, declared: Any) -> tuple[list[str], _Sections, _Sections]:
    """Return the keys of ``data`` down to a fault, the sections that may hold the last key, and those that may stand
    under it.

    pydantic's location ``loc`` also names the member chosen in each union; those are not keys.
    """
    keys: list[str] = []
    holders = inner = sections_of(declared)
    for position, item in enumerate(loc):
        last = position == len(loc) - 1
        if isinstance(data, dict) and (item in data or (last and any(item in s.model_fields for s in inner))):
            name = str(item)
            keys.append(printable(name))
            holders = inner
            fields = [holder.model_fields[name] for holder in holders if name in holder.model_fields]
            inner = [section for field in fields for section in sections_of(field.annotation)]
            data = data.get(item)
        elif isinstance(data, list) and isinstance(item, int) and item < len(data):
            keys[-1] += f"[{item}]"
            data = data[item]
        else:
            inner = [
                s for s in inner if any(get_args(f.annotation) == (item,) for f in s.model_fields.values())
            ] or inner
    return keys, holders, inner


def _tags(sections: _Sections, discriminator: str) -> list[str]:
    fields = [section.model_fields[discriminator] for section in sections if discriminator in section.model_fields]
    return sorted({str(tag) for field in fields for tag in get_args(field.annotation)})


def _example_of(key: str, declared: Any) -> str:
    """Return what to write for a dotted key or section of a scene, or a key of [asperities]; empty if there is none."""
    sections, examples = sections_of(declared), [""]
    for name in key.split("."):
        fields = [(section, section.model_fields[name]) for section in sections if name in section.model_fields]
        examples = [f"{name} = {example}" for section, field in fields if (example := _own(section, name, field))]
        sections = [inner for _, field in fields for inner in sections_of(field.annotation)]
    whole = next((table for section in sections if (table := getattr(section, "examples", {}))), {})
    if whole and "." not in key:
        return f"[{key}] " + ", ".join(f"{name} = {value}" for name, value in whole.items())
    return examples[-1] if examples else ""


def _own(section: type[BaseModel], name: str, field: FieldInfo) -> str:
    """Return the example of a key: that of its section, or else its own."""
    reader = None if sections_of(field.annotation) else reader_of((*field.metadata, field.annotation))
    examples = getattr(section, "examples", {}).get(name), *(field.examples or ()), reader.example if reader else ""
    return next(filter(None, examples), "")

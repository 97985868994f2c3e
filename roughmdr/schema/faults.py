"""What pydantic finds wrong with a scene or a section, in words: the dotted key, its value, and what would do."""

import copy
from functools import reduce
from operator import getitem
from typing import Any, get_args

from pydantic import BaseModel, ValidationError

from roughmdr.errors import Fault
from roughmdr.schema.quantities import EntryError
from roughmdr.schema.wording import near, printable, shown, suggestion


def find_faults(error: ValidationError, data: dict[str, Any], declared: Any) -> list[Fault]:
    """All faults that pydantic found in ``data``, which was read as ``declared``, a section or a union of sections."""
    return [_fault(fault, data, declared) for fault in error.errors(include_url=False)]


def with_likely_names(error: ValidationError, data: dict[str, Any], declared: Any) -> dict[str, Any] | None:
    """The data with the names that choose a section replaced by what was probably meant, to find what else is wrong.

    None where there is no such name at fault.
    """
    likely = copy.deepcopy(data)
    renamed = False
    for fault in error.errors(include_url=False):
        if not fault["type"].startswith("union_tag"):
            continue
        keys, _, choices = _walk(fault["loc"], data, declared)
        name = fault["ctx"]["discriminator"].strip("'")
        table = reduce(getitem, keys, likely)
        given = [name] if name in table else near(name, table)
        tags = _tags(choices, name)
        for key in given:
            tag = table[key]
            if meant := [tag] if tag in tags else near(str(tag), tags):
                del table[key]
                table[name] = meant[0]
                renamed = True
    return likely if renamed else None


def sections_of(annotation: Any) -> list[type[BaseModel]]:
    """The sections among which an annotation chooses."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return [annotation]
    return [section for part in get_args(annotation) for section in sections_of(part)]


def _fault(fault: Any, data: dict[str, Any], declared: Any) -> Fault:
    keys, holders, choices = _walk(fault["loc"], data, declared)
    context = fault.get("ctx", {})
    value = "" if isinstance(fault["input"], dict) and fault["type"] == "value_error" else shown(fault["input"])
    match fault["type"]:
        case "misfit":
            return Fault(context["key"], "", context["message"])
        case "extra_forbidden":
            allowed = sorted({name for section in holders for name in section.model_fields})
            return Fault(".".join(keys), "", f"unknown key{suggestion(keys[-1], allowed)}")
        case "missing":
            return Fault(".".join(keys), "", "is missing")
        case "union_tag_not_found" | "union_tag_invalid":
            key = ".".join([*keys, context["discriminator"].strip("'")])
            if fault["type"] == "union_tag_not_found":
                return _missing_tag(keys, context["discriminator"].strip("'"), choices, fault["input"])
            tags = [tag.strip("'") for tag in context["expected_tags"].split(", ")]
            return Fault(key, repr(context["tag"]), f"not available{suggestion(context['tag'], tags)}")
        case "literal_error":
            allowed = [name.strip("'") for name in context["expected"].replace(" or ", ", ").split(", ")]
            return Fault(".".join(keys), value, f"not available{suggestion(str(fault['input']), allowed)}")
        case "value_error" if isinstance(error := context["error"], EntryError):
            given = "" if error.value is None else shown(error.value)
            return Fault(".".join([*keys, error.key]), given, str(error))
        case "value_error":
            return Fault(".".join(keys), value, str(context["error"]))
        case "model_type" | "dict_type" | "model_attributes_type":
            return Fault(".".join(keys), value, "must be a table")
        case _:
            return Fault(".".join(keys), value, fault["msg"][0].lower() + fault["msg"][1:])


def _missing_tag(keys: list[str], name: str, choices: list[type[BaseModel]], table: dict[str, Any]) -> Fault:
    misspelt = near(name, table)
    if misspelt:
        return Fault(".".join([*keys, printable(misspelt[0])]), "", f"unknown key; did you mean {name!r}?")
    return Fault(".".join([*keys, name]), "", f"is missing; it can be {', '.join(_tags(choices, name))}")


def _walk(
    loc: tuple[int | str, ...], data: Any, declared: Any
) -> tuple[list[str], list[type[BaseModel]], list[type[BaseModel]]]:
    """The keys of ``data`` on the way to a fault, the sections that may hold the last of them, and those it may be.

    pydantic's location also names the choice taken in each union; those are no keys.
    """
    keys: list[str] = []
    holders = inner = sections_of(declared)
    for position, item in enumerate(loc):
        last = position == len(loc) - 1
        if isinstance(data, dict) and (item in data or (last and any(item in s.model_fields for s in inner))):
            keys.append(printable(str(item)))
            holders = inner
            inner = [s for holder in holders if item in holder.model_fields for s in _field_sections(holder, str(item))]
            data = data.get(item)
        elif isinstance(data, list) and isinstance(item, int) and item < len(data):
            keys[-1] += f"[{item}]"
            data = data[item]
        else:
            chosen = [s for s in inner if any(get_args(f.annotation) == (item,) for f in s.model_fields.values())]
            inner = chosen or inner
    return keys, holders, inner


def _field_sections(section: type[BaseModel], name: str) -> list[type[BaseModel]]:
    return sections_of(section.model_fields[name].annotation)


def _tags(sections: list[type[BaseModel]], discriminator: str) -> list[str]:
    fields = [section.model_fields[discriminator] for section in sections if discriminator in section.model_fields]
    return sorted({str(tag) for field in fields for tag in get_args(field.annotation)})

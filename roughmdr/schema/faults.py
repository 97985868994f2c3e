"""pydantic's validation errors as faults of a scene: the dotted key, its value, and what is allowed."""

import copy
from collections.abc import Iterable
from functools import reduce
from operator import getitem
from typing import Any, get_args

from pydantic import BaseModel, ValidationError
from pydantic_core import PydanticCustomError

from roughmdr.errors import Fault
from roughmdr.schema.quantities import EntryError
from roughmdr.schema.wording import close_matches, printable, short_repr, suggestion

_Sections = list[type[BaseModel]]
_INCOMPLETE = ("is missing", "needs ", "must be a table")  # beginnings of messages that an example follows
_SECTIONS = {
    "material": {"modulus": '"3 MPa"', "poisson": "0.49"},
    "counter": {"modulus": '"70 GPa"', "poisson": "0.22"},
    "adhesion": {"model": '"jkr"', "work": '"50 mJ/m^2"'},
    "asperities": {
        "source": '"random"',
        "shape": '"paraboloid"',
        "count": "2000",
        "patch": '"1 mm"',
        "height": '{ distribution = "normal", std = "1 um" }',
        "radius": '"50 um"',
    },
    "interaction": {"model": '"pairwise"'},
    "path": {"separation": '{ start = "4 sigma", stop = "0 sigma", steps = 200 }'},
    "accuracy": {"relative": "1e-2"},
}
_KEYS = {
    "asperities.file": '"map.nc"',
    "asperities.second.share": "0.2",
    "asperities.exponent": "2.0",
    "asperities.slope": "0.1",
    "asperities.flat_radius": '"1 um"',
    "asperities.blend_radius": '"1 um"',
    "asperities.cap_radius": '"100 um"',
    "asperities.edge_radius": '"1 um"',
    "asperities.terms": '{ "2" = 1e4, "4" = 1e14 }',
    "asperities.r": '[0, "1 um", "2 um"]',
    "asperities.f": '[0, "10 nm", "50 nm"]',
    "path.separation.start": '"4 sigma"',
    "path.separation.stop": '"0 sigma"',
    "path.separation.steps": "200",
    "path.force.stop": '"1 mN"',
    "path.force.steps": "200",
    "path.pressure.stop": '"1 MPa"',
    "path.pressure.steps": "200",
    "path.remote.stop": '"-2 sigma"',
    "path.remote.steps": "200",
    "path.lateral.steps": "50",
    "path.machine_stiffness": '"1 kN/m"',
    "path.preload": '"1 mN"',
    "path.preload_pressure": '"1 MPa"',
    "path.preload_contact_fraction": "0.02",
    "path.steps": "200",
    **{f"{section}.{key}": value for section, keys in _SECTIONS.items() for key, value in keys.items()},
}


def mismatch(key: str, message: str) -> PydanticCustomError:
    """Return the error that a section raises if ``key``, dotted from the top of the scene, does not go with others."""
    return PydanticCustomError("mismatch", "{message}", {"key": key, "message": message})


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
    outer, _, inner = key.partition(".")
    fields = [section.model_fields[outer] for section in sections_of(declared) if outer in section.model_fields]
    own = {name: value for field in fields for each in sections_of(field.annotation) for name, value in _own(each)}
    if own_section := _SECTIONS.get(key) or (own if not inner else None):
        return f"[{key}] " + ", ".join(f"{name} = {value}" for name, value in own_section.items())
    value = own.get(inner) or _KEYS.get(key) or _KEYS.get(f"asperities.{key}")
    return f"{key.rsplit('.', maxsplit=1)[-1]} = {value}" if value else ""


def _own(section: type[BaseModel]) -> Iterable[tuple[str, str]]:
    return getattr(section, "examples", {}).items()

"""Dotted keys of a scene: those that it can have, the reader of each, and getting and setting one in a table.

A key within an entry of a list has the number of the entry in brackets, from 0: ``viscoelastic.relaxation[0].time``.
"""

import re
from collections.abc import Iterator
from functools import reduce
from operator import getitem
from typing import Any, Literal, get_args, get_origin

from pydantic import BaseModel

from roughmdr.ensemble.random.distribution_reader import DistributionReader
from roughmdr.errors import RoughmdrError
from roughmdr.schema.faults import sections_of
from roughmdr.schema.quantities import Name, Reader, WholeNumber
from roughmdr.schema.section import reader_of
from roughmdr.schema.wording import short_repr, suggestion

_ENTRY = re.compile(r"(.+)\[(\d+)\]")


def key_readers(sections: list[type[BaseModel]], table: Any, prefix: str = "") -> Iterator[tuple[str, Reader]]:
    """Yield every dotted key that takes a number or a name, with its reader.

    ``table`` is the scene so far, which decides between sections that exclude each other.
    """
    data = table if isinstance(table, dict) else {}
    for section in [each for each in sections if _allows(each, data)] or sections:
        for name, field in section.model_fields.items():
            key, value = f"{prefix}{name}", data.get(name)
            inner = sections_of(field.annotation)
            if get_origin(field.annotation) is not list:
                yield from key_readers(inner, value, f"{key}.")
            elif inner:
                for number, entry in enumerate(value if isinstance(value, list) else [None]):
                    yield from key_readers(inner, entry, f"{key}[{number}].")
            reader = reader_of((*field.metadata, field.annotation))
            if reader is not None:
                yield key, reader
            if isinstance(reader, DistributionReader):
                yield f"{key}.distribution", Name()
                yield from ((f"{key}.{inner}", reader.parameter(inner)) for inner in reader.parameters(value))


def set_key(table: dict[str, Any], key: str, value: object) -> None:
    """Set a dotted key; RoughmdrError, naming the part that is no table, if that is impossible."""
    *outer, last = key.split(".")
    for position, part in enumerate(outer):
        before, at = table, ".".join(outer[: position + 1])
        table = entry_at(part, before) if _ENTRY.fullmatch(part) else before.setdefault(part, {})
        if table is None:
            raise RoughmdrError(f"the scene has no {at}")
        if not isinstance(table, dict):
            raise RoughmdrError(f"{at} is not a table")
    table[last] = value


def number_at(
    key: str, readers: dict[str, Reader], table: dict[str, Any], others: tuple[str, ...] = ()
) -> tuple[Reader, float]:
    """Return the reader and the value [SI] of a key that holds one number of a scene, not a whole one; RoughmdrError,
    with what is expected, where it does not: a key, or one of ``others``.
    """
    reader = readers.get(key)
    if reader is None or not reader.dimension:
        numeric = sorted(name for name, each in readers.items() if each.dimension and entry_at(name, table) is not None)
        raise RoughmdrError(f"is no number of the scene that can be varied{suggestion(key, [*numeric, *others])}")
    entry = entry_at(key, table)
    if entry is None:
        raise RoughmdrError("is not in the scene; give it there, with a value")
    if isinstance(reader, WholeNumber):
        raise RoughmdrError("takes whole numbers only, which cannot be varied")
    if isinstance(entry, dict | list):
        raise RoughmdrError(f"is {short_repr(entry)}; name one number in it, like {key}.mean")
    read = reader(entry)
    return reader, float(getattr(read, "constant", read))


def must_be_positive(reader: Reader, value: float) -> bool:
    """Return whether a number, now ``value``, is one that must stay above 0."""
    above, at_least = getattr(reader, "above", None), getattr(reader, "at_least", None)
    try:
        reader(-abs(value) or -1.0)
    except RoughmdrError:
        return (at_least if above is None else above) in (None, 0.0)
    return False


def is_within(key: str, outer: str) -> bool:
    """Return whether a key is another one, or inside it."""
    return key == outer or key.startswith((f"{outer}.", f"{outer}["))


def entry_at(key: str, table: dict[str, Any]) -> Any:
    """Return the entry of a dotted key; None where there is none."""
    parts = list[str | int]()
    for part in key.split("."):
        match = _ENTRY.fullmatch(part)
        parts += [part] if match is None else [match[1], int(match[2])]
    try:
        return reduce(getitem, parts, table)  # type: ignore[arg-type]
    except (IndexError, KeyError, TypeError):
        return None


def _allows(section: type[BaseModel], data: dict[str, Any]) -> bool:
    """Return whether the Literal fields of a section allow the names in ``data``."""
    declared = {name: field.annotation for name, field in section.model_fields.items() if name in data}
    return all(data[name] in get_args(kind) for name, kind in declared.items() if get_origin(kind) is Literal)

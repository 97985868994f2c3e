"""Dotted keys of a scene: those that it can have, the reader of each, and setting one in a table."""

from collections.abc import Iterator
from typing import Any, Literal, get_args, get_origin

from pydantic import BaseModel

from roughmdr.ensemble.random.distribution_reader import DistributionReader
from roughmdr.errors import RoughmdrError
from roughmdr.schema.faults import sections_of
from roughmdr.schema.quantities import Name, Reader
from roughmdr.schema.section import reader_of


def key_readers(sections: list[type[BaseModel]], table: Any, prefix: str = "") -> Iterator[tuple[str, Reader]]:
    """Yield every dotted key that takes a number or a name, with its reader.

    ``table`` is the scene so far, which decides between sections that exclude each other.
    """
    data = table if isinstance(table, dict) else {}
    for section in [each for each in sections if _allows(each, data)] or sections:
        for name, field in section.model_fields.items():
            key, value = f"{prefix}{name}", data.get(name)
            if get_origin(field.annotation) is not list:
                yield from key_readers(sections_of(field.annotation), value, f"{key}.")
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
        table = table.setdefault(part, {})
        if not isinstance(table, dict):
            raise RoughmdrError(f"{'.'.join(outer[: position + 1])} is not a table")
    table[last] = value


def _allows(section: type[BaseModel], data: dict[str, Any]) -> bool:
    """Return whether the Literal fields of a section allow the names in ``data``."""
    declared = {name: field.annotation for name, field in section.model_fields.items() if name in data}
    return all(data[name] in get_args(kind) for name, kind in declared.items() if get_origin(kind) is Literal)

"""Dotted keys: which ones a scene can have, what reads the number or name under each, and how to set one in a table."""

from collections.abc import Iterator
from typing import Any, Literal, NamedTuple, get_args, get_origin

from pydantic import BaseModel, BeforeValidator

from roughmdr.ensemble.random.distribution_reader import DistributionReader
from roughmdr.errors import RoughmdrError
from roughmdr.schema.faults import sections_of
from roughmdr.schema.quantities import Reader


class Name(NamedTuple):
    """Reads a name: of a model, a distribution, a file."""

    dimension: str = ""

    def __call__(self, value: object) -> str:
        """The name."""
        if not isinstance(value, str):
            raise RoughmdrError("expected a name")
        return value


def readers(sections: list[type[BaseModel]], table: Any, at: str = "") -> Iterator[tuple[str, Reader]]:
    """Every dotted key that holds a number or a name, and what reads it.

    ``table`` holds what a scene has so far, which decides between sections that exclude each other.
    """
    data = table if isinstance(table, dict) else {}
    for section in _chosen(sections, data):
        for name, field in section.model_fields.items():
            key, value = f"{at}{name}", data.get(name)
            yield from readers(sections_of(field.annotation), value, f"{key}.")
            reader = _reader((*field.metadata, field.annotation))
            if reader is not None:
                yield key, reader
            if isinstance(reader, DistributionReader):
                yield f"{key}.distribution", Name()
                yield from ((f"{key}.{inner}", reader.parameter(inner)) for inner in reader.parameters(value))


def put(table: dict[str, Any], key: str, value: object) -> None:
    """Set a dotted key; RoughmdrError, with the part of the key that is no table, where it cannot be."""
    *outer, last = key.split(".")
    for position, part in enumerate(outer):
        table = table.setdefault(part, {})
        if not isinstance(table, dict):
            raise RoughmdrError(f"{'.'.join(outer[: position + 1])} is no table")
    table[last] = value


def _chosen(sections: list[type[BaseModel]], data: dict[str, Any]) -> list[type[BaseModel]]:
    """Those sections that take the names in ``data``; all of them where none does."""

    def fits(section: type[BaseModel]) -> bool:
        declared = {name: field.annotation for name, field in section.model_fields.items() if name in data}
        return all(data[name] in get_args(kind) for name, kind in declared.items() if get_origin(kind) is Literal)

    return [section for section in sections if fits(section)] or sections


def _reader(declared: tuple[Any, ...]) -> Reader | None:
    """What reads a field, from its annotation and metadata."""
    for part in declared:
        if isinstance(part, BeforeValidator) and isinstance(part.func, Reader):
            return part.func
    for part in declared:
        if part is str or get_origin(part) is Literal:
            return Name()
        found = None if get_origin(part) in (list, None) else _reader(get_args(part))
        if found is not None:
            return found
    return None

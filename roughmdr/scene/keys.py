"""Dotted keys of a scene: those that it can have, the reader of each, and setting one in a table."""

from collections.abc import Iterator
from typing import Any, Literal, NamedTuple, get_args, get_origin

from pydantic import BaseModel, BeforeValidator

from roughmdr.ensemble.random.distribution_reader import DistributionReader
from roughmdr.errors import RoughmdrError
from roughmdr.schema.faults import sections_of
from roughmdr.schema.json_schema import JsonSchema
from roughmdr.schema.quantities import Reader


class Name(NamedTuple):
    """Reads the name of a model, a distribution or a file."""

    dimension: str = ""

    def __call__(self, value: object) -> str:
        """Return the name."""
        if not isinstance(value, str):
            raise RoughmdrError("expected a name")
        return value

    def json_schema(self) -> JsonSchema:
        """Return the schema of any name."""
        return {"type": "string"}


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
            reader = _reader((*field.metadata, field.annotation))
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


def _reader(declared: tuple[Any, ...]) -> Reader | None:
    """Return the reader of a field from its annotation and metadata, None if it takes no number or name."""
    for part in declared:
        if isinstance(part, BeforeValidator) and isinstance(part.func, Reader):
            return part.func
    for part in declared:
        if part is str or get_origin(part) is Literal:
            return Name()
        inner = None if get_origin(part) in (list, None) else _reader(get_args(part))
        if inner is not None:
            return inner
    return None

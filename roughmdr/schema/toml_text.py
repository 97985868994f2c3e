"""TOML from files, which anyone may have written."""

import tomllib
from typing import Any

_DEEPEST = 32  # tables within tables; a scene has 4
_TOO_DEEP = "its tables are nested too deeply"


def table_of(text: str) -> dict[str, Any]:
    """The table of a TOML text; ValueError where it is none, or nested so deeply that it cannot be walked."""
    try:
        table = tomllib.loads(text)
    except RecursionError:
        raise ValueError(_TOO_DEEP) from None
    inner: list[Any] = [table]
    for _ in range(_DEEPEST):
        inner = [entry for outer in inner for entry in _entries(outer)]
    if inner:
        raise ValueError(_TOO_DEEP)
    return table


def _entries(value: Any) -> list[Any]:
    if isinstance(value, dict):
        return list(value.values())
    return value if isinstance(value, list) else []

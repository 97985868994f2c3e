"""TOML text from any source: its table, and the line of each key, which tomllib does not give."""

import re
import tomllib
from typing import Any

_MAX_DEPTH = 32  # tables within tables; a scene has 4
_TOO_DEEP = "its tables are nested too deeply"
_HEADER = re.compile(r"^\s*\[\s*([^\[\]]+?)\s*\]")
_KEY = re.compile(r"""^\s*((?:[A-Za-z0-9_-]+|"[^"]*"|'[^']*')(?:\s*\.\s*(?:[A-Za-z0-9_-]+|"[^"]*"|'[^']*'))*)\s*=""")
_INLINE_KEY = re.compile(r"[{,]\s*([A-Za-z0-9_-]+)\s*=")
_STRING = re.compile(r'"(?:[^"\\]|\\.)*"|\'[^\']*\'')


def parse_toml(text: str) -> dict[str, Any]:
    """Return the table of a TOML text; ValueError if it is not valid, or nested so deeply that it cannot be walked."""
    try:
        table = tomllib.loads(text)
    except RecursionError:
        raise ValueError(_TOO_DEEP) from None
    level: list[Any] = [table]
    for _ in range(_MAX_DEPTH):
        tables = [outer for outer in level if isinstance(outer, dict | list)]
        level = [entry for outer in tables for entry in (outer.values() if isinstance(outer, dict) else outer)]
    if level:
        raise ValueError(_TOO_DEEP)
    return table


def key_lines(text: str) -> dict[str, int]:
    """Return the line, from 1, of every dotted key and table of a text."""
    lines: dict[str, int] = {}
    table = current = ""
    for number, line in enumerate(text.split("\n"), start=1):
        if header := _HEADER.match(line):
            table = current = unquote_key(header[1])
            lines.setdefault(table, number)
            continue
        if key := _KEY.match(line):
            current = ".".join(part for part in (table, unquote_key(key[1])) if part)
            lines.setdefault(current, number)
        if not line.lstrip().startswith("#"):
            for inline in _INLINE_KEY.finditer(_STRING.sub('""', line)):
                lines.setdefault(f"{current}.{inline[1]}", number)
    return lines


def line_of(key: str, lines: dict[str, int]) -> int | None:
    """Return the line of a key, or of the innermost table around it."""
    while key:
        if key in lines:
            return lines[key]
        key = key[: max(key.rfind("."), key.rfind("["), 0)]
    return None


def unquote_key(key: str) -> str:
    """Return a dotted key without quotes and spaces."""
    return ".".join(part.strip().strip("\"'") for part in key.split("."))

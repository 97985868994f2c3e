"""On which line of a TOML text a key stands. tomllib reads the values but forgets the lines."""

import re

_HEADER = re.compile(r"^\s*\[\s*([^\[\]]+?)\s*\]")
_KEY = re.compile(r"""^\s*((?:[A-Za-z0-9_-]+|"[^"]*"|'[^']*')(?:\s*\.\s*(?:[A-Za-z0-9_-]+|"[^"]*"|'[^']*'))*)\s*=""")
_INLINE_KEY = re.compile(r"[{,]\s*([A-Za-z0-9_-]+)\s*=")
_STRING = re.compile(r'"(?:[^"\\]|\\.)*"|\'[^\']*\'')


def key_lines(text: str) -> dict[str, int]:
    """The line, from 1, of every dotted key and table of a text."""
    lines: dict[str, int] = {}
    table = current = ""
    for number, line in enumerate(text.split("\n"), start=1):
        if header := _HEADER.match(line):
            table = current = _plain(header[1])
            lines.setdefault(table, number)
            continue
        if key := _KEY.match(line):
            current = ".".join(part for part in (table, _plain(key[1])) if part)
            lines.setdefault(current, number)
        if not line.lstrip().startswith("#"):
            for inline in _INLINE_KEY.finditer(_STRING.sub('""', line)):
                lines.setdefault(f"{current}.{inline[1]}", number)
    return lines


def line_of(key: str, lines: dict[str, int]) -> int | None:
    """The line of a key, or of the nearest table around it."""
    while key:
        if key in lines:
            return lines[key]
        key = key[: max(key.rfind("."), key.rfind("["), 0)]
    return None


def _plain(key: str) -> str:
    return ".".join(part.strip().strip("\"'") for part in key.split("."))

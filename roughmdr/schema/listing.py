"""Short descriptions of objects: lines "name  text" for a terminal, and a table of them for a notebook."""

import html
from collections.abc import Iterable

from roughmdr.schema.wording import escape_controls, format_table

_MAX_LENGTH = 160


def listing(lines: Iterable[tuple[str, str]]) -> str:
    """Return lines with their names in a column."""
    return format_table((_short(name), _short(text)) for name, text in lines)


def html_listing(lines: Iterable[tuple[str, str]]) -> str:
    """Return a table without colours of its own, for a light and for a dark page."""
    style = "text-align:left;vertical-align:top;background:none;color:inherit"
    rows = "".join(
        f'<tr style="background:none"><th style="{style}">{html.escape(_short(name))}</th>'
        f'<td style="{style}">{html.escape(_short(text))}</td></tr>'
        for name, text in lines
    )
    return f'<table style="color:inherit">{rows}</table>'


def _short(text: str) -> str:
    line = escape_controls(" ".join(text.split()))
    return line if len(line) <= _MAX_LENGTH else f"{line[: _MAX_LENGTH - 3]}..."

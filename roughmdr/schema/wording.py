"""Parts of messages: values as a scene gives them, names that may have been meant, sizes and times with units."""

import re
from collections import Counter
from collections.abc import Iterable, Iterator

_MIN_SIMILARITY = 0.7  # least ratio of difflib: one or two letters of a word differ
_LAYOUT = "\n\t"
_MAX_LENGTH = 160  # characters of a name, or of a text, in a listing
_NUMBER = re.compile(r"\d[\d.]*(e[+-]?\d+)?")


def close_matches(given: str, allowed: Iterable[str], count: int = 1) -> list[str]:
    """Return the allowed names most like ``given``, whatever their case; never ``given`` itself."""
    import difflib

    folded = {name.strip().casefold(): name for name in allowed if name != given}
    matches = difflib.get_close_matches(given.strip().casefold(), list(folded), n=count, cutoff=_MIN_SIMILARITY)
    return [folded[name] for name in matches]


def suggestion(given: str, allowed: list[str]) -> str:
    """Return the end of a message: the closest allowed name, or else all of them."""
    if matches := close_matches(given, allowed):
        return f"; did you mean {matches[0]!r}?"
    return f"; it can be {', '.join(allowed)}"


def escape_controls(text: str) -> str:
    """Escape every character that a terminal would act on, but newlines and tabs."""
    if text.isprintable():
        return text
    return "".join(letter if letter.isprintable() or letter in _LAYOUT else repr(letter)[1:-1] for letter in text)


def printable(key: str) -> str:
    """Return a key as it is if it prints on one line, else its repr."""
    return key if key.isprintable() else repr(key)


def short_repr(value: object, max_length: int = 60) -> str:
    """Return the repr of a value, cut to ``max_length`` characters."""
    try:
        text = repr(value)
    except (ValueError, RecursionError):  # an integer of thousands of digits, or endlessly nested tables
        return "..."
    return text if len(text) <= max_length else text[: max_length - 3] + "..."


def count_by_cell(lines: Iterable[str], cells: int) -> list[str]:
    """Return each line once, with the number of cells of a sweep that it applies to unless it applies to all."""
    return [
        line if count == cells else f"{line} (in {count} of {cells} cells)" for line, count in Counter(lines).items()
    ]


def merged(lines: Iterable[str]) -> list[str]:
    """Return the first of all lines that differ in numbers only, with the number of others."""
    alike: dict[str, list[str]] = {}
    for line in dict.fromkeys(lines):
        alike.setdefault(_NUMBER.sub("", line), []).append(line)
    return [
        f"{first} ({len(others)} more with other numbers)" if others else first for first, *others in alike.values()
    ]


def under(name: str, lines: Iterable[str]) -> Iterator[tuple[str, str]]:
    """Yield lines of a table that belong to one name, which stands before the first."""
    yield from ((name if number == 0 else "", line) for number, line in enumerate(lines))


def gathered(lines: Iterable[tuple[str, str]]) -> dict[str, list[str]]:
    """Return the texts of lines by their names; one without a name goes on under the name before."""
    found: dict[str, list[str]] = {}
    name = ""
    for title, text in lines:
        name = title or name
        found.setdefault(name, []).append(text)
    return found


def format_table(lines: Iterable[tuple[str, str]]) -> str:
    """Return lines of a name and a text, the names in a column."""
    return "\n".join(f"{name:<12} {text}".rstrip() for name, text in lines)


def listing(lines: Iterable[tuple[str, str]]) -> str:
    """Return the description of an object, lines of a name and a text, for a terminal."""
    return format_table((_short(name), _short(text)) for name, text in lines)


def html_listing(lines: Iterable[tuple[str, str]]) -> str:
    """Return it as a table for a notebook, without colours of its own, for a light and for a dark page."""
    import html

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


def format_seconds(seconds: float) -> str:
    """Format a time in seconds, minutes or hours."""
    if seconds < 99.5:
        return f"{seconds:.2g} s"
    return f"{seconds / 60.0:.3g} min" if seconds < 6000.0 else f"{seconds / 3600.0:.3g} h"


def format_bytes(size: float) -> str:
    """Format a size in bytes, kB, MB or GB."""
    for unit, factor in (("GB", 1e9), ("MB", 1e6), ("kB", 1e3)):
        if size >= factor:
            return f"{size / factor:.3g} {unit}"
    return f"{size:.0f} B"

"""Small parts of messages: values as they stand in a scene, and names that may have been meant."""

from collections import Counter
from collections.abc import Iterable

_NEAR = 0.7  # of difflib's ratio: one or two letters of a word
_LAYOUT = "\n\t"


def near(given: str, allowed: Iterable[str], count: int = 1) -> list[str]:
    """Those of the allowed names that are most like a given one, in whatever case; never the given one itself."""
    import difflib

    folded = {name.strip().casefold(): name for name in allowed if name != given}
    meant = difflib.get_close_matches(given.strip().casefold(), list(folded), n=count, cutoff=_NEAR)
    return [folded[name] for name in meant]


def suggestion(given: str, allowed: list[str]) -> str:
    """The nearest of the allowed names, or else all of them, as the end of a message."""
    meant = near(given, allowed)
    if meant:
        return f"; did you mean {meant[0]!r}?"
    return f"; it can be {', '.join(allowed)}"


def harmless(text: str) -> str:
    """A text, of one line or several, with every character that a terminal would act on as an escape sequence."""
    if text.isprintable():
        return text
    return "".join(letter if letter.isprintable() or letter in _LAYOUT else repr(letter)[1:-1] for letter in text)


def printable(key: str) -> str:
    """A key on one line."""
    return key if key.isprintable() else repr(key)


def shown(value: object, most: int = 60) -> str:
    """A value as it stands in the scene, cut where it has more letters than ``most``."""
    try:
        text = repr(value)
    except (ValueError, RecursionError):  # a whole number of thousands of digits, tables within tables without end
        return "..."
    return text if len(text) <= most else text[: most - 3] + "..."


def in_cells(lines: Iterable[str], cells: int) -> list[str]:
    """Each line once, and in how many of the cells of a sweep it was said, where not in all."""
    return [
        line if count == cells else f"{line} (in {count} of {cells} cells)" for line, count in Counter(lines).items()
    ]


def seconds_in_words(seconds: float) -> str:
    """A time with a unit that suits it."""
    if seconds < 100.0:
        return f"{seconds:.2g} s"
    return f"{seconds / 60.0:.3g} min" if seconds < 6000.0 else f"{seconds / 3600.0:.3g} h"


def bytes_in_words(size: float) -> str:
    """A size with a unit that suits it."""
    for unit, factor in (("GB", 1e9), ("MB", 1e6), ("kB", 1e3)):
        if size >= factor:
            return f"{size / factor:.3g} {unit}"
    return f"{size:.0f} B"

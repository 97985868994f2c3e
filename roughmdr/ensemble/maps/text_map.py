"""Read a height map from a text file: rows of heights, with or without a header, or columns x, y, z."""

import re
from pathlib import Path

from roughmdr.ensemble.maps.columns import is_of_points, map_of_points
from roughmdr.ensemble.maps.instrument import read_instrument, read_with_header
from roughmdr.ensemble.maps.raw_map import RawMap
from roughmdr.ensemble.maps.text_table import Line, TextTable, read_table, text_of
from roughmdr.errors import RoughmdrError

_SAYS = re.compile(r"\w\s*[:=：]|wyko|spip", re.IGNORECASE)  # comments that may be a header
_SIDES = re.compile(r"width|[xy]-length|size", re.IGNORECASE)  # comments that tell sides: the rows are no points
_OF_INSTRUMENTS = ("aISO", "bISO", "aBCR", "bBCR", "fileformat")
"""Beginnings of text formats whose rows are not those of the map."""


def read_text(path: Path, channel: str | None) -> RawMap:
    """Read rows of heights, along y, or along x where a header says size or unit, and in .asc; or columns x, y, z.

    Binary files and text formats of instruments are left to ``read_instrument``.
    """
    text = text_of(path)
    if text is None or text.startswith(_OF_INSTRUMENTS):
        return read_instrument(path, channel)
    table = read_table(text)
    says = any(_SAYS.search(line.text) for line in table.comments)
    if is_of_points(table) and not any(_SIDES.search(line.text) for line in table.comments):
        refuse_channel(channel)
        return map_of_points(table)
    as_asc = path.suffix.lower() == ".asc"
    if says or as_asc:
        found = read_with_header(_normalised(table), channel)
        if as_asc or channel is not None or found.unit is not None or found.spacing is not None:
            return found
    refuse_channel(channel)
    return RawMap(table.numbers)


def refuse_channel(channel: str | None) -> None:
    """RoughmdrError where a channel is asked for of a file that holds one map only."""
    if channel is not None:
        raise RoughmdrError(f"holds one map only; leave out channel = {channel!r}")


def _normalised(table: TextTable) -> str:
    """Return the text of a table with its comments in their places, numbers between blanks, and decimal points."""
    rows = [Line(line, " ".join(map(repr, row))) for line, row in zip(table.lines, table.numbers.tolist(), strict=True)]
    comments = [Line(line, "# " + re.sub(r"(\d),(\d)", r"\1.\2", comment)) for line, comment in table.comments]
    return "\n".join(text for _, text in sorted([*rows, *comments], key=lambda line: line.number)) + "\n"

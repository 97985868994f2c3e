"""Read a table of numbers from a text file, whatever its delimiter, decimal mark and encoding, and its header.

A word of the header stands at the beginning of a line, with or without quotes; a colon, an equals sign, a delimiter or
blanks follow, then the entry. Words are those of Gwyddion, SPIP, Nova, Keyence and ESRI grids; Gwyddion translates its
words into the language of its user.
"""

import math
import re
from collections.abc import Iterable
from pathlib import Path
from typing import NamedTuple

import numpy as np

from roughmdr.errors import RoughmdrError
from roughmdr.numerics.arguments import Floats

_WORDS = {
    "channel": "channel|kan[aá]l|canale?|канал|チャネル|채널|output image data",
    "columns": "ncols|nx|x-pixels|horizontal|w",
    "rows": "nrows|ny|y-pixels|verti[ck]al|h",
    "across": "x-length|width|breite|largeur|larghezza|anchura|largura|šířka|ширина|幅|폭",
    "down": "y-length|height|höhe|hauteur|altezza|altura|výška|высота|高さ|높이",
    "step": "cellsize|pixel[ _]size|xy[ -]calibration|xy-kalibrierung",
    "step_x": "scale x|dx",
    "step_y": "scale y|dy",
    "lateral": "x-unit|unit x|(?:lateral|xy)[ -]units?",
    "unit": "(?:value|z)[ -]units?|(?:wert)?einheit(?:en)?|unit data|unit|unités|unità valore|jednotky hodnot|"
    "unidades de valor|единицы измерения|値の単位|값 단위",
    "factor": "height conversion factor",
    "bit2nm": "bit2nm",
    "undefined": "nodata(?:_value)?",
}
"""Words for numbers of a row and of rows, sides, spacings, units, factors to heights, the mark of undefined points."""
_LINES = {
    name: re.compile(
        rf'"?(?:{words})(?:\s*\((?:->\s*)?([^)]*)\))?"?\s*([:=：;,\t]|\s)[\s"]*(.*?)["\s,;]*', re.IGNORECASE
    )
    for name, words in _WORDS.items()
}
_NUMBER = re.compile(
    r"([-+]?(?:\d+[.,]?\d*|[.,]\d+)(?:e[-+]?\d+)?)"
    r"(?:[\s\",;\[(]*([^\W\d_][^\s\",;\])/]*)(?:\s*/\s*(?:pixel|px))?[\])]*)?",
    re.IGNORECASE,
)
"""A number, and a unit that may stand in quotes or brackets, and be one of a length per pixel."""
_OF_WORDS = ("channel", "lateral", "unit")  # lines with a word; all others have a number
_DELIMITERS = (";", "\t", ",")
_UNDEFINED = ("", "na", "n/a", "null", "none", "bad", "-", "--", "---", "*")  # words for no height, beside nan and inf
_DECIMAL_COMMA = re.compile(r"[-+]?\d*,\d+(?:e[-+]?\d+)?|[-+]?\d+", re.IGNORECASE)
_BYTE_ORDER_MARKS = (b"\xff\xfe", b"\xfe\xff")  # the two of UTF-16
_CONTROL = re.compile(r"[\x00-\x08\x0e-\x1b]")  # characters that binary files have, and texts do not


class Said(NamedTuple):
    """A word, or a number with its unit, on a line of a header."""

    line: int
    text: str
    number: float  # NaN where it says a word
    unit: str | None  # its unit, where it is a number

    @property
    def points(self) -> int:
        """The entry as a number of points; RoughmdrError where it is none."""
        if self.unit or not self.number.is_integer() or self.number < 1.0:
            raise RoughmdrError(f"line {self.line}: {self.text!r} is no number of points")
        return int(self.number)


def read_header(comments: Iterable[tuple[int, str]]) -> dict[str, Said]:
    """Return the entries of numbered lines by the names of ``_WORDS``; the last of two with one name."""
    said = dict[str, Said]()
    for line, comment in comments:
        for name, pattern in _LINES.items():
            match = pattern.fullmatch(comment.strip())
            if match is None:
                continue
            unit, separator, text = match.groups()
            number = _NUMBER.fullmatch(text)
            if name in _OF_WORDS and text and separator != " ":
                said[name] = Said(line, text, math.nan, None)
            elif name not in _OF_WORDS and number is not None:
                said[name] = Said(line, text, float(number[1].replace(",", ".")), number[2] or unit)
    return said


class Line(NamedTuple):
    """A line with its number from 1."""

    number: int
    text: str


class TextTable(NamedTuple):
    """Rows of numbers, with comments and header of the file."""

    numbers: Floats  # NaN for words that stand for no number
    comments: list[Line]  # after #, or before the first row
    lines: list[int]  # numbers of the lines that the rows begin on
    header: dict[str, Said]  # entries on the map in the comments


def text_of(path: Path) -> str | None:
    """Return the text of a file in UTF-8, UTF-16 or Latin-1; None where it is binary."""
    content = path.read_bytes()
    try:
        text = content.decode("utf-16" if content.startswith(_BYTE_ORDER_MARKS) else "utf-8-sig")
    except UnicodeDecodeError:
        text = content.decode("latin-1")
    return None if _CONTROL.search(text) else text


def read_table(text: str) -> TextTable:
    """Return the rows of numbers of a text; RoughmdrError names the line and column that holds none.

    They are separated by semicolons, tabs, commas or blanks. A comma is a decimal mark where it does not separate. A
    delimiter at the end of all lines ends no column. Lines before the first row, and what follows #, are comments.
    Where these say how many numbers a row has, rows may be broken over lines.
    """
    comments, titles, rows = list[Line](), list[Line](), list[Line]()
    for number, line in enumerate(text.splitlines(), 1):
        content, mark, comment = line.partition("#")
        if mark:
            comments.append(Line(number, comment.strip()))
        if not content.strip(" \t,;"):
            continue
        if rows or _holds_numbers(content):
            rows.append(Line(number, content.strip(" ")))
        else:
            titles.append(Line(number, content.strip()))
    if not rows:
        raise RoughmdrError("holds no numbers")
    delimiter = _delimiter(rows[0].text)
    _refuse_mostly_numbers(titles, delimiter, len(rows[0].text.split(delimiter)))
    comments = sorted([*comments, *titles])
    header = read_header(comments)
    numbers = [number for number, _ in rows]
    if delimiter == ",":
        _refuse_two_meanings(rows)
    elif any("," in row for _, row in rows):
        rows = [Line(number, _with_point(number, row)) for number, row in rows]
    if delimiter is not None and all(row.endswith(delimiter) for _, row in rows):
        rows = [Line(number, row[:-1]) for number, row in rows]
    try:
        table = np.loadtxt([row for _, row in rows], delimiter=delimiter, comments=None, ndmin=2)
        counts = [table.shape[1]] * len(table)
    except ValueError:
        by_line = _by_words(rows, delimiter)
        table, counts = np.concatenate(by_line), [len(line) for line in by_line]
    table, lines = _in_rows(table.ravel(), counts, numbers, header)
    return TextTable(table, comments, lines, header)


def _in_rows(values: Floats, counts: list[int], lines: list[int], header: dict[str, Said]) -> tuple[Floats, list[int]]:
    """Return the numbers of lines, so many on each, as rows of equal length, and the lines that these begin on."""
    columns, rows = header.get("columns"), header.get("rows")
    width = counts[0] if columns is None else columns.points
    other = next((k for k, count in enumerate(counts) if count != width), None)
    if other is None:
        return values.reshape(-1, width), lines
    if columns is None:
        hint = "; coordinates in the first row and column are no heights" if other == 1 else ""
        raise RoughmdrError(f"line {lines[other]} has {counts[other]} numbers, but line {lines[0]} has {width}{hint}")
    is_whole = rows is not None and values.size % (width * rows.points) == 0
    if not is_whole or len(counts) == width:  # otherwise rows and columns may be confused
        raise RoughmdrError(
            f"line {lines[other]} has {counts[other]} numbers, but line {columns.line} says {width} a row; all "
            f"{len(counts)} lines have {values.size}"
        )
    return values.reshape(-1, width), np.repeat(lines, counts)[::width].tolist()


def _delimiter(row: str) -> str | None:
    """Return the delimiter of the numbers of a row; None for blanks."""
    found = next((mark for mark in _DELIMITERS if mark in row), None)
    words = row.split()
    return None if found == "," and len(words) > 1 and all(map(_DECIMAL_COMMA.fullmatch, words)) else found


def _holds_numbers(row: str) -> bool:
    """Return whether a line is a row: numbers, or words that stand for one, and at least one number."""
    delimiter = _delimiter(row)
    words = row.strip(" ").split(delimiter)
    values = [_value(word, delimiter) for word in words]
    return None not in values and any(np.isfinite(value) for value in values if value is not None)


def _refuse_mostly_numbers(titles: list[Line], delimiter: str | None, columns: int) -> None:
    """RoughmdrError where a line before the first row, with as many columns, is a row but for some words."""
    for number, title in titles:
        words = title.split(delimiter)
        wrong = [k for k, word in enumerate(words) if _value(word, delimiter) is None]
        if len(words) > 2 * len(wrong) and len(words) == columns > 2:
            raise RoughmdrError(f"line {number}, column {wrong[0] + 1}: {words[wrong[0]].strip()!r} is no number")


def _value(word: str, delimiter: str | None) -> float | None:
    """Return a word as a number, NaN for an undefined one, or None; a comma in it is a decimal mark."""
    word = word.strip().strip('"')
    if word.lower() in _UNDEFINED:
        return np.nan
    if delimiter != "," and "." not in word:
        word = word.replace(",", ".")
    try:
        return float(word)
    except ValueError:
        return None


def _refuse_two_meanings(rows: list[Line]) -> None:
    """RoughmdrError where a comma between numbers may be a decimal mark: whole numbers do not begin with 0."""
    for number, row in rows:
        for column, word in enumerate(row.split(","), 1):
            if re.fullmatch(r"\s*0\d+\s*", word):
                raise RoughmdrError(
                    f"line {number}, column {column}: {word.strip()!r} follows a comma that may be a decimal mark, or "
                    "separate numbers; write decimal points, or separate by semicolons or tabs"
                )


def _with_point(number: int, row: str) -> str:
    """Return a row with decimal points in place of commas; RoughmdrError where it has both."""
    if "." in row and "," in row:
        raise RoughmdrError(f"line {number}: has points and commas, and does not say which is the decimal mark")
    return row.replace(",", ".")


def _by_words(rows: list[Line], delimiter: str | None) -> list[Floats]:
    """Return the numbers of lines word by word."""
    table = list[Floats]()
    for number, row in rows:
        words = row.split(delimiter)
        values = [_value(word, delimiter) for word in words]
        if None in values:
            column = values.index(None)
            raise RoughmdrError(f"line {number}, column {column + 1}: {words[column].strip()!r} is no number")
        table.append(np.array(values, dtype=np.float64))
    return table

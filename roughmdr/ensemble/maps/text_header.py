"""The words by which headers of text files describe a map: those of Gwyddion, SPIP, Nova, Keyence, ESRI grids.

A word stands at the beginning of a line, with or without quotes; a colon, an equals sign, a delimiter or blanks follow,
then the entry. Gwyddion translates its words into the language of its user.
"""

import math
import re
from collections.abc import Iterable
from typing import NamedTuple

from roughmdr.errors import RoughmdrError

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

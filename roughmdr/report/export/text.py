"""The text of an exported file: a document in the syntax of its format."""

import json
import math
import textwrap
from collections.abc import Iterator
from decimal import ROUND_UP, Context
from typing import NamedTuple

from roughmdr.errors import StoreError
from roughmdr.numerics.arguments import Floats
from roughmdr.report.export.formats import Format
from roughmdr.schema.wording import escape_controls
from roughmdr.storage.result_file import EXPORT_MARK

_WIDTH = 108  # characters of a line of the header; CalculiX and Abaqus read more
_GOES_ON = ("\\", "??/")  # ends of lines of C that go on in the next, comments too
_LIST_WIDTH = 116  # characters of a line of a list of numbers


class Column(NamedTuple):
    """A column of numbers."""

    name: str
    unit: str
    values: Floats


class Document(NamedTuple):
    """A table with all that is said about it, in the units asked for."""

    quantity: str
    """Name that ``--quantity`` takes."""
    header: dict[str, str]
    """Names and texts."""
    columns: tuple[Column, ...]
    """The first two are what a code reads: the argument, then the value."""
    friction: float | None = None
    """Coefficient of friction of the scene; None where there is none."""
    tag: str = ""
    """End of the first line, which the code reads."""


def text_of(document: Document, form: Format) -> str:
    """Return the text of a document; StoreError where the code has no option for it, or where friction is missing."""
    if not form.comment:
        return _as_json(document)
    argument, value = document.columns[:2]
    template = form.templates.get(value.name, form.templates.get(""))
    if template is None:
        raise StoreError(
            f"{form.name} has no option for {value.name.replace('_', ' ')}s of a gap; csv and json take them"
        )
    fields = {
        "value": value.name,
        "VALUE": value.name.upper(),
        "count": value.values.size,
        "columns": ",".join(f"{column.name} [{column.unit}]" for column in document.columns),
        "xs": _listed(argument),
        "ys": _listed(value),
    }
    if "{friction" in template.head:
        if document.friction is None:
            needed = "a coefficient of friction: [tangential] friction"
            raise StoreError(f"quantity {document.quantity!r} for {form.name} needs {needed}")
        pressure, stick = float(argument.values[-1]), float(value.values[-1])
        fields |= {"friction": document.friction, "stick": stick, "slip": document.friction * pressure / stick}
    lines = [*_comments(document, form), template.head.format(**fields)]
    if template.row:
        points = zip(*(column.values.tolist() for column in document.columns), strict=True)
        lines += (
            template.row.format(x=point[0], y=point[1], point=point, number=number, all=",".join(map(repr, point)))
            for number, point in enumerate(points, start=1)
        )
    return "\n".join([*lines, *[template.foot.format(**fields)] * bool(template.foot), ""])


def _comments(document: Document, form: Format) -> Iterator[str]:
    """Yield the header as lines of comments in ASCII, first the mark by which an export is known again."""
    yield f"{form.comment} {document.quantity} for {form.name}, {EXPORT_MARK}{document.tag}"
    for name, text in document.header.items():
        spelled = escape_controls(text).replace("\n", "; ").replace("±", "+/-").replace("µ", "u")
        plain = spelled.encode("ascii", "backslashreplace").decode()
        for line in textwrap.wrap(f"{name}: {plain}", _WIDTH, subsequent_indent="    "):
            yield f"{form.comment} {line}{'.' * line.endswith(_GOES_ON)}"


def _listed(column: Column) -> str:
    """Return all numbers of a column in lines."""
    return "\n         ".join(textwrap.wrap(" ".join(map(repr, column.values.tolist())), _LIST_WIDTH))


def _as_json(document: Document) -> str:
    """Return one object: the header, the unit of each column, and the columns; null for what is not known."""
    table = {
        "format": f"{document.quantity} for json, {EXPORT_MARK}",
        "header": document.header,
        "units": {column.name: column.unit for column in document.columns},
        "columns": {
            column.name: [value if math.isfinite(value) else None for value in column.values.tolist()]
            for column in document.columns
        },
    }
    return json.dumps(table, indent=1, ensure_ascii=False, allow_nan=False) + "\n"


def rounded_up(error: float) -> str:
    """Return an error with two digits, rounded up so that it still holds."""
    return f"{float(Context(prec=2, rounding=ROUND_UP).create_decimal(repr(float(error)))):.2g}"

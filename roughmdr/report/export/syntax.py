"""Documents in the syntax of each code: finite-element codes read the first two columns, CSV and JSON hold all.

Options of Abaqus and CalculiX are to be included under *SURFACE INTERACTION. Real constants of contact elements of
Ansys take the name of an array of type TABLE as %NAME%; its primary variable GAP is positive in penetration, PRESSURE
in compression (Mechanical APDL Basic Analysis Guide, tabular real constants).
"""

import json
import math
import textwrap
from collections.abc import Iterator

from roughmdr.errors import StoreError
from roughmdr.report.export.document import Column, Document
from roughmdr.schema.wording import escape_controls
from roughmdr.storage.result_file import EXPORT_MARK

_WIDTH = 108  # characters of a line of the header; CalculiX and Abaqus read more
_MOOSE_WIDTH = 116  # letters of a line of numbers
_NAMES = {"pressure": "PRES", "thermal_conductance": "TCC", "electrical_conductance": "ECC"}  # real constants of Ansys
_OPTIONS = {
    "abaqus": {
        "pressure": "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=TABULAR",
        "thermal_conductance": "*GAP CONDUCTANCE, PRESSURE",
        "electrical_conductance": "*GAP ELECTRICAL CONDUCTANCE, PRESSURE",
    },
    "calculix": {
        "pressure": "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=TABULAR",
        "thermal_conductance": "*GAP CONDUCTANCE",  # its argument is the pressure, without a word for it
    },
}


def write_abaqus(document: Document, code: str = "abaqus") -> str:
    """Return the options of Abaqus, or of CalculiX."""
    lines = list(_comments(document, code, "**"))
    if document.quantity == "tangential":
        return "\n".join([*lines, *_friction(document, code), ""])
    name = _curve(document)
    if name not in _OPTIONS[code]:
        raise StoreError(f"{code} has no option for {name.replace('_', ' ')}s of a gap; csv and json take them")
    pairs = zip(document.value.values.tolist(), document.argument.values.tolist(), strict=True)
    rows = (f"{_number(value)}, {_number(argument)}" for value, argument in pairs)
    return "\n".join([*lines, _OPTIONS[code][name], *rows, ""])


def write_calculix(document: Document) -> str:
    """Return the options of CalculiX."""
    return write_abaqus(document, "calculix")


def write_ansys(document: Document) -> str:
    """Return a table over GAP or PRESSURE: index values in column 0, values in column 1."""
    name = f"ROUGH_{_NAMES[_curve(document)]}"
    primary = "GAP" if document.argument.name == "overclosure" else "PRESSURE"
    lines = [*_comments(document, "ansys", "!"), f"*DIM,{name},TABLE,{document.value.values.size},1,1,{primary}"]
    pairs = zip(document.argument.values.tolist(), document.value.values.tolist(), strict=True)
    for row, (argument, value) in enumerate(pairs, start=1):
        lines += [f"*SET,{name}({row},0),{argument:.15g}", f"*SET,{name}({row},1),{value:.15g}"]
    return "\n".join([*lines, ""])


def write_moose(document: Document) -> str:
    """Return a PiecewiseLinear function, which is called with the argument of the table."""
    head = ["[Functions]", f"  [rough_layer_{document.value.name}]", "    type = PiecewiseLinear"]
    entries = [*_entry("x", document.argument), *_entry("y", document.value)]
    return "\n".join([*_comments(document, "moose", "#"), *head, *entries, "  []", "[]", ""])


def write_csv(document: Document) -> str:
    """Return the header as comments, a line of names with units, and a line for each point."""
    names = ",".join(f"{column.name} [{column.unit}]" for column in document.columns)
    rows = zip(*(column.values.tolist() for column in document.columns), strict=True)
    return "\n".join([*_comments(document, "csv", "#"), names, *(",".join(map(repr, row)) for row in rows), ""])


def write_json(document: Document) -> str:
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


def _comments(document: Document, code: str, start: str) -> Iterator[str]:
    """Yield the header as ASCII lines that begin with ``start``, first the mark by which an export is known again."""
    yield f"{start} {document.quantity} for {code}, {EXPORT_MARK}"
    for name, text in document.header.items():
        spelled = escape_controls(text).replace("\n", "; ").replace("±", "+/-").replace("µ", "u")
        plain = spelled.encode("ascii", "backslashreplace").decode()
        for line in textwrap.wrap(f"{name}: {plain}", _WIDTH, subsequent_indent="    "):
            yield f"{start} {line}"


def _friction(document: Document, code: str) -> Iterator[str]:
    """Yield friction with the elastic slip, or the stick slope, at the largest pressure."""
    if document.friction is None:
        raise StoreError(f"quantity 'tangential' for {code} needs a coefficient of friction: [tangential] friction")
    stiffness, pressure = (float(column.values[-1]) for column in (document.value, document.argument))
    if code == "abaqus":
        yield f"*FRICTION, ELASTIC SLIP={_number(document.friction * pressure / stiffness)}"
        yield _number(document.friction)
    else:
        yield "*FRICTION"
        yield f"{_number(document.friction)}, {_number(stiffness)}"


def _curve(document: Document) -> str:
    return "pressure" if document.quantity == "pressure" else document.variable


def _entry(name: str, column: Column) -> list[str]:
    numbers = textwrap.wrap(" ".join(map(repr, column.values.tolist())), _MOOSE_WIDTH)
    return [f"    {name} = '{numbers[0]}", *(f"         {line}" for line in numbers[1:-1]), f"         {numbers[-1]}'"]


def _number(value: float) -> str:
    """Return a number in the 20 characters that CalculiX reads."""
    return f"{value:.12e}"

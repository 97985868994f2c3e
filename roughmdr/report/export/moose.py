"""Tables as a function block of MOOSE."""

import textwrap

from roughmdr.report.export.comments import comment_lines
from roughmdr.report.export.document import Column, Document

_WIDTH = 116


def write_moose(document: Document) -> str:
    """Return a PiecewiseLinear function, which is called with the argument of the table."""
    lines = [
        *comment_lines(document, "moose", "#"),
        "[Functions]",
        f"  [rough_layer_{document.value.name}]",
        "    type = PiecewiseLinear",
        *_entry("x", document.argument),
        *_entry("y", document.value),
        "  []",
        "[]",
        "",
    ]
    return "\n".join(lines)


def _entry(name: str, column: Column) -> list[str]:
    numbers = textwrap.wrap(" ".join(map(repr, column.values.tolist())), _WIDTH)
    return [f"    {name} = '{numbers[0]}", *(f"         {line}" for line in numbers[1:-1]), f"         {numbers[-1]}'"]

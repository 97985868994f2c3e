"""The variables of a result, from where the package declares them, in place of ``{{ ... variables }}`` on a page."""

from collections.abc import Iterable, Mapping
from typing import Any

from sphinx.application import Sphinx

from roughmdr import variables
from roughmdr.variables.variable import Variable

_TABLES: dict[str, Mapping[str, Variable]] = {
    "{{ curve variables }}": variables.CURVE_VARIABLES,
    "{{ conductances }}": variables.CONDUCTANCES,
    "{{ tangential variables }}": variables.TANGENTIAL_VARIABLES,
    "{{ reference variables }}": variables.REFERENCE_VARIABLES,
    "{{ pull-off variables }}": variables.PULL_OFF_NUMBERS,
    "{{ run diagnostics }}": variables.RUN_DIAGNOSTICS,
}


def setup(app: Sphinx) -> dict[str, Any]:
    """Let Sphinx read pages through ``_fill``."""
    app.connect("source-read", _fill)
    return {"parallel_read_safe": True}


def _fill(app: Sphinx, page: str, text: list[str]) -> None:
    for place, declared in _TABLES.items():
        if place in text[0]:
            text[0] = text[0].replace(place, _table(declared.values()))


def _table(declared: Iterable[Variable]) -> str:
    rows = (f"| `{each.name}` | {each.units} | {each.long_name} |" for each in declared)
    return "\n".join(("| name | unit | meaning |", "|---|---|---|", *rows))

"""The formats of exported files, each declared once."""

import math
from collections.abc import Callable, Mapping
from typing import NamedTuple

from roughmdr.report.export.document import Document
from roughmdr.report.export.syntax import write_abaqus, write_ansys, write_calculix, write_csv, write_json, write_moose

_INCLUDED = "for *INCLUDE under a *SURFACE INTERACTION"
_AS_CALLED = "a function of what it is called with, by default the time; constant beyond its ends"
_BY_NAME = "a table that real constants of contact elements take as %NAME%"
_ALL = dict.fromkeys(("pressure", "conductance", "area", "tangential", "nodes"), "")


class Format(NamedTuple):
    """A format of exported files."""

    name: str
    endings: tuple[str, ...]
    quantities: Mapping[str, str]
    """Quantities that it can hold, each with a note for the header on how the code takes it."""
    write: Callable[[Document], str]
    with_tension: bool = True
    """Whether its tables go on to tension."""
    most_lines: Mapping[str, float] = {}
    """Lines that the code reads, of quantities where they are limited."""
    least_step: float = 0.0
    """Step of the overclosure, in units of the model, below which the code changes it."""


FORMATS = {
    each.name: each
    for each in (
        Format(
            "abaqus",
            (".inp",),
            {
                "pressure": f"{_INCLUDED}; beyond the last line the last slope goes on",
                "conductance": f"{_INCLUDED}; over the contact pressure",
                "tangential": f"{_INCLUDED}; the elastic slip, friction times pressure over stiffness, is that at the "
                "largest pressure",
            },
            write_abaqus,
            with_tension=False,
        ),
        Format(
            "calculix",
            (".inp",),
            {
                "pressure": f"{_INCLUDED}; with *CONTACT PAIR, TYPE=NODE TO SURFACE, since version 2.20 reads no "
                "pressure from tables with TYPE=SURFACE TO SURFACE; constant beyond the last line",
                "conductance": f"{_INCLUDED} with *SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR and *CONTACT PAIR, "
                "TYPE=SURFACE TO SURFACE: in version 2.20 nothing is conducted where the pressure is from a table; "
                "over the contact pressure, constant beyond the last line",
                "tangential": f"{_INCLUDED}; the stick slope is that at the largest pressure",
            },
            write_calculix,
            with_tension=False,
            most_lines={"pressure": 200, "conductance": 20},
            least_step=1e-10,
        ),
        Format(
            "moose",
            (".i",),
            dict.fromkeys(("pressure", "conductance", "area", "tangential"), _AS_CALLED),
            write_moose,
        ),
        Format(
            "ansys",
            (".inp", ".mac"),
            {
                "pressure": f"{_BY_NAME}, GAP positive in penetration; contact elements take no pressure from a table: "
                "it is for USERINTER, or for a stiffness made from it",
                "conductance": f"{_BY_NAME}: TCC, or ECC of an electrical one, over the contact pressure",
            },
            write_ansys,
            with_tension=False,
        ),
        Format("csv", (".csv",), _ALL, write_csv),
        Format("json", (".json",), _ALL, write_json),
    )
}
"""Formats by their names, as --to takes them."""


def most_lines_of(chosen: Format, quantity: str) -> float:
    """Return the number of lines that a code reads of a quantity; inf where there is no limit."""
    return chosen.most_lines.get(quantity, math.inf)

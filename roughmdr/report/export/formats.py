"""The formats of exported files, each declared once: codes and C have two or three columns, CSV and JSON all.

Options of Abaqus and CalculiX are to be included under *SURFACE INTERACTION. Real constants of contact elements of
Ansys take the name of an array of type TABLE as %NAME%; its primary variable GAP is positive in penetration, PRESSURE
in compression (Mechanical APDL Basic Analysis Guide, tabular real constants).
"""

from collections.abc import Mapping
from typing import NamedTuple


class Template(NamedTuple):
    """Lines of a table in the syntax of a code; in braces stand the fields that ``text_of`` fills in."""

    head: str
    """Once: {value}, the name of the variable, in capitals {VALUE}; {count} of points; {xs} and {ys}, all numbers;
    {columns}, all names with units; of friction {friction}, {stick}, the stiffness at the largest pressure, and {slip},
    the elastic slip there.
    """
    row: str = ""
    """For each point: {x}, the argument; {y}, the value; {number}, from 1; {all} numbers, also as {point[0]} and on."""
    foot: str = ""
    """Once, behind the points; fields as in ``head``."""


class Format(NamedTuple):
    """A format of exported files."""

    name: str
    endings: tuple[str, ...]
    comment: str
    """Start of the lines of its header; empty for JSON, whose object holds the header."""
    quantities: Mapping[str, str]
    """Quantities that it can hold, each with a note for the header on how the code takes it: {value}, {VALUE} in it."""
    templates: Mapping[str, Template]
    """By the name of the value, or "" for any."""
    with_tension: bool = True
    """Whether its tables go on to tension."""
    most_lines: Mapping[str, int] = {}
    """Lines that the code reads, of quantities where they are limited."""
    least_step: float = 0.0
    """Step of the overclosure, in units of the model, below which the code changes it."""
    of_distance: bool = False
    """Whether its argument is the distance of two centres, at even steps of its square."""
    tags: Mapping[tuple[float, float], str] = {}
    """Ends of the first line by which the code knows its units, by the sizes of length and force in SI."""


_INCLUDED = "for *INCLUDE under a *SURFACE INTERACTION"
_AS_CALLED = "a function of what it is called with, by default the time; constant beyond its ends"
_BY_NAME = "a table that real constants of contact elements take as %NAME%"
_ALL = {
    **dict.fromkeys(("pressure", "loss", "conductance", "area", "tangential", "nodes"), ""),
    "force": "tangent_stiffness is the slope over the neighbouring steps of the path, jumps of contacts included, "
    "which the variable stiffness leaves out; tangent_stiffness_error, estimated from the second neighbours, is six "
    "times that of a smooth law and as large as that by a jump; tangent_stiffness_standard_error is that of the mean "
    "over the realisations",
}
_PAIR = "{y:.12e}, {x:.12e}"  # numbers in the 20 characters that CalculiX reads
_FUNCTION = """\
[Functions]
  [rough_layer_{value}]
    type = PiecewiseLinear
    x = '{xs}'
    y = '{ys}'
  []
[]"""


_HEADER = """\
#include <math.h>
#include <stddef.h>

#ifndef ROUGH_{VALUE}
#define ROUGH_{VALUE} rough_{value}
#endif

static inline double ROUGH_{VALUE}(double x, double *slope)
{{
    static const double table[][2] = {{"""
_SEARCH = """\
    }};
    size_t first = 0, last = {count} - 1;
    double s = 0.0, y = 0.0;
    if (!(x <= table[last][0])) {{
        s = y = NAN;
    }} else if (x >= table[0][0]) {{
        while (last - first > 1) {{
            const size_t middle = (first + last) / 2;
            if (table[middle][0] <= x)
                first = middle;
            else
                last = middle;
        }}
        s = (table[last][1] - table[first][1]) / (table[last][0] - table[first][0]);
        y = table[first][1] + s * (x - table[first][0]);
    }}
    if (slope)
        *slope = s;
    return y;
}}
#undef ROUGH_{VALUE}"""
_IN_C = (
    "rough_{value}(x, slope) in C99 and C++11: the value at x and, where slope is no null pointer, its derivative; 0 "
    "before the first point, NAN beyond the last, where the law is not known; to be included once in a source file; to "
    "give the function another name, and to include two tables, define ROUGH_{VALUE} before #include"
)


def _array(name: str, primary: str) -> Template:
    """Return the template of an array of Ansys: index values in column 0, values in column 1."""
    row = f"*SET,{name}({{number}},0),{{x:.15g}}\n*SET,{name}({{number}},1),{{y:.15g}}"
    return Template(f"*DIM,{name},TABLE,{{count}},1,1,{primary}", row)


FORMATS = {
    each.name: each
    for each in (
        Format(
            "abaqus",
            (".inp",),
            "**",
            {
                "pressure": f"{_INCLUDED}; beyond the last line the last slope goes on",
                "conductance": f"{_INCLUDED}; over the contact pressure",
                "tangential": f"{_INCLUDED}; the elastic slip, friction times pressure over stiffness, is that at the "
                "largest pressure",
            },
            {
                "pressure": Template("*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=TABULAR", _PAIR),
                "thermal_conductance": Template("*GAP CONDUCTANCE, PRESSURE", _PAIR),
                "electrical_conductance": Template("*GAP ELECTRICAL CONDUCTANCE, PRESSURE", _PAIR),
                "tangential_stiffness": Template("*FRICTION, ELASTIC SLIP={slip:.12e}\n{friction:.12e}"),
            },
            with_tension=False,
        ),
        Format(
            "calculix",
            (".inp",),
            "**",
            {
                "pressure": f"{_INCLUDED}; with *CONTACT PAIR, TYPE=NODE TO SURFACE, since version 2.20 reads no "
                "pressure from tables with TYPE=SURFACE TO SURFACE; constant beyond the last line",
                "conductance": f"{_INCLUDED} with *SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR and *CONTACT PAIR, "
                "TYPE=SURFACE TO SURFACE: in version 2.20 nothing is conducted where the pressure is from a table; "
                "over the contact pressure, constant beyond the last line",
                "tangential": f"{_INCLUDED}; the stick slope is that at the largest pressure",
            },
            {
                "pressure": Template("*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=TABULAR", _PAIR),
                "thermal_conductance": Template("*GAP CONDUCTANCE", _PAIR),  # its argument is the pressure
                "tangential_stiffness": Template("*FRICTION\n{friction:.12e}, {stick:.12e}"),
            },
            with_tension=False,
            most_lines={"pressure": 200, "conductance": 20},
            least_step=1e-10,
        ),
        Format(
            "moose",
            (".i",),
            "#",
            dict.fromkeys(("pressure", "conductance", "area", "tangential"), _AS_CALLED),
            {"": Template(_FUNCTION)},
        ),
        Format(
            "ansys",
            (".inp", ".mac"),
            "!",
            {
                "pressure": f"{_BY_NAME}, GAP positive in penetration; contact elements take no pressure from a table: "
                "it is for USERINTER, or for a stiffness made from it",
                "conductance": f"{_BY_NAME}: TCC, or ECC of an electrical one, over the contact pressure",
            },
            {
                "pressure": _array("ROUGH_PRES", "GAP"),
                "thermal_conductance": _array("ROUGH_TCC", "PRESSURE"),
                "electrical_conductance": _array("ROUGH_ECC", "PRESSURE"),
            },
            with_tension=False,
        ),
        Format(
            "c",
            (".h",),
            "//",
            dict.fromkeys(("pressure", "force", "conductance", "area", "tangential"), _IN_C),
            {"": Template(_HEADER, "        {{{x!r}, {y!r}}},", _SEARCH)},
        ),
        Format(
            "lammps",
            (".table",),
            "#",
            {
                "force": "pair_style table linear N, with the number N of the points, and pair_coeff 1 1 FILE "
                "ROUGH_FORCE; or fix wall/table linear N zlo 0.0 FILE ROUGH_FORCE CUTOFF; no force beyond the last "
                "point; pairs closer than the first are an error"
            },
            {"": Template("\nROUGH_FORCE\nN {count}\n", "{number} {x!r} {point[2]!r} {y!r}")},
            of_distance=True,
            tags={(1.0, 1.0): "; UNITS: si", (1e-6, 1e-9): "; UNITS: micro", (1e-9, 1e-12): "; UNITS: nano"},
        ),
        Format("csv", (".csv",), "#", _ALL, {"": Template("{columns}", "{all}")}),
        Format("json", (".json",), "", _ALL, {}),
    )
}
"""Formats by their names, as --to takes them."""

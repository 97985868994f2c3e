"""The header of an exported file: where the numbers come from, and within which errors they hold."""

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from roughmdr.numerics.arguments import Floats
from roughmdr.report.contacts import conduction_lines, contact_pressure_lines
from roughmdr.report.export.law import Law, Quantity
from roughmdr.report.export.part import whole_lines
from roughmdr.report.export.table import RELATIVE_FROM, Table
from roughmdr.report.export.text import rounded_up
from roughmdr.report.export.units import UnitSystem
from roughmdr.result.between import CONFIDENCE
from roughmdr.result.model_errors import error_of_mean
from roughmdr.result.trust import trust_of_result
from roughmdr.result.view import ResultView
from roughmdr.schema.wording import gathered
from roughmdr.variables import CONDUCTANCES, TIME

SEATING = 0.01
"""Seating pressure over the largest: where a law begins exponentially, first touch is a matter of chance."""
_FEWEST = 4  # steps above the seating pressure
_WIDEST = 12.0
"""Largest log(v_m/v - 1), in size, at the largest closure v: beyond it the hyperbola is vertical there, or straight."""


class Hyperbola(NamedTuple):
    """Constants of p = k_ni v/(1 - v/v_m), p and v from a seating pressure on."""

    stiffness: float
    """k_ni [Pa/m]."""
    closure: float
    """v_m [m]."""
    misfit: float
    """Largest deviation of the hyperbola from the pressure, over the largest."""
    seating: float
    """Seating pressure [Pa]."""


def hyperbola(separation: Floats, pressure: Floats) -> Hyperbola | None:
    """Return the hyperbola of least squares of the pressure over the closure; None where too few steps are loaded.

    It is the normal closure of rock joints: S. C. Bandis, A. C. Lumsden, N. R. Barton, Int. J. Rock Mech. Min. Sci. 20
    (1983) 249.
    """
    seating = SEATING * float(pressure.max())
    loaded = np.flatnonzero(pressure > seating)
    if loaded.size < _FEWEST or loaded[0] == 0:
        return None
    first = int(loaded[0])
    datum = np.interp(seating, pressure[first - 1 : first + 1], separation[first - 1 : first + 1])
    v, p = (np.append(0.0, values) for values in (datum - separation[first:], pressure[first:] - seating))
    closure, largest, weight = float(v[-1]), float(p.max()), np.gradient(v)
    v, p, room, width = v / closure, p / largest, 0.0, _WIDEST
    while width > 1e-9:
        rooms = room + width * np.linspace(-1.0, 1.0, 41)
        shapes = v / (1.0 - v / (1.0 + np.exp(rooms[:, None])))
        slopes = (weight * shapes * p).sum(axis=1) / (weight * shapes * shapes).sum(axis=1)
        off = slopes[:, None] * shapes - p
        best = int(np.argmin((weight * off * off).sum(axis=1)))
        room, width = float(rooms[best]), width / 10.0
    room = 1.0 + float(np.exp(room))
    return Hyperbola(float(slopes[best]) * largest / closure, closure * room, float(np.abs(off[best]).max()), seating)


def origin_lines(cell: ResultView, words: str) -> Iterator[tuple[str, str]]:
    """Yield the scene, the swept values in ``words``, the key of one cell and the version of a result."""
    yield "scene", cell.attrs["title"]
    if words:
        yield "cell", words
    if "cell_key" in cell.coordinates and cell.coordinates["cell_key"].values.size == 1:
        yield "key", str(cell.coordinates["cell_key"].values.item())
    yield "made by", f"{cell.attrs['source']}, seed {cell.attrs['seed']}"


def mean_lines(result: ResultView) -> Iterator[tuple[str, str]]:
    """Yield the number of realisations of a mean, in the cells that have some, and the numerical error of the law."""
    if result.keeps_runs:
        counts = result.done.sum(axis=-1)
    else:
        counts = getattr(result.variables.get("realization_count"), "values", np.array(result.realizations))
    some = counts[counts > 0]
    fewest, most = (int(some.min()), int(some.max())) if some.size else (0, 0)
    number = f"{most}" if fewest == most else f"{fewest} to {most}"
    yield "law", "expected law" if result.estimator == "expected" else f"mean of {number} realisation{'s' * (most > 1)}"
    if result.known("numerical_error").size:
        yield "numerical error", f"force within {result.largest('numerical_error'):.2g} of the largest"


def table_lines(
    cell: ResultView, table: Table, quantity: Quantity, law: Law, units: UnitSystem
) -> Iterator[tuple[str, str]]:
    """Yield what the numbers of a table are, and their errors."""
    yield from mean_lines(cell)
    yield "branch", table.law.rule
    variable, unit = law.source.variable, units.of(law.source.dimension).name
    per_area = "" if quantity.whole or variable in ("pressure", "contact_fraction") else " per nominal area"
    yield "quantity", f"{variable}{per_area}{f' in {unit}' if unit != '1' else ''}"
    length, pressure = units.length, units.stress
    yield "units", units.names
    if "nominal_area" in cell.variables:
        yield "nominal area", f"{cell.variables['nominal_area'].values.item() / length.size**2:.15g} {length.name}^2"
    datum, pressed = table.law.datum / length.size, "flat" if cell.flat else "undeformed body"
    minus = f"minus the separation of the {pressed} from the datum plane of heights"
    yield "datum", f"overclosure is {datum:.15g} {length.name} {minus}"
    yield "points", f"{table.law.overclosure.size}, of {table.steps} steps"
    over = "the pressure" if quantity.over_pressure else "the overclosure"
    yield (
        "interpolation error",
        f"lines over {over} are within {rounded_up(table.error)} of the largest value, and where that is above "
        f"{RELATIVE_FROM:g} of it within {rounded_up(table.relative_error)} of the value itself, jumps between the "
        f"steps included: estimated from the steps, which holds in {100 * CONFIDENCE:g} % of cases",
    )
    if math.isfinite(table.statistical_error):
        yield "statistical error", f"of the mean up to {table.statistical_error:.2g} of the largest value"
    if quantity.name == "pressure" and (joint := hyperbola(law.separation, law.pressure)):
        yield (
            "Barton-Bandis",
            f"p = k_ni v/(1 - v/v_m) with k_ni = {joint.stiffness / pressure.size * length.size:.4g} {pressure.name}/"
            f"{length.name} and v_m = {joint.closure / length.size:.4g} {length.name}, p and v from a pressure of "
            f"{joint.seating / pressure.size:.4g} {pressure.name} on ({SEATING:.0%} of the largest), is off by up to "
            f"{joint.misfit:.2g} of the largest",
        )
    if quantity.whole:
        yield from whole_lines(cell, table.law, law, units)
    if table.law.departure > 0.0:
        departure = f"{table.law.departure / pressure.size:.3g} {pressure.name}"
        yield "departure", f"up to {departure} at steps that a load jumps over"
    yield from model_lines(cell)
    if quantity.name == "area":
        error = error_of_mean(cell, variable)
        value = cell.mean(variable)[0]
        closest = np.unravel_index(np.nanargmax(value), value.shape)
        if np.isfinite(share := error[closest] / value[closest]):
            yield "error of the area", f"at given separation within about {100.0 * share:.2g} % at closest approach"
    yield from contact_pressure_lines(cell)
    if variable in CONDUCTANCES:
        yield from conduction_lines(cell)
    if TIME.name in cell.coordinates:
        yield "motion", "the law of a viscoelastic body at the speed of the scene: at another speed it is another"
    if table.warnings:
        yield "warning", "; ".join(table.warnings)


def model_lines(cell: ResultView) -> Iterator[tuple[str, str]]:
    """Yield the error of the model and up to where it holds, a line for each name."""
    yield from ((name, "; ".join(texts)) for name, texts in gathered(trust_of_result(cell)).items())

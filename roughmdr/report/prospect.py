"""Says of a plan what is physical: its path, the contacts and pressures to expect, and how far they can be trusted."""

import math
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING

import numpy as np

from roughmdr.ensemble.maps.words import IMPLAUSIBLE
from roughmdr.result.hardness import hardness_lines
from roughmdr.result.trust import trust_lines
from roughmdr.schema.units import format_quantity
from roughmdr.variables import YIELDED, YIELDING

if TYPE_CHECKING:
    from roughmdr.batch.foresee import Foreseen, Prospect
    from roughmdr.batch.plan import Plan

_ROUNDING = 1e-9  # difference of pressures, over the largest, that is rounding
_HARDEST = 1e11  # hardness of diamond [Pa]; no mean pressure of a contact is larger


def prospect_lines(prospect: "Prospect") -> Iterator[tuple[str, str]]:
    """Yield the lines of the cells that were foreseen; only that nothing is known where none could be."""
    cells = prospect.foreseen
    if not cells:
        yield "trust", "not known: no cell that was tried can be computed"
        return

    def over_cells(unit: str, value: "Callable[[Foreseen], float]") -> str:
        values = [value(cell) for cell in cells]
        return format_quantity(min(values), unit, to=max(values))

    start = over_cells("m", lambda cell: float(cell.path.separation[0]))
    closest = over_cells("m", lambda cell: float(cell.path.separation.min()))
    returns = any(cell.path.separation[-1] > cell.path.separation.min() for cell in cells)
    end = over_cells("m", lambda cell: float(cell.path.separation[-1]))
    if all(np.ptp(cell.path.separation) == 0.0 for cell in cells):
        yield "path", f"at h = {start}"
    else:
        yield "path", f"from h = {start} down to {closest}{f', and back to {end}' if returns else ''}"
    if all("pressure" in cell.law.variables for cell in cells):
        paired = prospect.interaction is not None and prospect.interaction.model == "pairwise"
        told = "estimated from a small part of the asperities" if paired else "as expected"
        if lost := sum(math.isnan(pressure_at_closest(cell)) for cell in cells):
            none = f"no equilibrium is found there in {lost} of {len(cells)} cells"
            yield "pressure", f"not known at closest approach: {none}"
        else:
            yield "pressure", f"{over_cells('Pa', pressure_at_closest)} at closest approach, {told}"
        if any(largest_tension(cell) > 0.0 for cell in cells):
            yield "", f"{over_cells('Pa', largest_tension)} is about the largest tension"
    tabor = min(cell.law.tabor for cell in cells)
    if tabor < math.inf:
        yield "adhesion", f"Tabor number from {tabor:.3g} on: {', '.join(sorted({cell.law.model for cell in cells}))}"
    names = cells[0].law.model_error.named
    numbers = {name: np.array([cell.law.model_error.named[name] for cell in cells]) for name in names}
    numbers["grid_points"] = np.array([cell.law.grid_points for cell in cells])
    model = None if prospect.interaction is None else prospect.interaction.model
    advise = prospect.coupled_seconds < math.inf
    curved = all("nominal_contact_radius" in cell.law.variables for cell in cells)
    at_pull_off = [cell.fraction_at_pull_off for cell in cells]
    summits = all(cell.summits for cell in cells)
    yield from trust_lines(numbers, at_pull_off, interaction=model, advise=advise, curved=curved, summits=summits)
    marked = sum(cell.law.marked_steps > 0.0 for cell in cells)
    if marked and prospect.interaction is not None:
        on_grid = prospect.interaction.beyond == "boundary_elements"
        becomes = "realisations are computed by boundary elements" if on_grid else "steps are marked"
        yield "", f"too much overlap or contact for pairs in {marked} of {len(cells)} cells: {becomes}"
    touches = any(cell.law.model_error.named["largest_contact_fraction"] > 0.0 for cell in cells)
    if model is None and touches and advise:
        parts = any(not math.isnan(cell.fraction_at_pull_off) for cell in cells)
        how = 'with [interaction] model = "pairwise" it would be found ' if parts else ""
        yield "", f"{how}at about {format_quantity(prospect.coupled_seconds, 's')} a realisation on one core"
    of_cells = [cell.law.yielding() for cell in cells]
    names_of_yielding = (*YIELDING, *YIELDED)
    yield from hardness_lines({name: [each.get(name, math.nan) for each in of_cells] for name in names_of_yielding})


def pressure_at_closest(cell: "Foreseen") -> float:
    """Return the pressure of a cell with a nominal area at its closest approach [Pa]; NaN without an equilibrium."""
    return float(cell.law.variables["pressure"][np.argmin(cell.path.separation)])


def largest_tension(cell: "Foreseen") -> float:
    """Return the largest tension of a cell with a nominal area [Pa]; 0 for none, or for what is but rounding."""
    pressure = cell.law.variables["pressure"]
    tension = -float(np.nanmin(pressure, initial=0.0))
    return tension if tension > _ROUNDING * float(np.nanmax(pressure, initial=0.0)) else 0.0


def implausible_lines(plan: "Plan", prospect: "Prospect") -> list[str]:
    """Return what is implausible of the maps of a plan, and of the mean pressure in its contacts."""
    lines = [text for text in plan.map_lines if IMPLAUSIBLE in text]
    for cell in prospect.foreseen:
        pressure, modulus = _mean_in_contacts(cell), plan.cells[cell.cell].scene.effective_modulus
        if pressure > min(_HARDEST, modulus):
            limit = "E*" if modulus < _HARDEST else "the hardness of diamond"
            bear = f"contacts would bear {format_quantity(pressure, 'Pa')} on average at closest approach, more than"
            return [*lines, f"a {IMPLAUSIBLE}: {bear} {limit}, {format_quantity(min(_HARDEST, modulus), 'Pa')}"]
    return lines


def _mean_in_contacts(cell: "Foreseen") -> float:
    """Return the mean pressure in the contacts at closest approach [Pa]; 0 where it is not known."""
    variables = cell.law.variables
    if not {"pressure", "contact_fraction"} <= variables.keys():
        return 0.0
    closest = int(np.argmin(cell.path.separation))
    pressure, fraction = (float(variables[name][closest]) for name in ("pressure", "contact_fraction"))
    return pressure / fraction if fraction > 0.0 else 0.0

"""Implausible numbers of a plan: sizes and units of maps, and pressures in contacts that no solid bears."""

from typing import TYPE_CHECKING

import numpy as np

from roughmdr.ensemble.maps.plausible import IMPLAUSIBLE
from roughmdr.schema.units import format_quantity

if TYPE_CHECKING:
    from roughmdr.batch.foresee import Foreseen, Prospect
    from roughmdr.batch.plan import Plan

_HARDEST = 1e11  # hardness of diamond [Pa]; no mean pressure of a contact is larger


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

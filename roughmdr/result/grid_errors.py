"""The error by the grid of a reference by boundary elements, where its curves are read.

At given force a curve has the error of the cells at the edges of contacts alone: that of the contact area, and half of
it in the stiffness, which goes with the root of the area of a contact. At anything else the error of what is given is
added in quadrature: at given separation, or a quantity of the asperities, that of the force; at given area its own.
"""

from typing import TYPE_CHECKING

import numpy as np

from roughmdr.result.curves import Read
from roughmdr.stages.reference import OF_AREA
from roughmdr.variables import LAW_VARIABLES, SEPARATION

if TYPE_CHECKING:
    import xarray as xr

_FORCE, _H = "reference_force", SEPARATION.name


def grid_errors(read: dict[str, Read], at: str) -> "dict[str, xr.DataArray]":
    """Return ``reference_NAME_error`` of curves that are read where that of ``at`` has a value.

    The separation has one where ``at`` is of the reference. No value where the grid may have missed all contacts.
    """
    if not {_FORCE, "reference_error", "reference_area_error"} <= read.keys():
        return {}
    force, relative = read[_FORCE].value, read["reference_error"].value
    of_force = (relative * force).where((force > 0.0) | (relative == 0.0))

    def slope(name: str, over: str) -> "xr.DataArray":
        run, base = read[over].rise, read[over].value
        where_path_turns = read[name].value / base.where(base > 0.0, np.inf) if name in OF_AREA else np.nan
        return abs(read[name].rise / run.where(run != 0.0)).where(run != 0.0, where_path_turns)

    def own(name: str) -> "xr.DataArray":
        if name == _H:
            return slope(_H, _FORCE) * of_force
        return OF_AREA[name] * read["reference_area_error"].value * read[name].value

    of_reference = at in OF_AREA
    over, given = (at, own(at)) if of_reference else (_FORCE, of_force)
    errors = {}
    for name in sorted((read.keys() & {*OF_AREA, *([_H] * of_reference)}) - {at}):
        total = (own(name) ** 2 + (slope(name, over) * given) ** 2) ** 0.5
        total *= OF_AREA.get(name) != OF_AREA.get(at)  # pressure follows from force, the fraction from the area
        about = f"error of the {name.removeprefix('reference_').replace('_', ' ')} by the grid of boundary elements"
        total.attrs = {"units": LAW_VARIABLES[name].units, "long_name": about}
        errors[f"reference_{read[name].label.removeprefix('reference_')}_error"] = total
    return errors

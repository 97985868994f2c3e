"""The path to a preload and back: the turning point at the preload, and the separation that leaves no contact."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from roughmdr.aggregate.law import LoadSeparation
from roughmdr.errors import OutOfRange
from roughmdr.loading.first_reached import OutOfReach, first_reached
from roughmdr.loading.machine import FIXED_GRIPS, MachinePath
from roughmdr.numerics.arguments import Floats

_RTOL = 1e-14  # error of the separation, over its distance from clear
_POINTS = 64  # separations of the unloading whose largest tension is sought; it is refined between them
_MARGIN = 1.01  # rise of the machine above clear, over the stretch of its spring by that tension: 1 would just do
_MAX_RAISES, _RAISE = 40, 0.25  # trials of a clear separation, and rise of each over its distance from the turn


class Specimen(NamedTuple):
    """Asperities that are to be loaded to a preload."""

    law: Callable[[MachinePath, list[str]], LoadSeparation]
    """(path, names of variables) -> the law with these variables and the separation."""
    clear: float
    """A separation [m] at which independent asperities neither touch nor attract, and detach below."""
    depth: float
    """A usual indentation [m]."""
    area: float | None
    """The nominal area [m2]."""
    sticky: bool
    """Whether they may detach above ``clear``: then a clear separation is sought from there on."""


def to_preload(path: MachinePath, specimen: Specimen) -> MachinePath:
    """Return the path with the demand of its machine at each travel.

    OutOfRange where the preload is not reached, or where the contacts do not detach.
    """
    assert path.preload is not None
    turn, lowest = _turning_point(path, specimen)
    clear = specimen.clear
    if path.adhesive and (specimen.sticky or path.machine != FIXED_GRIPS):
        clear, tension = _unloaded(specimen, lowest)
        clear += _MARGIN * path.machine.compliance * tension
    return path.between(clear, turn)


def _turning_point(path: MachinePath, specimen: Specimen) -> tuple[float, float]:
    """Return the demand of the machine at the preload [m], and the separation there [m]."""
    (quantity, value), machine = path.preload or ("", 0.0), path.machine
    if quantity != "contact_fraction":
        control = MachinePath.along(quantity, np.array([value]), area=specimen.area or 1.0, adhesive=path.adhesive)
        separation = specimen.law(control, ["separation"]).variables["separation"]
        return float(machine.demand(separation, -control.demand)[0]), float(separation[0])

    def fraction(far: Floats) -> Floats:
        demand = np.append(specimen.clear, far)
        moved = MachinePath(path.control, demand, demand, machine, path.adhesive)
        return specimen.law(moved, [quantity]).variables[quantity][1:]

    try:
        turn = first_reached(fraction, value, specimen.clear, specimen.depth, _RTOL, "contact fraction")
    except OutOfReach as error:
        raise OutOfRange(f"preload_contact_fraction = {value:g}: {error}") from None
    return turn, turn


def _unloaded(specimen: Specimen, lowest: float) -> tuple[float, float]:
    """Return a separation [m] at which no contact is left after one at ``lowest`` [m], and the tension [N] before."""
    clear = specimen.clear
    for _ in range(_MAX_RAISES):
        way = np.concatenate([[clear], np.linspace(lowest, clear, _POINTS)])
        pull_off = specimen.law(MachinePath("separation", way, way, FIXED_GRIPS, adhesive=True), ["force"]).pull_off
        if not np.isnan(pull_off.force):
            return clear, abs(pull_off.force)
        clear += _RAISE * (clear - lowest)
    raise OutOfRange("preload: the contacts do not detach")

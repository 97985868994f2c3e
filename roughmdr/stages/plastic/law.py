"""The law of asperities that yield along a path: of the flat, or of the machine that moves it."""

from typing import TYPE_CHECKING, Union

import numpy as np

from roughmdr.aggregate.law import LoadSeparation
from roughmdr.aggregate.preload import Specimen, to_preload
from roughmdr.aggregate.simulate import OF_MACHINE, with_place
from roughmdr.aggregate.totals import FORCE, STIFFNESS
from roughmdr.errors import OutOfRange
from roughmdr.loading.machine import FIXED_GRIPS, MachinePath
from roughmdr.loading.path import LoadingPath
from roughmdr.loading.steady_passage import ForceAndStiffness, separations_of
from roughmdr.numerics.arguments import Floats
from roughmdr.stages.plastic.drawn import DrawnAsperities

if TYPE_CHECKING:
    from roughmdr.stages.plastic.mean import MeanAsperities

Asperities = Union[DrawnAsperities, "MeanAsperities"]
"""Asperities that yield: drawn ones, or the mean over them."""
_ERROR = 1e-12  # error of a load under a machine, over it, and of a separation over a usual indentation
_FIRST, _DEEPEST = 2.0**-6, 2.0**60  # first and last step to deeper contact, over a usual indentation
_ROUNDINGS = 2.0**-50  # relative rounding of a separation at which contacts part


def plastic_law(asperities: Asperities, path: LoadingPath | MachinePath, names: list[str]) -> LoadSeparation:
    """Return the law with these variables, under a machine with the separation too; OutOfRange as ``totals``.

    Contacts may adhere under a machine only on the way to a preload without a spring, and back.
    """
    if isinstance(path, LoadingPath):
        return asperities.law(path, names)

    def under(path: MachinePath, names: list[str]) -> LoadSeparation:
        while True:
            order = asperities.order
            separation = path.demand if path.machine == FIXED_GRIPS else _separations(asperities, path)
            way = np.where(np.isinf(separation), asperities.first_touch, separation)
            along = LoadingPath.along(way, unload=False, adhesive=path.adhesive)
            law = asperities.law(along, [name for name in names if name not in OF_MACHINE])
            if asperities.order == order:
                return with_place(law, separation, path).only(names)

    if path.preload is not None:
        if asperities.depth == 0.0:
            raise OutOfRange("path: without asperities no preload is reached")
        area = asperities.nominal_area
        path = to_preload(path, Specimen(under, asperities.first_touch, asperities.depth, area, sticky=path.adhesive))
    return under(path, names)


def _separations(asperities: Asperities, path: MachinePath) -> Floats:
    """Return the separation at each step of a machine; inf where a dead load has pulled the flat off.

    The force falls with the separation also where contacts yield, so that each demand is met once, given how low the
    flat has been. Contacts that adhere bear the one load that is asked for where they do first.
    """
    if path.adhesive:
        assert isinstance(asperities, DrawnAsperities)
        return np.array([_first_bearing(asperities, -float(path.demand[0]))])
    separation, lowest, top = np.empty(path.demand.size), np.inf, asperities.first_touch
    for step in range(separation.size):
        asked, law = path.demand[step : step + 1], _response(asperities, lowest)
        found = float(separations_of(law, asked, path.machine, top, asperities.depth, _ERROR)[0])
        found = lowest if abs(found - lowest) <= _ERROR * asperities.depth else found  # the demand it was met by before
        separation[step] = found
        if found < lowest:
            lowest = found
            parting = max(asperities.parting(lowest), lowest)
            top = parting + _ROUNDINGS * max(abs(parting), abs(lowest))  # no contact is left there for sure
    return separation


def _first_bearing(asperities: DrawnAsperities, load: float) -> float:
    """Return the highest separation [m] at which contacts that adhere bear a load [N] on first loading.

    Above ``above`` they do not; the last of ``below`` is tried next, and halfway to it where they may before.
    """
    above, step, below = asperities.first_touch, _FIRST * asperities.depth, list[float]()
    while step <= _DEEPEST * asperities.depth:
        if not below:
            below, step = [above - step], 2.0 * step
        force, most = asperities.bearing(above, below[-1])
        middle = 0.5 * (above + below[-1])
        if most >= load and below[-1] < middle < above:
            below.append(middle)
        elif force >= load:
            return below[-1]
        else:
            above = below.pop()
    raise OutOfRange("path: the load is out of reach of these contacts")


def _response(asperities: Asperities, lowest: float) -> ForceAndStiffness:
    """Return force and stiffness at a separation after the flat has been at ``lowest`` [m]."""

    def response(separation: float) -> tuple[float, float]:
        way = np.array([lowest, separation] if separation > lowest else [separation])
        total = asperities.totals(way, {FORCE, STIFFNESS})
        return float(total[FORCE, -1]), float(total[STIFFNESS, -1])

    return response

"""Conductance radii of asperities and of boundary elements, at given separation and under given load."""

import warnings
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

import roughmdr as rm
from roughmdr.elements.half_space import BoundaryElements
from roughmdr.numerics.arguments import Floats
from studies.conductance.surfaces import CASES, MODELS, QUICK, Surface, surfaces, unit_height
from studies.hills.maps import MapCase
from studies.study import named
from studies.versus_bem.ensembles import Case

FRACTIONS = np.array([0.001, 0.003, 0.01, 0.03, 0.06, 0.1])
"""Contact fractions by boundary elements, about."""
_SEARCHED, _COARSER = 16, 4  # separations at which these are looked for, on a grid so much coarser
_DIFFERENCE = 0.02  # of the separation, over the depth of the flat below the highest summit
_WORKERS = 2
_ASKED = ("force", "conductance_radius", "contact_fraction")
_LAW = (*_ASKED, "conductance_error", "overlap_fraction")


class Elements(NamedTuple):
    """Boundary elements at one separation; E* and the side are 1."""

    force: float
    conductance: float
    """-dF/dh over 2."""
    contact_fraction: float


def press(elements: BoundaryElements, separation: float) -> Elements:
    """Return the solution at a separation; the stiffness by the central difference of the fourth order."""
    step = _DIFFERENCE * (float(elements.height.max()) - separation)
    force = {k: elements.press(separation - k * step) for k in (-2, -1, 1, 2, 0)}
    stiffness = (8.0 * (force[1] - force[-1]) - (force[2] - force[-2])) / (12.0 * step)
    return Elements(force[0], 0.5 * stiffness, elements.patches().area)


def separations(height: Floats) -> Floats:
    """Return where a surface reaches the contact fractions, by boundary elements on a coarser grid."""
    coarse = BoundaryElements(height[::_COARSER, ::_COARSER], np.ones(2))
    top, mean = float(coarse.height.max()), float(coarse.height.mean())
    tried = top - (top - mean) * np.linspace(0.03, 0.97, _SEARCHED) ** 1.5
    area = []
    for h in tried.tolist():
        area.append(coarse.patches().area if np.isfinite(coarse.press(h)) else np.nan)
    known = np.array(area) > 0.0
    found = np.interp(np.log(FRACTIONS), np.log(np.array(area)[known]), tried[known], right=np.nan)
    return np.asarray(found)


def law_of(surface: Surface, interaction: Any, **control: Floats) -> dict[str, Floats]:
    """Return the law of the asperities over the side, NaN where they have none."""
    found = {name: np.full(FRACTIONS.size, np.nan) for name in _LAW}
    scale = {"separation": surface.side, "force": surface.side**2}
    ((name, values),) = control.items()
    for i in np.flatnonzero(np.isfinite(values)):
        given: dict[str, Any] = {name: [float(values[i]) * scale[name]]}
        try:
            law = rm.load_separation(
                surface.ensemble, effective_modulus=1.0, interaction=interaction, variables=_ASKED, **given
            )
        except rm.RoughmdrError:
            continue
        found["force"][i] = float(law.force[0]) / surface.side**2
        found["conductance_radius"][i] = float(law.conductance_radius[0]) / surface.side
        found["contact_fraction"][i] = float(law.contact_fraction[0])
        for each in _LAW[len(_ASKED) :]:
            found[each][i] = float(law[each])
    return found


def compare(case: Case | MapCase) -> list[xr.Dataset]:
    """Return the numbers of the surfaces of a case."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", rm.LimitWarning)
        compared = list[xr.Dataset]()
        solved: tuple[Floats, Floats] | None = None
        for surface in surfaces(case):
            height = unit_height(surface)
            if solved is None:  # hills and summits are of one map
                along = separations(height)
                grids = [BoundaryElements(each, np.ones(2)) for each in (height, height[::2, ::2])]
                solved = along, np.array([[press(grid, h) for h in along.tolist()] for grid in grids])
            compared.append(_numbers(surface, *solved))
    return compared


def _numbers(surface: Surface, along: Floats, solved: Floats) -> xr.Dataset:
    fine, coarse = solved
    over, laws = ("model", "step"), dict[str, list[Floats]]()
    for name in MODELS:
        asked = name in surface.models
        nothing = {each: np.full(FRACTIONS.size, np.nan) for each in _LAW}
        at = law_of(surface, surface.models[name], separation=along) if asked else nothing
        under = law_of(surface, surface.models[name], force=fine[:, 0]) if asked else nothing
        numbers = {
            "conductance": at["conductance_radius"],
            "contact_fraction": at["contact_fraction"],
            "stated": at["conductance_error"],
            "overlap": at["overlap_fraction"],
            "conductance_under_load": under["conductance_radius"],
            "stated_under_load": under["conductance_error"],
        }
        for key, values in numbers.items():
            laws.setdefault(key, []).append(values)
    return xr.Dataset(
        {
            "conductance_bem": ("step", fine[:, 1], named("conductance radius over the side, by boundary elements")),
            "conductance_coarse": ("step", coarse[:, 1], named("the same with half as many points a side")),
            "contact_fraction_bem": ("step", fine[:, 2], named("contact fraction by boundary elements")),
            "conductance": (over, laws["conductance"], named("conductance radius over the side, at the separation")),
            "contact_fraction": (over, laws["contact_fraction"], named("summed contact area over nominal area there")),
            "stated": (over, laws["stated"], named("stated error of the conductance there")),
            "overlap": (over, laws["overlap"], named("share of contacts that overlap; in pairs of the force")),
            "conductance_under_load": (
                over,
                laws["conductance_under_load"],
                named("conductance radius over the side, under the load of the boundary elements"),
            ),
            "stated_under_load": (over, laws["stated_under_load"], named("stated error of the conductance there")),
        },
        {"model": list(MODELS), "group": surface.group},
    )


def measure(quick: bool) -> xr.Dataset:
    """Compare all surfaces, or a few of them on coarse grids."""
    with ProcessPoolExecutor(_WORKERS, mp_context=get_context("spawn")) as pool:
        parts = [each for found in pool.map(compare, QUICK if quick else CASES) for each in found]
    return xr.concat(parts, "case")

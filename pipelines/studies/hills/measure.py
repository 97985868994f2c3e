"""Press maps by each method at the same separations, those at which 0.3 to 20 % are in contact."""

import time
import warnings
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

import roughmdr as rm
from roughmdr.elements.half_space import BoundaryElements
from roughmdr.ensemble.ensemble import Ensemble
from roughmdr.ensemble.maps.height_map import HeightMap
from roughmdr.ensemble.maps.hills.find import find_hills
from roughmdr.ensemble.maps.summits import find_summits
from roughmdr.numerics.arguments import Floats
from studies.hills.maps import ANISOTROPIC, ISOTROPIC, QUICK, SIDE, MapCase
from studies.study import named

POINTS = 8
"""Of the map and of the boundary elements that all is held against, a shortest wave."""
COARSE = (2, 3, 4)
FRACTIONS = np.geomspace(0.003, 0.2, 9)
METHODS = ("summits", "summits in pairs", "hills", *(f"elements, {points} points" for points in COARSE))
_SEARCHED = 12  # separations, between which those of the fractions are found
_PAIRS = "pairwise"


class Pressed(NamedTuple):
    """Force over E* [m2] and contact fraction along a path, and the run time [s] of finding asperities and of it."""

    force: Floats
    contact_fraction: Floats
    seconds: float


def by_elements(height: Floats, separation: Floats) -> Pressed:
    """Return the solution of boundary elements at separations [m]; one after the other, each from the last."""
    started = time.perf_counter()
    elements = BoundaryElements(height / SIDE, np.array([1.0, 1.0]))
    found = np.full((2, separation.size), np.nan)
    for i, h in enumerate(separation.tolist()):
        found[0, i] = elements.press(h / SIDE) * SIDE * SIDE
        found[1, i] = elements.patches().area
    return Pressed(found[0], found[1], time.perf_counter() - started)


def by_asperities(
    height: Floats, separation: Floats, find: Callable[[HeightMap], Ensemble], interaction: Any
) -> Pressed:
    """Return the law of the asperities of a map at separations [m]; NaN where it has none."""
    spacing = SIDE / height.shape[0]
    started = time.perf_counter()
    ensemble = find(HeightMap(height, spacing, spacing, True)).labelled().to_xarray()
    asked = ("force", "contact_fraction")
    try:
        law = rm.load_separation(
            ensemble, separation=separation, effective_modulus=1.0, interaction=interaction, variables=asked
        )
    except rm.RoughmdrError:
        nothing = np.full(separation.size, np.nan)
        return Pressed(nothing, nothing, time.perf_counter() - started)
    return Pressed(law.force.to_numpy(), law.contact_fraction.to_numpy(), time.perf_counter() - started)


def hills_of(surface: HeightMap) -> Ensemble:
    """Return the hills of a map."""
    return find_hills(surface, find_summits(surface))


def separations(height: Floats) -> Floats:
    """Return separations [m] of the contact fractions, by coarse boundary elements."""
    tried = np.linspace(0.98 * float(height.max()), 0.2 * float(height.std()), _SEARCHED)
    found = by_elements(height, tried)
    known = found.contact_fraction > 0.0
    return np.asarray(np.interp(np.log(FRACTIONS), np.log(found.contact_fraction[known]), tried[known]))


def press(case: MapCase) -> list[Pressed]:
    """Return the solution of fine boundary elements, and then that of each method."""
    height = case.height(POINTS)
    separation = separations(case.height(COARSE[-1]))
    return [
        by_elements(height, separation),
        by_asperities(height, separation, find_summits, None),
        by_asperities(height, separation, find_summits, _PAIRS),
        by_asperities(height, separation, hills_of, _PAIRS),
        *(by_elements(case.height(points), separation) for points in COARSE),
    ]


def measure(quick: bool) -> xr.Dataset:
    """Press all maps, or a few."""
    cases = QUICK if quick else [*ISOTROPIC, *ANISOTROPIC]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", rm.LimitWarning)
        press(QUICK[0])  # compiles
        pressed = [press(case) for case in cases]
    numbers = np.array([[[method.force, method.contact_fraction] for method in each] for each in pressed])
    over = ("case", "solver", "fraction")
    columns = dict(zip(MapCase._fields, zip(*cases, strict=True), strict=True))
    return xr.Dataset(
        {
            "force": (over, numbers[:, :, 0], named("force over the effective modulus", "m2")),
            "contact_fraction": (over, numbers[:, :, 1], named("contact area over nominal area")),
            "seconds": (over[:2], [[m.seconds for m in each] for each in pressed], named("run time of a path", "s")),
        },
        {
            "solver": ["fine elements", *METHODS],
            "fraction": ("fraction", FRACTIONS, named("contact fraction of the separation, about")),
            **{name: ("case", list(values)) for name, values in columns.items()},
        },
    )

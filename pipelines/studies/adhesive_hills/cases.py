"""Maps with their adhesion, and the laws of their asperities along a path. E* is 1."""

import math
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from oracles.adhesive_elements import AdhesiveMap

from roughmdr.ensemble.maps.height_map import HeightMap
from roughmdr.ensemble.maps.summits import find_summits
from roughmdr.numerics.arguments import Floats
from studies.comparison import law_or_nan
from studies.hills.maps import POINTS, SIDE, MapCase, hills_of

_SEARCHED = 0.05  # step of the separations among which that of the preload is found, over their stretch


class Law(NamedTuple):
    """Force over E* [m2] and contact fraction along a path; NaN where there is none."""

    force: Floats
    contact_fraction: Floats


class Case(NamedTuple):
    """A map, its adhesion, the preload and the grid of boundary elements."""

    surface: MapCase
    jump_on: float
    """The radius at which a summit of median curvature jumps on, over the wavelength: the work of adhesion."""
    preload: float
    """The contact fraction of independent hills at closest approach."""
    points: int
    """Points of the grid, a side of a patch with isotropic waves."""
    steps: int = 16
    """From clear to closest approach."""
    tabor: float = 2.0
    """Tabor number of a summit of median curvature."""


class Adhesive:
    """The summits and hills of a case, with work of adhesion and range."""

    def __init__(self, case: Case) -> None:
        self.case = case
        height = case.surface.height(POINTS)
        spacing = SIDE / height.shape[0]
        surface = HeightMap(height, spacing, spacing, True)
        self.summits = find_summits(surface).labelled().to_xarray()
        self.hills = hills_of(surface).labelled().to_xarray()
        radius = float(np.median(self.summits["radius"]))
        jump_on = case.jump_on * self.hills.attrs["wavelength"]
        self.work = jump_on**3 / (2.0 * math.pi * radius**2)
        self.reach = (self.work**2 * radius) ** (1.0 / 3.0) / case.tabor
        self.cohesive_zone = self.reach**2 / self.work
        """E* w/strength^2 [m], which a grid must resolve."""
        self.stretch = jump_on**2 / radius
        """A measure of how far a contact is stretched before it lets go [m]."""

    def path(self) -> Floats:
        """Return separations [m] from clear to the preload and back."""
        height = self.hills["height"].to_numpy()
        clear = deepest = float(height.max()) + self.stretch
        while self.law(self.hills, np.array([clear, deepest])).contact_fraction[1] < self.case.preload:
            deepest -= _SEARCHED * self.stretch
        loading = np.linspace(clear, deepest, self.case.steps)
        return np.concatenate([loading, loading[-2::-1]])

    def law(self, asperities: xr.Dataset, separation: Floats, **asked: Any) -> Law:
        """Return the law of asperities along a path, by JKR unless asked otherwise; NaN where there is none."""
        asked |= {"effective_modulus": 1.0, "work": self.work}
        return Law(*law_or_nan(asperities, separation, "force", "contact_fraction", **asked))

    def by_elements(self, separation: Floats, points: float, reach: float) -> Law:
        """Return the law by boundary elements; a contact is the mean of what is closed and what is within the range."""
        surface = self.case.surface
        height = surface.height(points / (surface.bandwidth * np.sqrt(surface.anisotropy)))
        elements = AdhesiveMap(height / SIDE, 1.0, self.work / SIDE, reach / SIDE)
        states = [elements.move(h / SIDE) for h in separation.tolist()]
        force = np.array([state.force for state in states]) * SIDE**2
        return Law(force, np.array([0.5 * (state.closed + state.attracted) for state in states]))


_MAPS = (MapCase(0.8, 4, 11), MapCase(0.5, 6, 11), MapCase(0.8, 6, 12), MapCase(0.8, 4, 11, 2.0))
WEAK, STRONG = 0.12, 0.2
CASES = [Case(surface, share, preload, 216) for surface in _MAPS for share, preload in ((WEAK, 0.03), (STRONG, 0.02))]
QUICK = [Case(_MAPS[0], share, 0.02, 108, 10) for share in (WEAK, STRONG)]

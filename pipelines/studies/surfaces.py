"""Surfaces that are pressed by boundary elements, with the asperities that stand for them: on a plane, or of a map."""

from typing import NamedTuple

import numpy as np
import xarray as xr

from roughmdr.elements.half_space import BoundaryElements
from roughmdr.ensemble.maps.height_map import HeightMap
from roughmdr.ensemble.maps.summits import find_summits
from roughmdr.numerics.arguments import Floats
from studies.hills.maps import SIDE, MapCase, hills_of, where_reached
from studies.versus_bem.ensembles import SIZE, Case

_COARSER = 4  # points of the grid for one of that on which separations are looked for


class Surface(NamedTuple):
    """A surface, and the asperities that stand for it by their group."""

    ensembles: dict[str, xr.Dataset]
    height: Floats  # [side], on the grid of boundary elements
    side: float  # [m]
    periodic: bool

    def elements(self, coarser: int = 1) -> BoundaryElements:
        """Return boundary elements of unit side, on one of ``coarser`` points along a side."""
        return BoundaryElements(self.height[::coarser, ::coarser], np.ones(2), periodic=self.periodic)

    def separations(self, fractions: Floats, searched: int, left: float | None = None) -> Floats:
        """Return the separations [side] of contact fractions by coarse elements, of lower ones ``left``; NaN beyond."""
        coarse = self.elements(_COARSER)
        top, mean = float(coarse.height.max()), float(coarse.height.mean())
        tried = top - (top - mean) * np.linspace(0.03, 0.97, searched) ** 1.5
        return where_reached(coarse, tried, fractions, left=left, right=np.nan)


def surface_of(case: Case | MapCase, periodic: bool = True) -> Surface:
    """Return the surface of a case; not ``periodic``, 0.7 of the side is cut out of a map."""
    if isinstance(case, Case):
        ensemble, height, _ = case.build()
        return Surface({"asperities": ensemble}, height / SIZE, SIZE, True)
    height, side = case.height(16 if case.bandwidth <= 16 else 12), SIDE
    if not periodic:
        kept = int(0.7 * height.shape[0]) // 4 * 4
        height, side = height[:kept, :kept], SIDE * kept / height.shape[0]
    surface = HeightMap(height, side / height.shape[0], side / height.shape[1], periodic)
    found = {"summits": find_summits(surface), "hills": hills_of(surface)}
    return Surface({name: each.labelled().to_xarray() for name, each in found.items()}, height / side, side, periodic)

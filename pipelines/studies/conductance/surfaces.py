"""Surfaces whose conductance is compared: asperities on a plane, and maps with their hills and summits."""

from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from roughmdr.ensemble.maps.summits import find_summits
from roughmdr.numerics.arguments import Floats
from studies.hills.maps import SIDE, MapCase, hills_of, square
from studies.versus_bem.ensembles import SIZE, Case

PAIRS: dict[str, Any] = {f"order {order}": {"model": "pairwise", "order": order} for order in (1, 2)}
MODELS: dict[str, Any] = {"independent": None, "mean field": "mean_field", **PAIRS}
_MAP_POINTS = 16  # of a map a shortest wave


class Surface(NamedTuple):
    """A surface and what stands for it."""

    group: str
    """"random", "separated", "hills" or "summits"."""
    ensemble: xr.Dataset
    height: Floats
    """[m], on the grid of boundary elements."""
    side: float
    """[m]"""

    @property
    def models(self) -> dict[str, Any]:
        """Interactions of the asperities, by their names; hills need pairs."""
        return PAIRS if self.group == "hills" else MODELS


def of_asperities(case: Case) -> list[Surface]:
    """Return asperities on a plane."""
    ensemble, fine, _ = case.build()
    return [Surface("random" if case.placement == "random" else "separated", ensemble, fine, SIZE)]


def of_map(case: MapCase) -> list[Surface]:
    """Return the hills of a map, and its summits."""
    height = case.height(_MAP_POINTS)
    surface = square(height)
    found = {"hills": hills_of(surface), "summits": find_summits(surface)}
    return [Surface(name, each.labelled().to_xarray(), height, SIDE) for name, each in found.items()]


CASES: list[Case | MapCase] = [
    *(Case(where, "paraboloid", 64, roughness, 512, seed)
      for seed, roughness in ((1, 0.05), (2, 0.2), (3, 1.0))
      for where in ("random", "hard_core 0.5", "hard_core 0.7")),
    *(Case(where, shape, 64, 0.2, 512, 4)
      for shape in ("lognormal", "quartic") for where in ("random", "hard_core 0.7")),
    Case("random", "paraboloid", 200, 0.2, 512, 5),
    *(MapCase(hurst, bandwidth, seed) for hurst in (0.3, 0.8) for bandwidth, seed in ((8, 11), (8, 12), (16, 11))),
]  # fmt: skip
QUICK: list[Case | MapCase] = [
    Case("random", "paraboloid", 25, 0.2, 128, 1),
    Case("hard_core 0.7", "paraboloid", 25, 0.05, 128, 1),
    MapCase(0.8, 8, 11),
]


def surfaces(case: Case | MapCase) -> list[Surface]:
    """Return the surfaces of a case."""
    return of_asperities(case) if isinstance(case, Case) else of_map(case)


def unit_height(surface: Surface) -> Floats:
    """Return the heights on the grid over the side."""
    return np.asarray(surface.height / surface.side)

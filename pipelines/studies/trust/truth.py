"""True forces of scenes: by boundary elements, or of paraboloids that feel each other in pairs.

Pairs adhere as in JKR; the difference that the range of adhesion makes is added from independent asperities.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr
from oracles.boundary_elements import HeightMap
from oracles.pairwise import Paraboloids, periodic_green

from roughmdr.aggregate.tabor import ASSUMED_RANGE
from roughmdr.numerics.arguments import Floats
from studies.comparison import law_of
from studies.trust.scenes import Surface
from studies.versus_bem.ensembles import distances, height_map, side

_LIFTED = 0.3  # largest lift of the surface between contacts by their pressure, over the deepest overlap
_LOADING = 60  # steps of the path that pairs are taken along
MAPS = 5  # Gaussian maps whose mean force is compared with the expected law


def by_boundary_elements(ensemble: xr.Dataset, points: int, modulus: float, separation: float) -> float:
    """Return the force [N] of asperities at a separation [m]; infinite in full contact."""
    size = side(ensemble)
    return HeightMap(height_map(ensemble, points), size, modulus).press(separation).force


def of_map(surface: Surface, seeds: Sequence[int], modulus: float, separation: float) -> list[float]:
    """Return the force [N] on each map, on its finer grid."""
    grids = (refined(surface.height(seed), surface.refined) for seed in seeds)
    return [HeightMap(grid, surface.size, modulus).press(separation).force for grid in grids]


def refined(height: Floats, factor: int) -> Floats:
    """Return a periodic map, of as many points in both directions, with its waves on a grid finer by a whole factor."""
    waves = np.fft.fftshift(np.fft.fft2(height))
    added = height.shape[0] * (factor - 1) // 2
    return np.asarray(np.fft.ifft2(np.fft.ifftshift(np.pad(waves, added))).real * factor**2)


def by_pairs(ensemble: xr.Dataset, modulus: float, work: float, closest: float) -> float:
    """Return the force [N] of paraboloids at the closest separation [m], loaded from first touch on."""
    height, radius = (ensemble[name].to_numpy() for name in ("height", "radius"))
    flanks = height[:, None] - 0.5 * distances(ensemble) ** 2 / radius[:, None]
    high = height > closest - _LIFTED * (height.max() - closest)
    may_touch = high & ~(flanks > height).any(axis=0)  # tops below the flank of another never do
    x, y, height, radius = (ensemble[name].to_numpy()[may_touch] for name in ("x", "y", "height", "radius"))
    pressed = Paraboloids(height, radius, periodic_green(x, y, side(ensemble), modulus), modulus, work)
    return [pressed.press(float(h)).force for h in np.linspace(height.max(), closest, _LOADING)][-1]


def by_range_of_adhesion(ensemble: xr.Dataset, modulus: float, work: float, path: Floats) -> float:
    """Return how much more force [N] at closest approach an adhesion has that reaches as far as that of van der Waals.

    It is that of independent asperities, by Dugdale's model beside JKR.
    """

    def force(**range_of_adhesion: Any) -> float:
        asked = {"effective_modulus": modulus, "work": work, "variables": "force", **range_of_adhesion}
        return float(law_of(ensemble, separation=path, **asked)["force"][-1])

    return force(adhesion="dugdale", range=ASSUMED_RANGE) - force()

"""Surfaces that boundary elements press, on a grid of any fineness: that of asperities, or a height map."""

import math
from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from roughmdr.elements.union_map import union_map
from roughmdr.ensemble.ensemble import Ensemble
from roughmdr.ensemble.maps.height_map import HeightMap, spline_coefficients, spline_mode
from roughmdr.errors import SceneError
from roughmdr.interaction.buried import reach
from roughmdr.interaction.placed import sides_of
from roughmdr.numerics.arguments import Floats

POINTS = 512
"""Grid points along the side of a square patch, where no error is asked for."""
_LEAST_POINTS = 16
_MARGIN = 1.05  # of the radius at which a contact without neighbours ends at most


class Surface(NamedTuple):
    """A surface on a patch."""

    sides: Floats
    """Of the patch along x and y [m]."""
    tops: Floats
    """Heights of its summits [m]."""
    periodic: bool
    """Whether it repeats beyond the patch, or ends there."""
    on_grid: Callable[[tuple[int, int], float], Floats]
    """Return heights [m] on a grid with this shape; -inf where there is nothing, or nothing above a floor [m]."""
    has_floor: bool
    """Whether what lies below the floor is left out."""


def grid_shape(sides: Floats, points: float) -> tuple[int, int]:
    """Return even numbers of points along x and y, about ``points`` in the geometric mean, with cells about square."""
    from scipy.fft import next_fast_len

    ratio = math.sqrt(float(sides[0] / sides[1]))
    x, y = (2 * next_fast_len(max(round(0.5 * points * each), _LEAST_POINTS // 2)) for each in (ratio, 1.0 / ratio))
    return x, y


def surface_of_asperities(ensemble: Ensemble, lowest: float, *, periodic: bool) -> Surface:
    """Return the surface that asperities make together, of which the highest counts at each point.

    A surface that ends does so beyond all that a flat reaches at the ``lowest`` separation [m]; one that repeats needs
    the patch, SceneError where that is not known.
    """
    sides = sides_of(ensemble)
    if periodic and sides is None:
        raise SceneError("ensemble: boundary elements need the patch; give patch, patch_x and patch_y, or nominal_area")
    if not periodic:
        at = np.array([ensemble.positions[name] for name in ("x", "y")])
        around = _MARGIN * float(reach(ensemble, ensemble.height - lowest).max(initial=0.0))
        first = at.min(axis=1, keepdims=True) - around
        x, y = at - first
        ensemble = replace(ensemble, positions={"x": x, "y": y})
        extent = np.ptp(at, axis=1) + 2.0 * around
        sides = float(extent[0]), float(extent[1])
    patch = np.array(sides)
    return Surface(
        patch, ensemble.height, periodic, lambda shape, floor: union_map(ensemble, patch, shape, floor), has_floor=True
    )


def surface_of_map(surface: HeightMap, tops: Floats, *, periodic: bool) -> Surface:
    """Return a height map, between its points its cubic spline; summits at ``tops`` [m]."""
    from scipy.ndimage import map_coordinates

    known, coefficients = np.isfinite(surface.height), spline_coefficients(surface)
    counts, mode = known.shape, spline_mode(surface)

    def on_grid(shape: tuple[int, int], _: float) -> Floats:
        rows, columns = ((np.arange(n) + 0.5) * (count / n) - 0.5 for n, count in zip(shape, counts, strict=True))
        at = np.broadcast_arrays(rows[:, None], columns)
        heights = map_coordinates(coefficients, at, order=3, mode=mode, prefilter=False)
        i, j = (np.rint(each).clip(0, n - 1).astype(np.int64) for each, n in zip((rows, columns), counts, strict=True))
        return np.where(known[np.ix_(i, j)], heights, -np.inf)

    sides = np.array([surface.dx * counts[0], surface.dy * counts[1]])
    return Surface(sides, tops, periodic, on_grid, has_floor=False)

"""Surfaces that boundary elements press, on a grid of any fineness: that of asperities, or a height map."""

import math
from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from roughmdr.ensemble.ensemble import Ensemble
from roughmdr.ensemble.maps.height_map import HeightMap, spline_coefficients, spline_mode
from roughmdr.errors import SceneError
from roughmdr.interaction.buried import drop, reach
from roughmdr.interaction.placed import sides_of
from roughmdr.numerics.arguments import Floats

POINTS = 512
"""Grid points along the side of a square patch, where no error is asked for."""
_LEAST_POINTS = 16
_MARGIN = 1.05  # radius around an asperity that is drawn, over its largest contact radius without neighbours
_AT_A_TIME = 2**21


class Surface(NamedTuple):
    """A surface on a patch."""

    sides: Floats
    """Sides of the patch along x and y [m]."""
    tops: Floats
    """Heights of its summits [m]."""
    periodic: bool
    """Whether it repeats beyond the patch, or ends there."""
    on_grid: Callable[[tuple[int, int], float], Floats]
    """Return heights [m] on a grid with this shape; -inf where there is nothing, or nothing above a floor [m]."""
    has_floor: bool
    """Whether heights below the floor are left out."""


def grid_shape(sides: Floats, points: float) -> tuple[int, int]:
    """Return even numbers of points along x and y, about ``points`` in the geometric mean, with cells about square."""
    from scipy.fft import next_fast_len

    ratio = math.sqrt(float(sides[0] / sides[1]))
    x, y = (2 * next_fast_len(max(round(0.5 * points * each), _LEAST_POINTS // 2)) for each in (ratio, 1.0 / ratio))
    return x, y


def surface_of(ensemble: Ensemble, height_map: HeightMap | None, lowest: float, *, periodic: bool) -> Surface:
    """Return the map that asperities are of, or where there is none the surface that they make together."""
    if height_map is None:
        return surface_of_asperities(ensemble, lowest, periodic=periodic)
    return surface_of_map(height_map, ensemble.height, periodic=periodic)


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


def union_map(ensemble: Ensemble, sides: Floats, shape: tuple[int, int], floor: float) -> Floats:
    """Return heights [m] on a grid over a patch with ``sides`` [m]; -inf where no asperity is above ``floor`` [m].

    Asperities repeat with the patch. Of one of them the nearest image alone counts: the others are lower everywhere.
    """
    counts = np.array(shape)
    cell = sides / counts
    at = np.column_stack([ensemble.positions[name] for name in ("x", "y")])
    at = at - sides * np.floor(at / sides)
    far = reach(ensemble, ensemble.height - floor)
    half = np.ceil(np.minimum(far[:, None], 0.5 * sides) / cell).astype(np.int64).max(axis=1) + 1
    size = np.where((far > 0.0) | (ensemble.height > floor), np.ceil(2.0 * np.log2(half)), -1.0)
    heights = np.full(counts.prod(), -np.inf)
    for each in np.unique(size[size >= 0.0]):
        members = np.flatnonzero(size == each)
        width = math.ceil(2.0 ** (0.5 * each))
        windows = [
            np.arange(-width, width + 1) if 2 * width < count else np.arange(count) - count // 2 for count in shape
        ]
        parts = math.ceil(members.size * windows[0].size * windows[1].size / _AT_A_TIME)
        for part in np.array_split(members, parts):
            index, away = [], []
            for axis, window in enumerate(windows):
                number = np.floor(at[part, axis] / cell[axis]).astype(np.int64)[:, None] + window
                offset = number * cell[axis] - at[part, axis, None]
                away.append(offset - sides[axis] * np.round(offset / sides[axis]))
                index.append(number % shape[axis])
            distance = np.hypot(away[0][:, :, None], away[1][:, None, :])
            near = np.nonzero(distance <= far[part, None, None])
            who = part[near[0]]
            values = ensemble.height[who] - drop(ensemble, who, distance[near])
            point = index[0][near[0], near[1]] * shape[1] + index[1][near[0], near[2]]
            np.maximum.at(heights, point, np.where(values >= floor, values, -np.inf))
    return heights.reshape(shape)

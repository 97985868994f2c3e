"""Find the hills of a height map."""

import math
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from roughmdr.ensemble.ensemble import Ensemble
from roughmdr.ensemble.maps.height_map import (
    HeightMap,
    map_statistics,
    mean_square_laplacian,
    slope_ratio,
    spline_coefficients,
)
from roughmdr.ensemble.maps.hills.contact import (
    PARAMETERS,
    RAYS,
    STEPS,
    Spline,
    Territory,
    area_share,
    explore,
    improve,
    raw_height,
    top_of,
)
from roughmdr.ensemble.maps.resolution import HILLS_BY_BORDER, border_error, hills_error
from roughmdr.ensemble.maps.summits import NEIGHBOURS
from roughmdr.errors import SceneError
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.jit import njit
from roughmdr.shapes.mdr_table import rising

_WAVELENGTH = 6.6
"""Wavelength over the ratio of r.m.s. slope to r.m.s. Laplacian: 2 pi where all waves are equally long, and 5 % more
here, as the sizes below were tuned with it (``pipelines/study.py hills``)."""
SCALES = 20
"""Default number of contact radii in the table of a hill: each is 1.18 times the one before."""
SMALLEST, LARGEST = 0.04, 1.0
"""The first and the last contact radius [wavelength]."""
MIDDLE = 0.14
"""Contact radius [wavelength] whose centre is the position of a hill for its neighbours: about where contacts meet."""
APART = 0.05
"""Distance [wavelength] of the centres of two such contacts below which they are one hill with two tops."""
LEAST_GROWTH = 0.4
"""Least growth of g from point to point, over that of a paraboloid; less in a valley, where the next hill begins."""


class Hills(NamedTuple):
    """Hills, one each for the summits of a map."""

    height: Floats
    """Heights of their tops [m]."""
    g: Floats
    """MDR profile g [m], [hill, point]."""
    moved: Floats
    """Vector from the summit to the centre of the contact of radius ``MIDDLE`` [wavelength], [hill, 2]."""
    area_share: Floats
    """Area of that contact over the circle of the same stiffness [1]."""
    kept: NDArray[np.bool_]
    """Whether each is a hill: whether it falls from its top."""


def wavelength(surface: HeightMap) -> float:
    """Return the length [m] of the waves on which the curvatures of a map depend."""
    slope = float(map_statistics(surface)["rms_slope"])
    return _WAVELENGTH * slope / math.sqrt(mean_square_laplacian(surface))


def find_hills(surface: HeightMap, summits: Ensemble, scales: int = SCALES) -> Ensemble:
    """Return the hills of a map on its summits: asperities with an MDR table each, of the same attributes.

    Each contact of a hill is the ellipse of that stiffness which carries most, on the hill's own territory; ``scales``,
    at least 2, is the number of their radii. SceneError where no summit is a hill: where none falls from its top, as
    next to rounding.

    Attributes beside those of the summits: ``wavelength`` [m]; ``points_per_wave`` [1], along the coarser axis;
    ``resolution_error`` and ``border_error`` [1], of the force; ``area_share`` [1], the mean area of contacts over that
    of circles as stiff; ``anisotropy`` [1], the ratio of the r.m.s. slopes across and along the ridges.
    """
    length = wavelength(surface)
    spline = Spline(spline_coefficients(surface), surface.dx / length, surface.dy / length, surface.periodic)
    radius = np.geomspace(SMALLEST, LARGEST, scales)
    points = points_of(radius)
    rows, columns = summits.positions["x"] / surface.dx - 0.5, summits.positions["y"] / surface.dy - 0.5
    if not surface.periodic:
        rows, columns = np.append(np.array([rows, columns]), _tops_of_border(surface), axis=1)
    count = rows.size
    height, g, moved = np.empty(count), np.empty((count, scales)), np.empty((count, 2))
    kept, share = np.empty(count, dtype=np.bool_), np.empty(count)
    _measure(spline, rows, columns, radius, points, Hills(height, g, moved, share, kept))
    nx, ny = surface.height.shape
    sides = np.array([nx * surface.dx, ny * surface.dy])
    at = np.column_stack([(rows + 0.5) * surface.dx, (columns + 0.5) * surface.dy]) + length * moved
    at = at % sides if surface.periodic else np.clip(at, 0.0, np.nextafter(sides, 0.0))
    kept &= ~_repeated(at / sides, height, APART * length / sides, periodic=surface.periodic)
    if not kept.any():
        raise SceneError("the map has no hill: none of its summits falls from its top")
    return replace(
        summits,
        shape="mdr_table",
        height=height[kept],
        parameters={"a": np.tile(length * points, (int(kept.sum()), 1)), "g": rising(g[kept])},
        positions={"x": at[kept, 0], "y": at[kept, 1]},
        attrs={**summits.attrs, **_attributes(surface, length, share[kept])},
    ).sorted()


def _tops_of_border(surface: HeightMap) -> Floats:
    """Return row and column of the points on the border of a map above all neighbours: summits that the border cuts."""
    height, shape = surface.height, np.array(surface.height.shape)[:, None]
    frame = np.ones(height.shape, dtype=np.bool_)
    frame[1:-1, 1:-1] = False
    at = np.array(np.nonzero(frame))
    for step in NEIGHBOURS:
        beside = np.clip(at + np.array(step)[:, None], 0, shape - 1)
        lower = height[*beside] < height[*at] - surface.rounding
        at = at[:, lower | (beside == at).all(axis=0)]
    return at.astype(np.float64)


def _repeated(at: Floats, height: Floats, apart: Floats, *, periodic: bool) -> NDArray[np.bool_]:
    """Return which hills coincide with a higher one; positions [hill, 2] and ``apart`` over the sides."""
    from scipy.spatial import cKDTree

    box = 1.0 / apart
    scaled = np.clip(at * box, 0.0, np.nextafter(box, 0.0))
    pairs = cKDTree(scaled, boxsize=box if periodic else None).query_pairs(1.0, output_type="ndarray")
    repeated = np.zeros(height.size, dtype=np.bool_)
    lower = np.where(height[pairs[:, 0]] < height[pairs[:, 1]], pairs[:, 0], pairs[:, 1])
    higher = pairs.sum(axis=1) - lower
    for i in np.lexsort((lower, -height[higher])):
        repeated[lower[i]] |= not repeated[higher[i]]
    return repeated


def _attributes(surface: HeightMap, length: float, share: Floats) -> dict[str, float | int | str]:
    """Return the statistics of the hills of a map, by the names of attributes."""
    points = length / max(surface.dx, surface.dy)
    return {
        "asperity_model": "hills",
        "wavelength": length,
        "points_per_wave": points,
        "resolution_error": hills_error(points),
        "border_error": border_error(surface, length, HILLS_BY_BORDER),
        "area_share": float(np.mean(share)),
        "anisotropy": slope_ratio(surface),
    }


@njit
def _measure(spline: Spline, rows: Floats, columns: Floats, radius: Floats, points: Floats, hills: Hills) -> None:
    """Fill in the hills of summits; their rows and columns become those of the spline's summits."""
    taken_off, nearest, mean = np.empty((RAYS, STEPS + 1)), np.empty(1), np.empty(radius.size)
    for i in range(rows.size):
        x, y = top_of(Territory(spline, rows[i], columns[i], taken_off, nearest))
        rows[i], columns[i] = rows[i] + x / spline.spacing_x, columns[i] + y / spline.spacing_y
        hill = Territory(spline, rows[i], columns[i], taken_off, nearest)
        explore(hill)
        ellipse, before = np.zeros(PARAMETERS), np.zeros(2)
        top = raw_height(hill, 0.0, 0.0)
        for k in range(radius.size):
            if k > 0:
                ellipse[2:] *= radius[k - 1] / radius[k]
            mean[k] = improve(hill, radius[k], ellipse)
            if k > 0 and mean[k] == -math.inf:  # wider than the map
                mean[k] = top - (top - mean[k - 1]) * (radius[k] / radius[k - 1]) ** 2
            top = max(top, mean[k])
            if k > 0 and radius[k - 1] <= MIDDLE < radius[k]:
                share = (MIDDLE - radius[k - 1]) / (radius[k] - radius[k - 1])
                hills.moved[i] = (1.0 - share) * before + share * radius[k] * ellipse[2:]
                hills.area_share[i] = area_share(ellipse)
            before = radius[k] * ellipse[2:]
        hills.height[i] = top
        hills.kept[i] = mean[0] > -math.inf and fill_table(radius, mean, top, points, hills.g[i])


def points_of(radius: Floats) -> Floats:
    """Return the radii of the tables: between two contact radii where a^2 has its mean, from the tip on."""
    before = np.append(0.0, radius[:-1])
    return np.asarray(np.sqrt((radius * radius + radius * before + before * before) / 3.0))


@njit
def fill_table(radius: Floats, mean: Floats, summit: float, points: Floats, g: Floats) -> bool:
    """Fill g [m] at ``points`` from the means [m] under contacts of rising radii; False where the hill does not fall.

    The contact of radius a carries 2 E* (a (H - D) - G(a)), G = a (H - <h>_a), H the height of the summit, and the
    force is the largest of these: that of the convex hull of G, whose slope is g. Where G is not convex, g is the mean
    over the radii of the hull, at their root-mean-square point; between such points it is linear in a^2.
    """
    count = radius.size
    begin, level, place = np.zeros(count), np.empty(count), np.empty(count)
    pieces, start, before = 0, 0.0, 0.0
    for k in range(count):
        end, total = radius[k], radius[k] * (summit - mean[k])
        start, value = (radius[k - 1], total - before) if k > 0 else (0.0, total)
        rate = value / (end - start)
        while pieces > 0 and rate <= level[pieces - 1]:
            pieces -= 1
            value += level[pieces] * (start - begin[pieces])
            start = begin[pieces]
            rate = value / (end - start)
        begin[pieces], level[pieces] = start, rate
        place[pieces] = (end * end + end * start + start * start) / 3.0
        pieces += 1
        before = total
    first = 0
    while first < pieces and level[first] <= 0.0:
        first += 1
    if first == pieces:
        return False
    last = first
    for k in range(count):
        s = points[k] * points[k]
        while last < pieces - 2 and s > place[last + 1]:
            last += 1
        if s <= place[first] or pieces - first == 1:
            g[k] = level[first] * s / place[first]
        else:
            slope = (level[last + 1] - level[last]) / (place[last + 1] - place[last])
            g[k] = level[last] + slope * (s - place[last])
        if k > 0:
            g[k] = max(g[k], g[k - 1] * (1.0 + LEAST_GROWTH * (s / (points[k - 1] * points[k - 1]) - 1.0)))
    return True

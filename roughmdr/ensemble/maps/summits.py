"""Find the summits of a height map, and fit a paraboloid to each."""

import math
from typing import NamedTuple

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from roughmdr.ensemble.ensemble import Ensemble
from roughmdr.ensemble.maps.height_map import HeightMap, blocks_with_neighbours
from roughmdr.ensemble.maps.resolution import SUMMITS_BY_BORDER, border_error
from roughmdr.errors import SceneError
from roughmdr.numerics.arguments import Floats

NEIGHBOURS = [(i, j) for i in (-1, 0, 1) for j in (-1, 0, 1) if (i, j) != (0, 0)]


class _Fits(NamedTuple):
    """Summits of a block of a map; lengths along x and y in spacings."""

    height: Floats
    x: Floats
    y: Floats
    determinant: Floats  # k1 k2, of the second derivatives
    second: Floats  # h_xx + h_yy
    fourth: Floats  # h_xxyy
    candidates: int  # the number of points above their neighbours, saddles included
    blind: int  # the number of points beside undefined ones, which may be summits or not


def find_summits(surface: HeightMap, noise: float = 0.0) -> Ensemble:
    """Return the summits of a map: points above all eight neighbours by more than ``noise`` [m].

    The paraboloid through such a point is fitted to the neighbours by least squares. Its top is the summit; its radius
    is 1/sqrt(k1 k2), from the geometric mean of the principal curvatures, that of the sphere which best replaces an
    elliptic contact (J. A. Greenwood, Wear 261 (2006) 191). A point whose paraboloid is a saddle is not a summit, nor
    is one next to an undefined point; the nominal area [m2] is that of the defined points. SceneError where there is no
    summit.

    Attributes: ``points_per_summit``; ``border_error``, of the force; ``saddles``, their number; ``misfit``, the fourth
    difference h_xxyy over the second, h_xx + h_yy, both r.m.s. over the summits: the residual of the fit over the
    curvature; and, of a map with undefined points, ``blind_share``, those beside them over all that are defined: about
    the share of summits missed.
    """
    dx, dy = surface.dx, surface.dy
    nx, ny = surface.height.shape
    edge = 0.5 if surface.periodic else 1.5
    fits = (_fit(*block, edge, noise) for block in blocks_with_neighbours(surface))
    *columns, candidates, blind = zip(*fits, strict=True)
    height, x, y, determinant, second, fourth = map(np.concatenate, columns)
    if not height.size:
        raise SceneError("the map has no summit: no point stands above its eight neighbours on a dome")
    defined = surface.defined
    positions = {"x": x % nx * dx, "y": y % ny * dy}  # a top may lie across the edge of a periodic map
    attrs: dict[str, float | int | str] = {
        "of_surface": 1,
        "patch_x": nx * dx,
        "patch_y": ny * dy,
        "points_per_summit": defined / height.size,
        "border_error": border_error(surface, math.sqrt(defined / height.size * dx * dy), SUMMITS_BY_BORDER),
        "saddles": sum(candidates) - height.size,
        "misfit": float(np.linalg.norm(fourth) / np.linalg.norm(second)),
    }
    if any(blind):
        attrs["blind_share"] = sum(blind) / defined
    radii = {"radius": dx * dy / np.sqrt(determinant)}
    return Ensemble("paraboloid", height, radii, defined * dx * dy, positions, attrs).sorted()


def _fit(part: Floats, first: int, edge: float, noise: float) -> _Fits:
    """Fit paraboloids to the summits inside a block, whose first point is ``first`` + ``edge`` off the edge."""
    inner = part[1:-1, 1:-1]

    def neighbours(i: int, j: int) -> Floats:
        return part[1 + i : part.shape[0] - 1 + i, 1 + j : part.shape[1] - 1 + j]

    lowered, above = inner - noise, np.ones(inner.shape, dtype=bool)
    for i, j in NEIGHBOURS:
        above &= lowered > neighbours(i, j)
    rows, columns = np.nonzero(above)
    drop = {(i, j): neighbours(i, j)[rows, columns] - inner[rows, columns] for i, j in NEIGHBOURS}

    def moment(m: int, n: int) -> Floats:
        return np.asarray(sum((i**m * j**n * drop[i, j] for i, j in NEIGHBOURS), np.zeros(rows.size)))

    # The normal equations of drop = p i + q j + (A i^2 + 2 B i j + C j^2)/2 over the eight neighbours (i, j).
    p, q = moment(1, 0) / 6.0, moment(0, 1) / 6.0
    A = 0.6 * moment(2, 0) - 0.4 * moment(0, 2)
    C = 0.6 * moment(0, 2) - 0.4 * moment(2, 0)
    B = moment(1, 1) / 4.0

    second = moment(2, 0) + moment(0, 2) - 2.0 * moment(2, 2)
    fourth = moment(2, 2) - 2.0 * second
    with np.errstate(over="ignore", under="ignore", invalid="ignore"):  # a curvature out of range is not a dome
        determinant = A * C - B * B
    domed = (determinant > 0.0) & (A < 0.0)
    p, q, A, B, C, determinant = (values[domed] for values in (p, q, A, B, C, determinant))
    i_top, j_top = (B * q - C * p) / determinant, (B * p - A * q) / determinant
    # A top beyond the neighbours is an extrapolation: the point itself is the better summit.
    near = np.maximum(np.abs(i_top), np.abs(j_top)) <= 1.0
    i_top, j_top = np.where(near, i_top, 0.0), np.where(near, j_top, 0.0)
    row, column = rows[domed], columns[domed]
    height = inner[row, column] + 0.5 * (p * i_top + q * j_top)
    x, y = row + first + edge + i_top, column + edge + j_top
    undefined = np.isnan(part)
    beside = np.isfinite(inner) & (
        sliding_window_view(undefined, (3, 3)).any(axis=(2, 3)) if undefined.any() else False
    )
    return _Fits(height, x, y, determinant, second[domed], fourth[domed], rows.size, int(np.sum(beside)))

"""The summits of a height map: where they are, and the paraboloid that fits each."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from roughmdr.ensemble.ensemble import Ensemble
from roughmdr.ensemble.maps.height_map import HeightMap
from roughmdr.ensemble.maps.raw_map import blocks
from roughmdr.errors import SceneError
from roughmdr.numerics.arguments import Floats

_AROUND = [(i, j) for i in (-1, 0, 1) for j in (-1, 0, 1) if (i, j) != (0, 0)]


class _Fitted(NamedTuple):
    """Summits of a part of a map; lengths along x and y in spacings."""

    height: Floats
    x: Floats
    y: Floats
    determinant: Floats
    """k1 k2, of the second derivatives."""
    second: Floats
    """h_xx + h_yy."""
    fourth: Floats
    """h_xxyy."""
    candidates: int
    """How many points stand above their neighbours, saddles among them."""


def find_summits(surface: HeightMap, noise: float = 0.0) -> Ensemble:
    """The points above all eight neighbours by more than ``noise`` [m], each with a paraboloid through the point.

    To the eight neighbours the paraboloid is fitted by least squares. Its top is the summit; the radius is 1/sqrt(k1
    k2), from the geometric mean of the principal curvatures: that of the sphere which an elliptic contact is best
    replaced by (J. A. Greenwood, Wear 261 (2006) 191). A point whose paraboloid is a saddle is no summit, nor is one
    beside an undefined point; the nominal area [m2] is that of the points that are defined. SceneError where no summit
    is found.

    Attributes: ``points_per_summit``; ``saddles``, the points left out as such; ``misfit``, the fourth difference
    h_xxyy over the second, h_xx + h_yy, both r.m.s. over the summits: what the fit leaves over what it finds.
    """
    dx, dy = surface.dx, surface.dy
    nx, ny = surface.height.shape
    *columns, candidates = zip(*(_fit(*part, noise) for part in _parts(surface)), strict=True)
    height, x, y, determinant, second, fourth = map(np.concatenate, columns)
    if not height.size:
        raise SceneError("the map has no summit: no point stands above its eight neighbours on a dome")
    defined = surface.defined
    # A top may lie across the edge of a periodic map.
    places = {"x": x % nx * dx, "y": y % ny * dy}
    return Ensemble.sorted(
        "paraboloid",
        height,
        {"radius": dx * dy / np.sqrt(determinant)},
        defined * dx * dy,
        places,
        {
            "patch_x": nx * dx,
            "patch_y": ny * dy,
            "points_per_summit": defined / height.size,
            "saddles": sum(candidates) - height.size,
            "misfit": float(np.linalg.norm(fourth) / np.linalg.norm(second)),
        },
    )


def _parts(surface: HeightMap) -> Iterator[tuple[Floats, int, float]]:
    """Some rows of points that have neighbours, with the row before, the row behind and the columns at both sides.

    With each its first row, and how many spacings the first point of a map lies from the edge of the patch.
    """
    height, periodic = surface.height, surface.periodic
    nx, ny = height.shape
    if not periodic:
        for rows in blocks(nx - 2, ny):
            yield height[rows.start : rows.stop + 2], rows.start, 1.5
        return
    for rows in blocks(nx, ny):
        around = height[np.arange(rows.start - 1, rows.stop + 1) % nx]
        yield np.pad(around, ((0, 0), (1, 1)), mode="wrap"), rows.start, 0.5


def _fit(part: Floats, first: int, edge: float, noise: float) -> _Fitted:
    """The summits of the inner points of a part of a map."""
    inner = part[1:-1, 1:-1]

    def neighbours(i: int, j: int) -> Floats:
        return part[1 + i : part.shape[0] - 1 + i, 1 + j : part.shape[1] - 1 + j]

    level, above = inner - noise, np.ones(inner.shape, dtype=bool)
    for i, j in _AROUND:
        above &= level > neighbours(i, j)
    rows, columns = np.nonzero(above)
    drop = {(i, j): neighbours(i, j)[rows, columns] - inner[rows, columns] for i, j in _AROUND}

    def moment(m: int, n: int) -> Floats:
        total = np.zeros(rows.size)
        for i, j in _AROUND:
            total += i**m * j**n * drop[i, j]
        return total

    # The normal equations of drop = p i + q j + (A i^2 + 2 B i j + C j^2)/2 over the eight neighbours (i, j).
    p, q = moment(1, 0) / 6.0, moment(0, 1) / 6.0
    A = 0.6 * moment(2, 0) - 0.4 * moment(0, 2)
    C = 0.6 * moment(0, 2) - 0.4 * moment(2, 0)
    B = moment(1, 1) / 4.0

    second = moment(2, 0) + moment(0, 2) - 2.0 * moment(2, 2)
    fourth = moment(2, 2) - 2.0 * second

    with np.errstate(over="ignore", under="ignore", invalid="ignore"):  # what no float can hold is no dome
        determinant = A * C - B * B
    domed = (determinant > 0.0) & (A < 0.0)
    p, q, A, B, C, determinant = (values[domed] for values in (p, q, A, B, C, determinant))
    i_top, j_top = (B * q - C * p) / determinant, (B * p - A * q) / determinant
    # A top beyond the neighbours is an extrapolation: there the point itself is the better summit.
    trusted = np.maximum(np.abs(i_top), np.abs(j_top)) <= 1.0
    i_top, j_top = np.where(trusted, i_top, 0.0), np.where(trusted, j_top, 0.0)
    at = rows[domed], columns[domed]
    return _Fitted(
        inner[at] + 0.5 * (p * i_top + q * j_top),
        at[0] + first + edge + i_top,
        at[1] + edge + j_top,
        determinant,
        second[domed],
        fourth[domed],
        rows.size,
    )

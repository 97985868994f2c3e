"""The summits of a height map: where they are, and the paraboloid that fits each."""

import numpy as np

from roughmdr.arguments import Floats
from roughmdr.ensemble.ensemble import Ensemble
from roughmdr.ensemble.maps import HeightMap
from roughmdr.errors import SceneError

_AROUND = [(i, j) for i in (-1, 0, 1) for j in (-1, 0, 1) if (i, j) != (0, 0)]


def find_summits(surface: HeightMap, noise: float = 0.0) -> Ensemble:
    """The points above all eight neighbours by more than ``noise`` [m], each with a paraboloid that fits them.

    The fit is by least squares. Its top is the summit; the radius is 1/sqrt(k1 k2), from the geometric mean of the
    principal curvatures: that of the sphere which an elliptic contact is best replaced by (J. A. Greenwood, Wear 261
    (2006) 191). A point whose paraboloid is a saddle is no summit, nor is one beside an undefined point; the nominal
    area [m2] is that of the points that are defined. SceneError where no summit is found.

    Attributes: ``points_per_summit``; ``saddles``, the points left out as such; ``misfit``, the fourth difference
    h_xxyy over the second, h_xx + h_yy, both r.m.s. over the summits: what the fit leaves over what it finds.
    """
    height, dx, dy, periodic, _ = surface
    nx, ny = height.shape
    if periodic:
        height = np.pad(height, 1, mode="wrap")
    first = 0.5 if periodic else 1.5  # spacings from the edge of the patch to the first point that has neighbours
    inner = height[1:-1, 1:-1]

    def neighbours(i: int, j: int) -> Floats:
        return height[1 + i : height.shape[0] - 1 + i, 1 + j : height.shape[1] - 1 + j]

    level, above = inner - noise, np.ones(inner.shape, dtype=bool)
    for i, j in _AROUND:
        above &= level > neighbours(i, j)
    rows, columns = np.nonzero(above)
    drop = {(i, j): neighbours(i, j)[rows, columns] - inner[rows, columns] for i, j in _AROUND}

    def moment(m: int, n: int) -> Floats:
        total: Floats = np.sum([i**m * j**n * drop[i, j] for i, j in _AROUND], axis=0)
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
    if not domed.any():
        raise SceneError("the map has no summit: no point stands above its eight neighbours on a dome")
    p, q, A, B, C, determinant = (values[domed] for values in (p, q, A, B, C, determinant))
    i_top, j_top = (B * q - C * p) / determinant, (B * p - A * q) / determinant
    # A top beyond the neighbours is an extrapolation: there the point itself is the better summit.
    trusted = np.maximum(np.abs(i_top), np.abs(j_top)) <= 1.0
    i_top, j_top = np.where(trusted, i_top, 0.0), np.where(trusted, j_top, 0.0)
    rows, columns = rows[domed], columns[domed]
    # A top may lie across the edge of a periodic map.
    x, y = (rows + first + i_top) % nx * dx, (columns + first + j_top) % ny * dy
    defined = surface.defined
    return Ensemble.sorted(
        "paraboloid",
        inner[rows, columns] + 0.5 * (p * i_top + q * j_top),
        {"radius": dx * dy / np.sqrt(determinant)},
        defined * dx * dy,
        {"x": x, "y": y},
        {
            "patch_x": nx * dx,
            "patch_y": ny * dy,
            "points_per_summit": defined / rows.size,
            "saddles": int((~domed).sum()),
            "misfit": float(np.linalg.norm(fourth[domed]) / np.linalg.norm(second[domed])),
        },
    )

"""Find tops of a map that lie on one plane, tilted or a little bent by levelling: a detector at the end of its range.

Thresholds were chosen on an optical and an atomic-force map and Gaussian maps, clipped at 0.2 to 30 % of their points,
levelled by planes and quadratics and then given noise, and on the same maps and others that were not.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from roughmdr.ensemble.maps.height_map import blocks
from roughmdr.numerics.arguments import Floats

_USUAL = 0.7
"""Quantile of the curvatures that flat points are compared with: less than 30 % of the points lie beside an edge."""
_FLAT = (0.001, 0.01, 0.05, 0.1, 0.2)
"""Largest curvature of a flat point, over the usual one: without noise, then with increasing noise."""
_EXACT, _ROUNDED = 0.01, 1e-4
"""Largest thickness of a plateau, over the usual curvature: less than on any true surface; and without noise."""
_COARSER = (1, 2, 4, 8)  # points along the side of a block that is averaged: noise falls, curvature rises
_FEWEST, _FEWEST_NOISY = 16, 50  # fewest flat points, or blocks, of a plateau; fewest to judge its noise
_MOST = 0.3  # least share of flat points on the plateau: on rough maps they lie at any height
_RISING = 0.1  # largest ratio of points beside a plateau that are above it to those below it
_BESIDE = 3  # points around a plateau that count as beside it
_WHITE = 0.3  # largest correlation of the signs of noise at neighbouring points; true roughness has more
_MEDIAN_OF_NORMAL = 0.6745  # median magnitude of normal numbers, over their standard deviation
_MOST_COMPARED = 2**16  # most points of the sample for the usual curvature
_WITHIN = 3.0  # largest distance of points of a plateau from its plane, over its thickness
_SAMPLE, _ITERATIONS = 500, 20  # points and rounds of a fit by least absolute deviations
_ABOVE = 4.0  # weight of a deviation above, over that of one below: the fit is that of the quantile of 80 %
_LEAST_RESIDUAL = 1e-3  # residual over the curvature of flat points, below which weights are equal
_ROUNDING = 1e-13  # curvature over the largest height, below which it is a rounding error


class Plateau(NamedTuple):
    """The highest points of a map, where they lie on one smooth plane."""

    points: NDArray[np.intp]  # flat indices
    thickness: float  # r.m.s. distance from the plane
    is_exact: bool  # no noise: no surface is so flat beside its own roughness


def find_plateau(height: Floats) -> Plateau | None:
    """Return the points of a map that lie on one plane, flat as no other, with nothing beside it above; None if none.

    With noise on it, only if that is white, as a detector's.
    """
    found = list[Plateau]()
    for rows in blocks(*height.shape):
        plateau = _of_part(height[rows])
        if plateau is not None:
            found.append(plateau._replace(points=plateau.points + rows.start * height.shape[1]))
    if not found:
        return None
    points = np.concatenate([each.points for each in found])
    return Plateau(points, max(each.thickness for each in found), any(each.is_exact for each in found))


def _of_part(height: Floats) -> Plateau | None:
    """Return the plateau of a map that is no larger than a block of rows."""
    means = {block: _means(height, block) for block in _COARSER if min(height.shape) > 2 * block}
    curvatures = {block: _curvature(each) for block, each in means.items()}
    usual = {block: _usual(each) for block, each in curvatures.items()}
    for flatness in _FLAT:
        for block, each in means.items():
            found = _look(each, curvatures[block], flatness * usual[block])
            if found is None:
                continue
            flat = np.kron(found[0], np.ones((block, block), dtype=bool))
            beyond = height[: flat.shape[0], : flat.shape[1]] - _plane(flat.shape, found[1])
            thickness = float(np.median(np.abs(beyond[flat]))) / _MEDIAN_OF_NORMAL
            is_noise = flat.sum() >= _FEWEST_NOISY and _is_white(np.where(flat, beyond, np.nan))
            if thickness <= _ROUNDED * usual[1] or is_noise:
                least = max(_WITHIN * thickness, _ROUNDED * usual[1])
                row, column = np.nonzero((np.abs(beyond) <= least) & _around(flat))
                return Plateau(row * height.shape[1] + column, thickness, thickness <= _EXACT * usual[1])
    return None


def _means(height: Floats, block: int) -> Floats:
    """Return the mean heights of square blocks."""
    nx, ny = (n // block for n in height.shape)
    return height[: nx * block, : ny * block].reshape(nx, block, ny, block).mean(axis=(1, 3)) if block > 1 else height


def _curvature(height: Floats) -> Floats:
    """Return the magnitude of the second differences of heights; NaN at edges and beside undefined points."""
    curvature = np.full(height.shape, np.nan)
    middle = 2.0 * height[1:-1, 1:-1]
    along_x = height[2:, 1:-1] - middle + height[:-2, 1:-1]
    along_y = height[1:-1, 2:] - middle + height[1:-1, :-2]
    twist = 0.25 * (height[2:, 2:] - height[2:, :-2] - height[:-2, 2:] + height[:-2, :-2])
    curvature[1:-1, 1:-1] = np.sqrt(along_x**2 + along_y**2 + 2.0 * twist**2)
    return curvature


def _usual(curvature: Floats) -> float:
    """Return the curvature that flat points are compared with; 0 where there are too few points."""
    known = curvature.ravel()[:: -(-curvature.size // _MOST_COMPARED)]
    known = known[np.isfinite(known)]
    return float(np.quantile(known, _USUAL)) if known.size >= _FEWEST else 0.0


def _look(height: Floats, curvature: Floats, limit: float) -> tuple[NDArray[np.bool_], Floats] | None:
    """Return the points of a plateau, flat within a limit of the curvature, and the coefficients of its plane."""
    flat = curvature < limit
    at = np.flatnonzero(flat)
    if at.size < _FEWEST or not limit > _ROUNDING * float(np.nanmax(np.abs(height))):
        return None
    sample = at[:: -(-at.size // _SAMPLE)]
    powers = _powers(*np.divmod(sample, height.shape[1]), height.shape)
    coefficients = _fit(powers, height.flat[sample], _LEAST_RESIDUAL * limit)
    if np.mean(np.abs(height.flat[sample] - powers @ coefficients) <= 2.0 * limit) < _MOST:
        return None
    beyond = height - _plane(height.shape, coefficients)
    plateau = flat & (np.abs(beyond) <= 2.0 * limit)
    above, below = (int((_around(plateau) & (sign * beyond > 2.0 * limit)).sum()) for sign in (1.0, -1.0))
    if plateau.sum() < max(_FEWEST, _MOST * at.size) or not below or above > _RISING * below:
        return None
    return plateau, coefficients


def _powers(row: NDArray[np.intp], column: NDArray[np.intp], shape: tuple[int, ...]) -> Floats:
    """Return the powers up to the second of x and y, from -1 to 1, of points of a map of a shape."""
    x, y = np.broadcast_arrays((2.0 * row + 1.0) / shape[0] - 1.0, (2.0 * column + 1.0) / shape[1] - 1.0)
    return np.stack([np.ones_like(x), x, y, x * x, x * y, y * y], axis=-1)


def _plane(shape: tuple[int, ...], coefficients: Floats) -> Floats:
    """Return the heights of a plane, a little bent, over a map of a shape."""
    return np.asarray(_powers(np.arange(shape[0])[:, None], np.arange(shape[1]), shape) @ coefficients)


def _around(points: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return which points are given ones, or lie beside them."""
    from scipy.ndimage import binary_dilation

    return np.asarray(binary_dilation(points, iterations=_BESIDE))


def _is_white(noise: Floats) -> bool:
    """Return whether values of a map have the sign of their neighbours, where known, about as often as not."""
    signs = np.nan_to_num(np.sign(noise - np.nanmedian(noise)))
    pairs = np.concatenate([(signs[1:] * signs[:-1]).ravel(), (signs[:, 1:] * signs[:, :-1]).ravel()])
    return float(pairs.sum()) <= _WHITE * float(np.abs(pairs).sum())


def _fit(powers: Floats, height: Floats, least: float) -> Floats:
    """Return the coefficients by least absolute deviations, with more weight above, since tops are no higher."""
    weight = np.ones(height.size)
    for _ in range(_ITERATIONS):
        weighted = powers * weight[:, None]
        coefficients = np.asarray(np.linalg.lstsq(weighted.T @ powers, weighted.T @ height, rcond=None)[0], np.float64)
        beyond = height - powers @ coefficients
        weight = np.where(beyond > 0.0, _ABOVE, 1.0) / np.maximum(np.abs(beyond), least)
    return coefficients

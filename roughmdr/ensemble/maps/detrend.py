"""What is taken out of a height map before its summits are looked for: its trend, and its short waves."""

import math
from typing import Literal

import numpy as np

from roughmdr.ensemble.maps.height_map import HeightMap
from roughmdr.ensemble.maps.raw_map import blocks
from roughmdr.errors import SceneError
from roughmdr.numerics.arguments import Floats

Trend = Literal["none", "mean", "plane", "quadratic"]
_DEGREE: dict[Trend, int] = {"mean": 0, "plane": 1, "quadratic": 2}

_REACH = 1.5  # cut-offs: how far the Gaussian reaches; beyond, it is below 1e-14 of its height
_AT_CUTOFF = 1e-9  # relative; a wave as long as the cut-off is kept


def remove_trend(height: Floats, trend: Trend) -> None:
    """Take the least-squares polynomial in x and y out of a map, in place; it is fitted to the points that are not NaN.

    "mean" leaves the mean 0, "plane" no tilt either, "quadratic" no curvature of the whole.
    """
    if trend == "none":
        return
    degree = _DEGREE[trend]
    powers = [(i, j) for i in range(degree + 1) for j in range(degree + 1 - i)]
    along_x, along_y = (np.polynomial.legendre.legvander(np.linspace(-1.0, 1.0, n), degree) for n in height.shape)
    both_x, both_y = ((a[:, :, None] * a[:, None, :]).reshape(len(a), -1) for a in (along_x, along_y))
    products, moments = np.empty((len(both_x), both_y.shape[1])), np.empty_like(along_x)
    for rows in blocks(*height.shape):
        defined = np.isfinite(height[rows])
        products[rows] = defined @ both_y
        moments[rows] = np.where(defined, height[rows], 0.0) @ along_y
    products = (both_x.T @ products).reshape(4 * (degree + 1,))
    moments = along_x.T @ moments
    normal = np.array([[products[i, k, j, m] for k, m in powers] for i, j in powers])
    coefficients = np.zeros((degree + 1, degree + 1))
    coefficients[tuple(zip(*powers, strict=True))] = np.linalg.lstsq(
        normal, np.array([moments[power] for power in powers]), rcond=None
    )[0]
    for rows in blocks(*height.shape):
        height[rows] -= along_x[rows] @ coefficients @ along_y.T


def remove_short_waves(surface: HeightMap, cutoff: float) -> None:
    """Take waves shorter than ``cutoff`` [m] out of a map, in place.

    A periodic map is cut sharply in its spectrum. Any other is smoothed by the Gaussian that passes half of a wave of
    the cut-off length, and 2^-(cutoff/length)^2 of any other (ISO 16610-61); at edges and beside undefined points, it
    is the mean over what there is. SceneError where the cut-off does not fit the grid, or a periodic map has gaps.
    """
    height, dx, dy, periodic, _ = surface
    nx, ny = height.shape
    least, most = 2.0 * max(dx, dy), min(nx * dx, ny * dy)
    if not least <= cutoff <= most:
        raise SceneError(
            f"cutoff {cutoff:g} m must lie between two spacings, {least:g} m, and the map's shorter side, {most:g} m"
        )
    whole = surface.defined == height.size
    if periodic and not whole:
        raise SceneError("a periodic map with undefined points has no spectrum to cut: fill them or leave out cutoff")
    if periodic:
        _cut(height, cutoff / dx, cutoff / dy)
        return
    spacings = cutoff / dx, cutoff / dy
    if whole:
        weights = [np.ones((nx, 1)), np.ones((1, ny))]
    else:
        undefined = ~np.isfinite(height)
        weights = [1.0 - undefined]
        height[undefined] = 0.0
    for field in (height, *weights):
        _smooth(field, *spacings)
    for weight in weights:
        height /= weight
    if not whole:
        height[undefined] = np.nan


def _cut(height: Floats, along_x: float, along_y: float) -> None:
    """Cut waves that are shorter than so many spacings along x and y out of a periodic map, in place."""
    from scipy import fft

    nx, ny = height.shape
    x, y = along_x * fft.fftfreq(nx), along_y * fft.rfftfreq(ny)
    y = y[y <= 1.0 + _AT_CUTOFF]  # of the others nothing is left
    waves = np.empty((nx, y.size), dtype=np.complex128)
    for rows in blocks(nx, ny):
        waves[rows] = fft.rfft(height[rows])[:, : y.size]
    for columns in blocks(y.size, nx):
        part = fft.fft(waves[:, columns], axis=0)
        part[np.hypot(x[:, None], y[columns]) > 1.0 + _AT_CUTOFF] = 0.0
        waves[:, columns] = fft.ifft(part, axis=0)
    for rows in blocks(nx, ny):
        height[rows] = fft.irfft(waves[rows], ny)


def _smooth(field: Floats, along_x: float, along_y: float) -> None:
    """Smooth a field in place by the Gaussian of a cut-off of so many spacings along x and y; zeros lie around it.

    It is the product of a Gaussian along x and one along y. An axis along which the field is one point long, because it
    is the same everywhere, is left alone.
    """
    from scipy import fft

    for turned, spacings in ((field.T, along_x), (field, along_y)):
        n = turned.shape[1]
        if n == 1:
            continue
        around = fft.next_fast_len(n + math.ceil(_REACH * spacings), real=True)
        passed = np.exp2(-np.square(spacings * fft.rfftfreq(around)))
        for rows in blocks(*turned.shape):
            turned[rows] = fft.irfft(fft.rfft(turned[rows], around) * passed, around)[:, :n]

"""Remove the trend and the short waves of a height map before its summits are detected."""

import math
from typing import Literal

import numpy as np

from roughmdr.ensemble.maps.height_map import HeightMap, blocks
from roughmdr.errors import SceneError
from roughmdr.numerics.arguments import Floats

Trend = Literal["none", "mean", "plane", "quadratic"]
_DEGREE: dict[Trend, int] = {"mean": 0, "plane": 1, "quadratic": 2}

_KERNEL_WIDTH = 1.5  # half width of the Gaussian [cut-off]: it has fallen to about 1e-14 of its height there
_CUTOFF_RTOL = 1e-9  # a wave as long as the cut-off is kept


def remove_trend(height: Floats, trend: Trend) -> None:
    """Subtract a polynomial in x and y from a map, in place: the least-squares fit to the points that are not NaN."""
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
    right = np.array([moments[power] for power in powers])
    coefficients[tuple(zip(*powers, strict=True))] = np.linalg.lstsq(normal, right, rcond=None)[0]
    for rows in blocks(*height.shape):
        height[rows] -= along_x[rows] @ coefficients @ along_y.T


def remove_short_waves(surface: HeightMap, cutoff: float) -> None:
    """Remove waves shorter than ``cutoff`` [m] from a map, in place.

    The spectrum of a periodic map is cut sharply. Any other map is smoothed by the Gaussian filter that transmits half
    of a wave of the cut-off length, and 2^-(cutoff/length)^2 of any other (ISO 16610-61); its weights are normalised at
    edges and next to undefined points. SceneError where the cut-off does not fit the grid, or a periodic map has gaps.
    """
    height, dx, dy, periodic = surface[:4]
    nx, ny = height.shape
    shortest, longest = 2.0 * max(dx, dy), min(nx * dx, ny * dy)
    if not shortest <= cutoff <= longest:
        side = f"the map's shorter side, {longest:g} m"
        raise SceneError(f"cutoff {cutoff:g} m must lie between two spacings, {shortest:g} m, and {side}")
    complete = surface.defined == height.size
    if periodic and not complete:
        raise SceneError("a periodic map with undefined points has no spectrum to cut: fill them or leave out cutoff")
    if periodic:
        _cut_spectrum(height, cutoff / dx, cutoff / dy)
        return
    if complete:
        weights = [np.ones((nx, 1)), np.ones((1, ny))]
    else:
        undefined = ~np.isfinite(height)
        weights = [1.0 - undefined]
        height[undefined] = 0.0
    for field in (height, *weights):
        _smooth(field, cutoff / dx, cutoff / dy)
    for weight in weights:
        height /= weight
    if not complete:
        height[undefined] = np.nan


def _cut_spectrum(height: Floats, along_x: float, along_y: float) -> None:
    """Remove waves shorter than so many spacings along x and y from a periodic map, in place."""
    from scipy import fft

    nx, ny = height.shape
    x, y = along_x * fft.fftfreq(nx), along_y * fft.rfftfreq(ny)
    y = y[y <= 1.0 + _CUTOFF_RTOL]  # no other is kept
    waves = np.empty((nx, y.size), dtype=np.complex128)
    for rows in blocks(nx, ny):
        waves[rows] = fft.rfft(height[rows])[:, : y.size]
    for columns in blocks(y.size, nx):
        part = fft.fft(waves[:, columns], axis=0)
        part[np.hypot(x[:, None], y[columns]) > 1.0 + _CUTOFF_RTOL] = 0.0
        waves[:, columns] = fft.ifft(part, axis=0)
    for rows in blocks(nx, ny):
        height[rows] = fft.irfft(waves[rows], ny)


def _smooth(field: Floats, along_x: float, along_y: float) -> None:
    """Smooth a field, 0 outside, in place by the Gaussian of a cut-off of so many spacings along x and y."""
    from scipy import fft

    # The Gaussian is a product of one along x and one along y. Along an axis with one point the field is constant.
    for rows_along, spacings in ((field.T, along_x), (field, along_y)):
        n = rows_along.shape[1]
        if n == 1:
            continue
        padded = fft.next_fast_len(n + math.ceil(_KERNEL_WIDTH * spacings), real=True)
        transmission = np.exp2(-np.square(spacings * fft.rfftfreq(padded)))
        for rows in blocks(*rows_along.shape):
            rows_along[rows] = fft.irfft(fft.rfft(rows_along[rows], padded) * transmission, padded)[:, :n]

"""The waves of a height map: the moments of its spectrum, and the spectrum itself."""

from typing import NamedTuple

import numpy as np

from roughmdr.ensemble.maps.height_map import HeightMap, blocks, blocks_with_neighbours, map_statistics, mean_and_rms
from roughmdr.spectrum import MapSpectrum, Moments

_BINS = 400  # number of bins of the wave number, equal on a logarithmic scale


class MapWaves(NamedTuple):
    """A map as theories of rough surfaces need it: isotropic and Gaussian."""

    mean: float  # height [m]
    moments: Moments  # of a profile, averaged over all directions
    spectrum: MapSpectrum | None  # None where points of the map are undefined
    short_wave: float  # [m]; two spacings, unless shorter waves were cut off

    @classmethod
    def of(cls, surface: HeightMap, cutoff: float | None) -> "MapWaves":
        """Return the waves of a map, its moments by differences between neighbouring points.

        m2 is half the mean square slope, and m4 is 3/8 of the mean square of h_xx + h_yy, as of isotropic surfaces.
        """
        mean, rms_height = mean_and_rms(surface)
        slope = float(map_statistics(surface)["rms_slope"])
        moments = Moments(rms_height**2, 0.5 * slope**2, 0.375 * mean_square_laplacian(surface))
        complete = surface.defined == surface.height.size
        short_wave = 2.0 * max(surface.dx, surface.dy) if cutoff is None else cutoff
        return cls(mean, moments, _spectrum(surface, mean) if complete else None, short_wave)


def slope_ratio(surface: HeightMap) -> float:
    """Return the ratio of the r.m.s. slopes across and along the ridges of a map, at least 1.

    They are the roots of the eigenvalues of <grad h grad h>, over points whose next along x and along y is defined.
    """
    height, dx, dy, periodic = surface[:4]
    nx, ny = height.shape
    products, scale = np.zeros(3), surface.highest or 1.0
    for rows in blocks(nx if periodic else max(nx - 1, 1), ny):
        part = height[np.arange(rows.start, rows.stop + 1) % nx] / scale
        along_x, along_y = np.diff(part, axis=0) / dx, np.diff(part[:-1], axis=1, append=part[:-1, :1]) / dy
        if not periodic:
            along_x, along_y = along_x[:, :-1], along_y[:, :-1]
        known = np.isfinite(along_x) & np.isfinite(along_y)
        x, y = along_x[known], along_y[known]
        products += [x @ x, y @ y, x @ y]
    xx, yy, xy = products
    middle, half = 0.5 * (xx + yy), float(np.hypot(0.5 * (xx - yy), xy))
    return float(np.sqrt((middle + half) / max(middle - half, 1e-12 * middle))) if middle > 0.0 else 1.0


def mean_square_laplacian(surface: HeightMap) -> float:
    """Return <(h_xx + h_yy)^2> [1/m2] by second differences, over the points whose four neighbours are defined."""
    total, count = 0.0, 0
    for part, _ in blocks_with_neighbours(surface):
        inner = part[1:-1, 1:-1]
        along_x = part[2:, 1:-1] - 2.0 * inner + part[:-2, 1:-1]
        along_y = part[1:-1, 2:] - 2.0 * inner + part[1:-1, :-2]
        values = along_x / (surface.dx * surface.dx) + along_y / (surface.dy * surface.dy)
        values = values[np.isfinite(values)]
        total += float(values @ values)
        count += values.size
    return total / max(count, 1)


def _spectrum(surface: HeightMap, mean: float) -> MapSpectrum:
    """Return the variance in bins of one mean square slope each; Hann's window tapers a map that is not periodic."""
    from scipy import fft

    nx, ny = surface.height.shape
    height = surface.height - mean
    if not surface.periodic:
        along_x, along_y = (np.sin(np.pi * (np.arange(n) + 0.5) / n) ** 2 for n in (nx, ny))
        height *= along_x[:, None] / np.sqrt(np.mean(along_x**2))
        height *= along_y / np.sqrt(np.mean(along_y**2))
    variance = np.abs(fft.rfft2(height, overwrite_x=True)) ** 2 / float(nx * ny) ** 2
    variance[:, 1 : (ny + 1) // 2] *= 2.0  # of the waves of negative numbers along y too
    q = 2.0 * np.pi * np.hypot(fft.fftfreq(nx, surface.dx)[:, None], fft.rfftfreq(ny, surface.dy))
    q, variance = q[q > 0.0], variance[q > 0.0]
    log_q = np.log(q / q.min())
    numbers = np.minimum((log_q * (_BINS / log_q.max())).astype(np.int64), _BINS - 1)
    of_heights, of_slopes = (
        np.bincount(numbers, values, _BINS).astype(np.float64) for values in (variance, q * q * variance)
    )
    filled = of_slopes > 0.0
    return MapSpectrum(np.sqrt(of_slopes[filled] / of_heights[filled]), of_heights[filled])

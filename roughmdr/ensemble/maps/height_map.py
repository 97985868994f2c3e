"""A height map in metres, worked on in blocks of rows, its statistics, and its waves: spectrum and moments."""

import math
from collections.abc import Iterable, Iterator, Mapping
from types import MappingProxyType
from typing import Literal, NamedTuple

import numpy as np

from roughmdr.numerics.arguments import Floats
from roughmdr.spectrum import MapSpectrum, Moments

BLOCK_SIZE = 2**20  # points of a block
_BINS = 400  # number of bins of the wave number, equal on a logarithmic scale


class HeightMap(NamedTuple):
    """Heights on a regular grid."""

    height: Floats  # [m] over x and y; NaN where undefined
    dx: float  # spacing along x [m]
    dy: float
    periodic: bool = False  # whether the map repeats beyond its edges
    rounding: float = 0.0  # rounding error of a height in the number format of the file [m]
    attrs: Mapping[str, float | int | str] = MappingProxyType({})
    """How the file was read: ``outliers``, the number left out, ``doubtful``, a remark, and ``rows_along`` x or y."""

    @property
    def highest(self) -> float:
        """The largest magnitude of a height [m]."""
        return float(max(np.nanmax(self.height), -np.nanmin(self.height)))

    @property
    def defined(self) -> int:
        """The number of points that have a height."""
        return sum(int(np.isfinite(self.height[rows]).sum()) for rows in blocks(*self.height.shape))


def blocks(rows: int, columns: int, chunk: int = 1) -> Iterator[slice]:
    """Yield slices over the rows of a map, which bound the memory of work on it; they split no chunk of rows."""
    size = chunk * -(-BLOCK_SIZE // (columns * chunk))
    return (slice(first, min(first + size, rows)) for first in range(0, rows, size))


def blocks_with_neighbours(surface: HeightMap) -> Iterator[tuple[Floats, int]]:
    """Yield blocks of a map in a frame of neighbours, the next period or the border itself, with their first rows."""
    height, (nx, ny) = surface.height, surface.height.shape
    if not surface.periodic:
        yield from ((height[rows.start : rows.stop + 2], rows.start) for rows in blocks(nx - 2, ny))
        return
    for rows in blocks(nx, ny):
        padded = height[np.arange(rows.start - 1, rows.stop + 1) % nx]
        yield np.pad(padded, ((0, 0), (1, 1)), mode="wrap"), rows.start


def mean_and_rms(surface: HeightMap) -> tuple[float, float]:
    """Return the mean height, and the r.m.s. height about it [m]."""
    height, scale = surface.height, surface.highest or 1.0  # so that no square leaves the range of a float

    def parts() -> Iterator[Floats]:
        return (height[rows] / scale for rows in blocks(*height.shape))

    mean = sum(float(np.nansum(part)) for part in parts()) / surface.defined
    return scale * mean, scale * _rms(part - mean for part in parts())


def map_statistics(surface: HeightMap) -> dict[str, float | int | str]:
    """Return r.m.s. height [m], r.m.s. slope sqrt(<h_x^2> + <h_y^2>), the undefined fraction, and 1 if periodic."""
    height, dx, dy, periodic = surface[:4]
    nx, ny = height.shape
    scale = surface.highest or 1.0

    with_next = (np.arange(rows.start, rows.stop + 1) for rows in blocks(nx if periodic else nx - 1, ny))
    along_x = (np.diff(height[rows % nx], axis=0) / scale for rows in with_next)
    parts = (height[rows] / scale for rows in blocks(nx, ny))
    along_y = (np.diff(part, axis=1, append=part[:, : int(periodic)]) for part in parts)
    return {
        "rms_height": mean_and_rms(surface)[1],
        "rms_slope": math.hypot(_rms(along_x) * scale / dx, _rms(along_y) * scale / dy),
        "undefined_share": (height.size - surface.defined) / height.size,
        "periodic": int(periodic),
    }


def _rms(parts: Iterable[Floats]) -> float:
    """Return the r.m.s. of all numbers that are not NaN; 0 where there are none."""
    total, count = 0.0, 0
    for part in parts:
        defined = part[np.isfinite(part)]
        total += float(defined @ defined)
        count += defined.size
    return math.sqrt(total / count) if count else 0.0


def spline_mode(surface: HeightMap) -> Literal["grid-wrap", "mirror"]:
    """Return the continuation of a map's spline beyond the edges, by its name in scipy.ndimage."""
    return "grid-wrap" if surface.periodic else "mirror"


def spline_coefficients(surface: HeightMap) -> Floats:
    """Return the coefficients [m] of the cubic B-splines, [x, y]; undefined points take the nearest known height."""
    from scipy.ndimage import distance_transform_edt, spline_filter

    height = surface.height
    if surface.defined < height.size:
        where = distance_transform_edt(
            ~np.isfinite(height), (surface.dx, surface.dy), return_distances=False, return_indices=True
        )
        height = height[tuple(where)]
    return np.asarray(spline_filter(height, order=3, mode=spline_mode(surface)))


class MapWaves(NamedTuple):
    """A map as theories of rough surfaces need it: isotropic and Gaussian."""

    mean: float  # height [m]
    moments: Moments  # spectral moments of a profile, averaged over all directions
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
    variance[:, 1 : (ny + 1) // 2] *= 2.0  # waves of negative numbers along y count too
    q = 2.0 * np.pi * np.hypot(fft.fftfreq(nx, surface.dx)[:, None], fft.rfftfreq(ny, surface.dy))
    q, variance = q[q > 0.0], variance[q > 0.0]
    log_q = np.log(q / q.min())
    numbers = np.minimum((log_q * (_BINS / log_q.max())).astype(np.int64), _BINS - 1)
    of_heights, of_slopes = (
        np.bincount(numbers, values, _BINS).astype(np.float64) for values in (variance, q * q * variance)
    )
    filled = of_slopes > 0.0
    return MapSpectrum(np.sqrt(of_slopes[filled] / of_heights[filled]), of_heights[filled])

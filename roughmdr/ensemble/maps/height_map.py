"""A height map in metres, worked on in blocks of rows, and the statistics of it that its ensemble reports."""

import math
from collections.abc import Iterable, Iterator, Mapping
from types import MappingProxyType
from typing import Literal, NamedTuple

import numpy as np

from roughmdr.numerics.arguments import Floats

BLOCK_SIZE = 2**20  # points of a block


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

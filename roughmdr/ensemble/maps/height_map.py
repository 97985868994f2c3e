"""Height maps in metres, read from files of any format; undefined points are NaN."""

from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np

from roughmdr.ensemble.maps.instrument_map import read_instrument
from roughmdr.ensemble.maps.netcdf_map import read_netcdf
from roughmdr.ensemble.maps.plain_map import read_npy, read_npz, read_text
from roughmdr.ensemble.maps.raw_map import RawMap, blocks, check_points
from roughmdr.errors import RoughmdrError, SceneError
from roughmdr.numerics.arguments import Floats
from roughmdr.schema.quantities import Quantity
from roughmdr.schema.units import unit_factor

_READER_OF_SUFFIX: dict[str, Callable[[Path, str | None], RawMap]] = {
    **dict.fromkeys((".nc", ".nc4", ".cdf", ".netcdf"), read_netcdf),
    **dict.fromkeys((".txt", ".csv", ".tsv", ".dat"), read_text),
    ".npy": read_npy,
    ".npz": read_npz,
}
_READER_OF_MAGIC = ((b"CDF", read_netcdf), (b"\x89HDF", read_netcdf), (b"\x93NUMPY", read_npy))
_INSTRUMENT_SUFFIXES = (".h5", ".hdf5", ".datx")  # begin as a netCDF file does


class HeightMap(NamedTuple):
    """Heights on a regular grid."""

    height: Floats
    """[m] over x and y; NaN where undefined."""
    dx: float
    """Spacing along x [m]."""
    dy: float
    periodic: bool = False
    """Whether the map repeats beyond its edges."""
    rounding: float = 0.0
    """Rounding error of a height in the number format of the file [m]."""

    @property
    def highest(self) -> float:
        """The largest magnitude of a height [m]."""
        return float(max(np.nanmax(self.height), -np.nanmin(self.height)))

    @property
    def defined(self) -> int:
        """The number of points that have a height."""
        return sum(int(np.isfinite(self.height[rows]).sum()) for rows in blocks(*self.height.shape))


class Sides:
    """Reads the size of a map: one side of a square, or the lengths [m] along x and y."""

    dimension = "m"
    _side = Quantity("m", above=0.0)

    def __call__(self, value: object) -> float | tuple[float, float]:
        """Return one side, or both, in SI."""
        if not isinstance(value, list | tuple):
            return self._side(value)
        if len(value) != 2:
            raise RoughmdrError('must be one side, as "100 um", or two, along x and y, as ["100 um", "50 um"]')
        return self._side(value[0]), self._side(value[1])


def read_map(
    path: Path,
    *,
    size: float | tuple[float, float] | None = None,
    unit: str | None = None,
    channel: str | None = None,
    periodic: bool | None = None,
) -> HeightMap:
    """Read the map of a file; ``size`` [m] and ``unit`` say what the file does not, ``channel`` which of its maps.

    ``periodic`` overrides the file. SceneError, naming the file, where there is no map, or these do not fit it.
    """
    raw = _read_raw(path, channel)
    values = raw.height
    if values.dtype.kind not in "iuf":
        raise SceneError(f"{path}: heights are of type {values.dtype}; they must be real numbers")
    dx, dy = _spacings(path, raw, size)
    factor = _factor(path, raw, unit)
    eps = float(np.finfo(values.dtype).eps) if values.dtype.kind == "f" else 0.0
    with np.errstate(over="ignore"):  # a height out of range is undefined
        height = np.require(values, np.float64, "W")
        for rows in blocks(*height.shape):
            height[rows] *= factor
            height[rows][~np.isfinite(height[rows])] = np.nan
    surface = HeightMap(height, dx, dy, bool(raw.periodic) if periodic is None else periodic)
    if not surface.defined:
        raise SceneError(f"{path}: all its {height.size} heights are undefined")
    return surface._replace(rounding=eps * surface.highest)


def _read_raw(path: Path, channel: str | None) -> RawMap:
    try:
        with path.open("rb") as file:
            start = file.read(8)
    except OSError as error:
        raise SceneError(f"{path}: cannot be read: {error.strerror}") from None
    if not start:
        raise SceneError(f"{path}: is empty")
    suffix = path.suffix.lower()
    read = _READER_OF_SUFFIX.get(suffix)
    if read is None and suffix not in _INSTRUMENT_SUFFIXES:
        read = next((reader for magic, reader in _READER_OF_MAGIC if start.startswith(magic)), None)
    try:
        raw = (read or read_instrument)(path, channel)
        check_points(raw.height.shape)
    except RoughmdrError as error:
        raise SceneError(f"{path}: {error}") from error
    return raw


def _factor(path: Path, raw: RawMap, unit: str | None) -> float:
    """Return one unit of the heights in metres."""
    if unit is not None and raw.unit is not None:
        raise SceneError(f"{path}: the file says itself that heights are in {raw.unit}; leave out unit = {unit!r}")
    try:
        return float(unit_factor((raw.unit if unit is None else unit) or "m", "m"))
    except RoughmdrError as error:
        raise SceneError(f"{path}: units of the heights: {error}") from None


def _spacings(path: Path, raw: RawMap, size: float | tuple[float, float] | None) -> tuple[float, float]:
    nx, ny = raw.height.shape
    if raw.spacing is not None:
        if size is not None:
            sides = f"{raw.spacing[0] * nx:.4g} m x {raw.spacing[1] * ny:.4g} m"
            raise SceneError(f"{path}: the file says itself that the map is {sides}; leave out size")
        return raw.spacing
    if size is None:
        raise SceneError(f'{path}: the file does not say how large the map is; give size, as size = "100 um"')
    if isinstance(size, tuple):
        return size[0] / nx, size[1] / ny
    if nx != ny:
        raise SceneError(
            f"{path}: the map has {nx} x {ny} points, and one size is that of a square; "
            'give the sides along x and y, as size = ["100 um", "50 um"]'
        )
    return size / nx, size / ny

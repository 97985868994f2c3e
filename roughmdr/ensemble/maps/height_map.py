"""Height maps: whatever the format of the file, heights and spacings in metres, NaN where a point is undefined."""

from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np

from roughmdr.ensemble.maps.instrument import read_instrument
from roughmdr.ensemble.maps.netcdf_map import read_netcdf
from roughmdr.ensemble.maps.plain import read_npy, read_npz, read_text
from roughmdr.ensemble.maps.raw_map import RawMap, blocks, check_points
from roughmdr.errors import RoughmdrError, SceneError
from roughmdr.numerics.arguments import Floats
from roughmdr.schema.quantities import Quantity
from roughmdr.schema.units import unit_factor

_BY_SUFFIX: dict[str, Callable[[Path, str | None], RawMap]] = {
    **dict.fromkeys((".nc", ".nc4", ".cdf", ".netcdf"), read_netcdf),
    **dict.fromkeys((".txt", ".csv", ".tsv", ".dat"), read_text),
    ".npy": read_npy,
    ".npz": read_npz,
}
_BY_START = ((b"CDF", read_netcdf), (b"\x89HDF", read_netcdf), (b"\x93NUMPY", read_npy))
_INSTRUMENTS_OWN = (".h5", ".hdf5", ".datx")  # begin as a netCDF file does, and are none


class HeightMap(NamedTuple):
    """Heights on a regular grid."""

    height: Floats
    """[m] over x and y; NaN where undefined."""
    dx: float
    """Spacing along x [m]."""
    dy: float
    periodic: bool = False
    """Whether the opposite edges meet."""
    rounding: float = 0.0
    """What the number format of the file leaves of a height's last digits [m]."""

    @property
    def highest(self) -> float:
        """The largest magnitude of a height [m]."""
        return float(max(np.nanmax(self.height), -np.nanmin(self.height)))

    @property
    def defined(self) -> int:
        """How many points have a height."""
        return sum(int(np.isfinite(self.height[rows]).sum()) for rows in blocks(*self.height.shape))


class Sides:
    """Reads the size of a map: one side of a square, or the lengths [m] along x and y."""

    dimension = "m"
    _side = Quantity("m", above=0.0)

    def __call__(self, value: object) -> float | tuple[float, float]:
        """The one side, or both, in SI."""
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
    """The map in a file; ``size`` [m] and ``unit`` say what the file does not, ``channel`` which of its maps.

    ``periodic`` overrules the file. SceneError, naming the file, where there is no map or too much or little is said.
    """
    content = _content(path, channel)
    values = content.height
    if values.dtype.kind not in "iuf":
        raise SceneError(f"{path}: heights are of type {values.dtype}; they must be real numbers")
    dx, dy = _spacings(path, content, size, values.shape)
    factor = _factor(path, content, unit)
    eps = float(np.finfo(values.dtype).eps) if values.dtype.kind == "f" else 0.0
    with np.errstate(over="ignore"):  # what no float can hold is undefined
        height = np.require(values, np.float64, "W")
        for rows in blocks(*height.shape):
            height[rows] *= factor
            height[rows][~np.isfinite(height[rows])] = np.nan
    found = HeightMap(height, dx, dy, bool(content.periodic) if periodic is None else periodic)
    if not found.defined:
        raise SceneError(f"{path}: all its {height.size} heights are undefined")
    return found._replace(rounding=eps * found.highest)


def _content(path: Path, channel: str | None) -> RawMap:
    try:
        with path.open("rb") as file:
            start = file.read(8)
    except OSError as error:
        raise SceneError(f"{path}: cannot be read: {error.strerror}") from None
    if not start:
        raise SceneError(f"{path}: is empty")
    suffix = path.suffix.lower()
    known = _BY_SUFFIX.get(suffix)
    if known is None and suffix not in _INSTRUMENTS_OWN:
        known = next((read for begins, read in _BY_START if start.startswith(begins)), None)
    try:
        content = (known or read_instrument)(path, channel)
        check_points(content.height.shape)
    except RoughmdrError as error:
        raise SceneError(f"{path}: {error}") from error
    return content


def _factor(path: Path, content: RawMap, unit: str | None) -> float:
    """What one unit of the heights is in metres."""
    if unit is not None and content.unit is not None:
        raise SceneError(f"{path}: the file says itself that heights are in {content.unit}; leave out unit = {unit!r}")
    try:
        return float(unit_factor((content.unit if unit is None else unit) or "m", "m"))
    except RoughmdrError as error:
        raise SceneError(f"{path}: units of the heights: {error}") from None


def _spacings(
    path: Path, content: RawMap, size: float | tuple[float, float] | None, shape: tuple[int, ...]
) -> tuple[float, float]:
    nx, ny = shape
    if content.spacing is not None:
        if size is not None:
            own = f"{content.spacing[0] * nx:.4g} m x {content.spacing[1] * ny:.4g} m"
            raise SceneError(f"{path}: the file says itself that the map is {own}; leave out size")
        return content.spacing
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

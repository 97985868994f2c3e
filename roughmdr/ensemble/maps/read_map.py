"""Read a height map from a file: netCDF, plain numbers as text or of NumPy, or the format of an instrument.

Plain numbers are rows along y, one after the other along x; netCDF has heights over evenly spaced coordinates, both
with units. Each reader raises RoughmdrError where the file does not hold such a map.
"""

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from roughmdr.ensemble.from_file import open_dataset
from roughmdr.ensemble.maps.height_map import HeightMap, blocks
from roughmdr.ensemble.maps.instrument import read_instrument
from roughmdr.ensemble.maps.outliers import Treatment, leave_out_outliers
from roughmdr.ensemble.maps.raw_map import RawMap, Size, SizeReader, check_points, metres, spacings, spacings_of_sides
from roughmdr.ensemble.maps.text_map import read_text, refuse_channel
from roughmdr.errors import RoughmdrError
from roughmdr.numerics.arguments import Floats
from roughmdr.storage.files import NETCDF_ENDINGS

if TYPE_CHECKING:
    import xarray as xr

_INSTRUMENT_SUFFIXES = (".h5", ".hdf5", ".datx")  # begin as a netCDF file does
_SIZE_ARRAY = "size"  # name of the array with the size of the map in a .npz file
_MAX_UNEVENNESS = 1e-3  # relative variation of the spacing of a regular grid


def read_map(
    path: Path,
    *,
    size: Size | None = None,
    unit: str | None = None,
    channel: str | None = None,
    periodic: bool | None = None,
    outliers: Treatment | None = None,
) -> HeightMap:
    """Read the map of a file; ``size`` [m] and ``unit`` add what the file lacks, ``channel`` chooses among its maps.

    ``periodic`` overrides the file; ``outliers`` is their treatment. RoughmdrError where there is no map, where these
    do not fit it, and where it has outliers without a treatment.
    """
    raw = _reader(path)(path, channel)
    values = raw.height
    check_points(values.shape)
    if values.dtype.kind not in "iuf":
        raise RoughmdrError(f"heights are of type {values.dtype}; they must be real numbers")
    (dx, dy), factor = spacings(raw, size, unit), _factor(raw, unit)
    eps = float(np.finfo(values.dtype).eps) if values.dtype.kind == "f" else 0.0
    height = np.require(values, np.float64, "W")
    repeats = bool(raw.periodic) if periodic is None else periodic
    _undefine(height, 1.0)
    attrs: dict[str, float | int | str] = {}
    attrs |= leave_out_outliers(height, outliers, raw.unit or unit or "m", periodic=repeats)
    _undefine(height, factor)
    if raw.spacing is None and raw.steps is None:
        attrs["rows_along"] = raw.rows_along
    surface = HeightMap(height, dx, dy, repeats, attrs=attrs)
    if not surface.defined:
        raise RoughmdrError(f"all its {height.size} heights are undefined")
    return surface._replace(rounding=eps * surface.highest)


def _undefine(height: Floats, factor: float) -> None:
    """Multiply heights, in place; those that are not finite are undefined."""
    for rows in blocks(*height.shape):
        with np.errstate(over="ignore"):
            height[rows] *= factor
        height[rows][~np.isfinite(height[rows])] = np.nan


def _reader(path: Path) -> Callable[[Path, str | None], RawMap]:
    """Return the reader for a file, by its suffix or else by its first bytes."""
    try:
        with path.open("rb") as file:
            start = file.read(8)
    except OSError as error:
        raise RoughmdrError(f"cannot be read: {error.strerror}") from None
    if not start:
        raise RoughmdrError("is empty")
    suffix = path.suffix.lower()
    by_content = suffix not in _READER_OF_SUFFIX or _READER_OF_SUFFIX[suffix] is read_text
    if by_content and suffix not in _INSTRUMENT_SUFFIXES:
        for magic, reader in _READER_OF_MAGIC.items():
            if start.startswith(magic):
                return reader
    return _READER_OF_SUFFIX.get(suffix, read_instrument)


def _factor(raw: RawMap, unit: str | None) -> float:
    """Return one unit of the heights in metres."""
    factor = metres(raw.unit or unit or "m", "the heights")
    if unit is not None and metres(unit, "the heights") != factor:
        said = f"the file says itself that heights are in {raw.unit}; leave out unit = {unit!r}"
        raise RoughmdrError(f"units of the heights: {said}")
    return factor


def _read_numpy(path: Path, channel: str | None) -> RawMap:
    """Read the array of a .npy file, or of a .npz file ``channel``, or height, or the only one; no code is run.

    An array ``size`` of a .npz file is the size of the map [m].
    """
    try:
        loaded = np.load(path, allow_pickle=False)
    except Exception as error:
        raise RoughmdrError(f"cannot be read by NumPy: {str(error).partition('. ')[0]}") from error
    is_npz = path.suffix.lower() == ".npz"
    if isinstance(loaded, np.ndarray) == is_npz:
        own, other = (".npz", ".npy") if is_npz else (".npy", ".npz")
        raise RoughmdrError(f"not an {own} file; it may be an {other} file under another name")
    if not is_npz:
        refuse_channel(channel)
        return RawMap(loaded)
    with loaded:
        names = list(loaded.files)
        maps = [name for name in names if name != _SIZE_ARRAY] or names
        name = channel or ("height" if "height" in maps or len(maps) != 1 else maps[0])
        if name not in names:
            raise RoughmdrError(f"has no array {name!r}, but {names}; name one as channel")
        height = _array_of(loaded, name)
        if _SIZE_ARRAY not in names or name == _SIZE_ARRAY:
            return RawMap(height)
        check_points(height.shape)
        try:
            size = SizeReader()(_array_of(loaded, _SIZE_ARRAY).squeeze().tolist())
        except RoughmdrError as error:
            raise RoughmdrError(f"its array {_SIZE_ARRAY!r}, the size of the map: {error}") from None
        return RawMap(height, spacing=spacings_of_sides(size, *height.shape))


def _array_of(loaded: Any, name: str) -> NDArray[Any]:
    """Return an array of an open .npz file."""
    try:
        return np.asarray(loaded[name])
    except Exception as error:
        raise RoughmdrError(f"its array {name!r} cannot be read: {error}") from error


def _read_netcdf(path: Path, channel: str | None) -> RawMap:
    """Read the variable ``channel``, or height, or heights as SurfaceTopography writes it; fill values become NaN."""
    with open_dataset(path) as dataset:
        name = channel or ("heights" if "height" not in dataset and "heights" in dataset else "height")
        if name not in dataset.data_vars or dataset[name].ndim != 2:
            raise RoughmdrError(f"it must hold a variable {name} over two dimensions; it has {list(dataset.data_vars)}")
        height = dataset[name]
        check_points(height.shape)
        # In blocks, since packed heights take several times the memory while they are unpacked; rows that the file
        # compresses together are read together, and so only once.
        values = np.empty(height.shape, height.dtype)
        for rows in blocks(len(values), values[0].size, (height.encoding.get("chunksizes") or (1,))[0]):
            values[rows] = height[rows].to_numpy()
        dims = height.dims
        if dims == ("y", "x"):
            values, dims = values.T, dims[::-1]
        dx, dy = (_spacing(dataset, str(dim)) for dim in dims)
        holders = [dataset, *(dataset[dim] for dim in dims)]  # SurfaceTopography says it of each coordinate
        said = [holder.attrs["periodic"] for holder in holders if "periodic" in holder.attrs]
        for periodic in said:
            if np.ndim(periodic) != 0 or periodic not in (0, 1):
                raise RoughmdrError(f"the attribute periodic is {periodic!r}; it must be 0 or 1")
        return RawMap(values, _unit_of(height) or None, (dx, dy), all(map(bool, said)) if said else None)


def _unit_of(variable: "xr.DataArray") -> str:
    """Return the unit of a variable: its attribute ``units``, or ``unit`` as SurfaceTopography writes it."""
    return str(variable.attrs.get("units", variable.attrs.get("unit", ""))).strip()


def _spacing(dataset: "xr.Dataset", dim: str) -> float:
    """Return the spacing [m] of a coordinate; RoughmdrError unless it is even."""
    if dim not in dataset.coords:
        raise RoughmdrError(f"the coordinate {dim} is missing; it says where the points lie")
    coordinate = dataset[dim]
    if coordinate.dtype.kind not in "iuf":
        raise RoughmdrError(f"the coordinate {dim} is of type {coordinate.dtype}; it must be numbers")
    factor = metres(_unit_of(coordinate), dim)
    with np.errstate(all="ignore"):  # steps that are not finite are not even
        steps = np.diff(np.asarray(coordinate.to_numpy(), dtype=np.float64) * factor)
        mean = float(np.mean(steps))
        uneven = not np.isfinite(mean) or mean == 0.0 or np.ptp(steps) > _MAX_UNEVENNESS * abs(mean)
    if uneven:
        raise RoughmdrError(f"the coordinate {dim} is not evenly spaced")
    return abs(mean)


_READER_OF_SUFFIX: dict[str, Callable[[Path, str | None], RawMap]] = {
    **dict.fromkeys(NETCDF_ENDINGS, _read_netcdf),
    **dict.fromkeys((".txt", ".csv", ".tsv", ".dat", ".xyz", ".asc"), read_text),
    **dict.fromkeys((".npy", ".npz"), _read_numpy),
}
_READER_OF_MAGIC = {b"CDF": _read_netcdf, b"\x89HDF": _read_netcdf, b"\x93NUMPY": _read_numpy}

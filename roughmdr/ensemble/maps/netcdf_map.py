"""Height maps in netCDF: height over evenly spaced coordinates, both with units."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from roughmdr.ensemble.from_file import open_dataset
from roughmdr.ensemble.maps.raw_map import RawMap, blocks, check_points
from roughmdr.errors import RoughmdrError
from roughmdr.schema.units import unit_factor

if TYPE_CHECKING:
    import xarray as xr

_MAX_UNEVENNESS = 1e-3  # relative variation of the spacing of a regular grid


def read_netcdf(path: Path, channel: str | None) -> RawMap:
    """Read the variable ``channel``, or height; fill values become NaN. RoughmdrError where there is none."""
    name = channel or "height"
    with open_dataset(path) as dataset:
        if name not in dataset.data_vars or dataset[name].ndim != 2:
            raise RoughmdrError(f"it must hold a variable {name} over two dimensions; it has {list(dataset.data_vars)}")
        height = dataset[name]
        check_points(height.shape)
        values, dims = _values(height), height.dims
        if dims == ("y", "x"):
            values, dims = values.T, dims[::-1]
        dx, dy = (_spacing(dataset, str(dim)) for dim in dims)
        unit = str(height.attrs.get("units", "")).strip() or None
        return RawMap(values, unit, (dx, dy), _periodic(dataset))


def _values(height: "xr.DataArray") -> NDArray[Any]:
    """Read heights in blocks, since packed ones take several times the memory while they are unpacked.

    Rows that the file compresses together are read together, and so only once.
    """
    values = np.empty(height.shape, height.dtype)
    chunk = (height.encoding.get("chunksizes") or (1,))[0]
    for rows in blocks(values.shape[0], values.shape[1], chunk):
        values[rows] = height[rows].to_numpy()
    return values


def _spacing(dataset: "xr.Dataset", dim: str) -> float:
    if dim not in dataset.coords:
        raise RoughmdrError(f"the coordinate {dim} is missing; it says where the points lie")
    coordinate = dataset[dim]
    if coordinate.dtype.kind not in "iuf":
        raise RoughmdrError(f"the coordinate {dim} is of type {coordinate.dtype}; it must be numbers")
    try:
        factor = float(unit_factor(str(coordinate.attrs.get("units", "")), "m"))
    except RoughmdrError as error:
        raise RoughmdrError(f"units of {dim}: {error}") from None
    with np.errstate(all="ignore"):  # steps that are not finite are not even
        steps = np.diff(np.asarray(coordinate.to_numpy(), dtype=np.float64) * factor)
        mean = float(np.mean(steps))
        uneven = not np.isfinite(mean) or mean == 0.0 or np.ptp(steps) > _MAX_UNEVENNESS * abs(mean)
    if uneven:
        raise RoughmdrError(f"the coordinate {dim} is not evenly spaced")
    return abs(mean)


def _periodic(dataset: "xr.Dataset") -> bool | None:
    value = dataset.attrs.get("periodic")
    if value is None:
        return None
    if np.ndim(value) != 0 or value not in (0, 1):
        raise RoughmdrError(f"the attribute periodic is {value!r}; it must be 0 or 1")
    return bool(value)

"""Height maps in netCDF: height over evenly spaced coordinates, both with units."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from roughmdr.ensemble.datasets import opened
from roughmdr.ensemble.maps.raw_map import RawMap, blocks, check_points
from roughmdr.errors import RoughmdrError
from roughmdr.schema.units import unit_factor

if TYPE_CHECKING:
    import xarray as xr

_UNEVEN = 1e-3  # a spacing that varies by more than this part is no regular grid


def read_netcdf(path: Path, channel: str | None) -> RawMap:
    """The variable ``channel``, or height, over x and y; fill values become NaN. RoughmdrError where there is none."""
    name = channel or "height"
    with opened(path) as dataset:
        if name not in dataset.data_vars or dataset[name].ndim != 2:
            raise RoughmdrError(f"it must hold a variable {name} over two dimensions; it has {list(dataset.data_vars)}")
        height = dataset[name]
        check_points(height.shape)
        turned = height.dims == ("y", "x")
        values, dims = _values(height), height.dims
        if turned:
            values, dims = values.T, dims[::-1]
        dx, dy = (_spacing(dataset, str(dim)) for dim in dims)
        unit = str(height.attrs.get("units", "")).strip() or None
        return RawMap(values, unit, (dx, dy), _periodic(dataset))


def _values(height: "xr.DataArray") -> NDArray[Any]:
    """Read in blocks, since what is packed or has fill values is several times as large while it is unpacked.

    What the file compresses together is read together, and so only once.
    """
    values = np.empty(height.shape, height.dtype)
    together = (height.encoding.get("chunksizes") or (1,))[0]
    for rows in blocks(values.shape[0], values.shape[1], together):
        values[rows] = height[rows].to_numpy()
    return values


def _spacing(dataset: "xr.Dataset", dim: str) -> float:
    if dim not in dataset.coords:
        raise RoughmdrError(f"the coordinate {dim} is missing; it says where the points lie")
    along = dataset[dim]
    if along.dtype.kind not in "iuf":
        raise RoughmdrError(f"the coordinate {dim} is of type {along.dtype}; it must be numbers")
    try:
        factor = float(unit_factor(str(along.attrs.get("units", "")), "m"))
    except RoughmdrError as error:
        raise RoughmdrError(f"units of {dim}: {error}") from None
    with np.errstate(all="ignore"):  # what is not finite is not even
        steps = np.diff(np.asarray(along.to_numpy(), dtype=np.float64) * factor)
        mean = float(np.mean(steps))
        uneven = not np.isfinite(mean) or mean == 0.0 or np.ptp(steps) > _UNEVEN * abs(mean)
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

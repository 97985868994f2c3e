"""Height maps in netCDF: height over evenly spaced coordinates, both with units."""

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from roughmdr.ensemble.content import Content, check_points
from roughmdr.errors import RoughmdrError
from roughmdr.units import unit_factor

if TYPE_CHECKING:
    import xarray as xr

_UNEVEN = 1e-3  # a spacing that varies by more than this part is no regular grid


def read_netcdf(path: Path, channel: str | None) -> Content:
    """The variable ``channel``, or height, over x and y; fill values become NaN. RoughmdrError where there is none."""
    import xarray as xr

    name = channel or "height"
    try:
        with xr.open_dataset(path) as dataset:
            dataset.load()
    except Exception as error:
        raise RoughmdrError(f"not a netCDF file that can be read ({type(error).__name__})") from error
    if name not in dataset.data_vars or dataset[name].ndim != 2:
        raise RoughmdrError(f"it must hold a variable {name} over two dimensions; it has {list(dataset.data_vars)}")
    height = dataset[name].transpose("x", "y") if set(dataset[name].dims) == {"x", "y"} else dataset[name]
    check_points(height.shape)
    dx, dy = (_spacing(dataset, str(dim)) for dim in height.dims)
    unit = str(height.attrs.get("units", "")).strip() or None
    return Content(height.to_numpy(), unit, (dx, dy), _periodic(dataset))


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
    steps = np.diff(np.asarray(along.to_numpy(), dtype=np.float64) * factor)
    mean = float(np.mean(steps))
    if not np.isfinite(mean) or mean == 0.0 or np.ptp(steps) > _UNEVEN * abs(mean):
        raise RoughmdrError(f"the coordinate {dim} is not evenly spaced")
    return abs(mean)


def _periodic(dataset: "xr.Dataset") -> bool | None:
    value = dataset.attrs.get("periodic")
    if value is None:
        return None
    if np.ndim(value) != 0 or value not in (0, 1):
        raise RoughmdrError(f"the attribute periodic is {value!r}; it must be 0 or 1")
    return bool(value)

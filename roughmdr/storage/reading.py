"""Reading the arrays of a file, whatever its format: netCDF, or the folder of a Zarr store."""

from pathlib import Path
from typing import Any

from roughmdr.errors import RoughmdrError
from roughmdr.storage.files import ZARR_ENDING, is_zarr
from roughmdr.storage.labelled import Labelled
from roughmdr.storage.netcdf_store import read_netcdf, read_netcdf_outline
from roughmdr.storage.zarr_store import read_zarr, read_zarr_outline


def read_arrays(path: Path) -> Labelled:
    """Return all of a file; RoughmdrError if it cannot be read."""
    return read_zarr(path) if _is_store(path) else read_netcdf(path)


def read_dimensions(path: Path) -> dict[str, tuple[str, ...]]:
    """Return the dimensions of each array of a file; RoughmdrError if it cannot be read."""
    return _outline(path)[1]


def read_attribute(path: Path, name: str) -> str:
    """Return one attribute of a file; RoughmdrError if it cannot be read, or is missing, or is no string."""
    value = _outline(path)[0].get(name)
    if not isinstance(value, str):
        raise RoughmdrError(f"it has no {name}" if value is None else f"the attribute {name} is no text")
    return value


def _outline(path: Path) -> tuple[dict[str, Any], dict[str, tuple[str, ...]]]:
    return read_zarr_outline(path) if _is_store(path) else read_netcdf_outline(path)


def _is_store(path: Path) -> bool:
    """Return whether a Zarr store is to be read; RoughmdrError where a folder named so is none."""
    if path.suffix.lower() == ZARR_ENDING and path.is_dir() and not is_zarr(path):
        raise RoughmdrError("is no Zarr store: it has no zarr.json")
    return is_zarr(path)

"""netCDF files of maps and ensembles, as xarray reads them: fill values are NaN, packed numbers are unpacked."""

import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from roughmdr.errors import RoughmdrError

if TYPE_CHECKING:
    import xarray as xr


@contextmanager
def opened(path: Path) -> "Iterator[xr.Dataset]":
    """The dataset of a file, whose arrays are read when they are used; RoughmdrError where that fails."""
    import xarray as xr

    try:
        with warnings.catch_warnings(action="ignore"), xr.open_dataset(path, decode_times=False) as dataset:
            yield dataset
    except RoughmdrError:
        raise
    except Exception as error:  # whatever xarray, and what it reads with, come upon in a file not written by them
        raise RoughmdrError(f"not a netCDF file that can be read ({type(error).__name__})") from error

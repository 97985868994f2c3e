"""netCDF files as anyone may have written them: read, or refused with a RoughmdrError."""

import threading
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from roughmdr.errors import RoughmdrError
from roughmdr.files import check_ordinary
from roughmdr.labelled import Array, Labelled
from roughmdr.variables import BESIDE

if TYPE_CHECKING:
    import netCDF4

LOCK = threading.Lock()
"""To be held by whoever is in the library, which crashes where two threads are."""


def load(path: Path) -> Labelled:
    """All that is in a file; RoughmdrError where it cannot be read."""
    with _opened(path) as file:
        file.set_auto_mask(False)
        return _arrays(file)


def load_text(path: Path, name: str) -> str:
    """One attribute of a file; RoughmdrError where it cannot be read, or holds no such text."""
    with _opened(path) as file:
        value = file.getncattr(name) if name in file.ncattrs() else None
    if not isinstance(value, str):
        raise RoughmdrError(f"it holds no {name}" if value is None else f"the attribute {name} is no text")
    return value


@contextmanager
def _opened(path: Path) -> "Iterator[netCDF4.Dataset]":
    import netCDF4

    check_ordinary(path)
    try:
        # Warnings are of types and packings that are not understood: such variables are left out, or left packed.
        with LOCK, warnings.catch_warnings(action="ignore"), netCDF4.Dataset(path) as file:
            yield file
    except Exception as error:  # whatever the library comes upon in a file that was not written by it
        raise RoughmdrError(f"not a netCDF file that can be read ({error})") from None


def _arrays(file: "netCDF4.Dataset") -> Labelled:
    arrays, beside = {}, {*file.dimensions, *BESIDE}
    for name, variable in file.variables.items():
        attrs = {key: variable.getncattr(key) for key in variable.ncattrs()}
        others = attrs.pop("coordinates", "")
        beside |= set(others.split()) if isinstance(others, str) else set()
        attrs.pop("_FillValue", None)
        arrays[name] = Array(variable.dimensions, np.asarray(variable[...]), attrs)
        if arrays[name].values.ndim != len(variable.dimensions):  # letters of a text, in the classic format
            raise ValueError(f"{name} is a text made of letters; it must be one of netCDF-4")
    return Labelled(
        {name: array for name, array in arrays.items() if name not in beside},
        {name: array for name, array in arrays.items() if name in beside},
        {key: file.getncattr(key) for key in file.ncattrs()},
    )

"""Reading netCDF files, whoever wrote them; a file that cannot be read is refused with a RoughmdrError.

If memory runs out while HDF5 converts strings, it frees memory that it never had, and the process dies. So memory to
work with is checked beforehand, and strings are read a few at a time.
"""

import math
import threading
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import EllipsisType
from typing import TYPE_CHECKING, Any

import numpy as np

from roughmdr.errors import RoughmdrError
from roughmdr.storage.coordinates import labelled_of
from roughmdr.storage.files import check_regular_file
from roughmdr.storage.labelled import Array, Labelled
from roughmdr.storage.memory import check_memory
from roughmdr.storage.room import Room, beside

if TYPE_CHECKING:
    import netCDF4

LOCK = threading.Lock()
"""Held by every call of the library, which crashes when two threads are in it."""
WORKING_MEMORY = 2**26  # bytes that the library needs at most while it handles a block of an array
_BLOCK_SIZE = 2**16  # elements of an array handed to the library at a time


def read_netcdf(path: Path) -> Labelled:
    """Return a whole file; RoughmdrError if it cannot be read."""
    with _open(path) as file:
        file.set_auto_mask(False)
        arrays, room = {}, beside(path)
        for name, variable in file.variables.items():
            attrs = {key: variable.getncattr(key) for key in variable.ncattrs()}
            arrays[name] = Array(variable.dimensions, _read_values(variable, room), attrs)
            if arrays[name].values.ndim != len(variable.dimensions):  # characters of a string, in the classic format
                raise ValueError(f"{name} is an array of characters; it must be one of netCDF-4 strings")
        return labelled_of(arrays, {key: file.getncattr(key) for key in file.ncattrs()})


def read_netcdf_attributes(path: Path) -> dict[str, Any]:
    """Return the attributes of a file; RoughmdrError if it cannot be read."""
    with _open(path) as file:
        return {name: file.getncattr(name) for name in file.ncattrs()}


def read_netcdf_dimensions(path: Path) -> dict[str, tuple[str, ...]]:
    """Return the dimensions of each array of a file; RoughmdrError if it cannot be read."""
    with _open(path) as file:
        return {name: variable.dimensions for name, variable in file.variables.items()}


@contextmanager
def _open(path: Path) -> "Iterator[netCDF4.Dataset]":
    import netCDF4

    check_regular_file(path)
    check_memory(WORKING_MEMORY, "to read a file")
    try:
        # Warnings are on types and packings that netCDF4 does not support: such variables are left out or left packed.
        with LOCK, warnings.catch_warnings(action="ignore"), netCDF4.Dataset(path) as file:
            yield file
    except RoughmdrError:
        raise
    except Exception as error:  # a damaged or foreign file can make the library raise anything
        reason = "a scene, of which roughmdr run makes a result" if path.suffix.lower() == ".toml" else error
        raise RoughmdrError(f"not a netCDF file that can be read ({reason})") from None


def _read_values(variable: "netCDF4.Variable[Any]", room: Room) -> np.ndarray[Any, Any]:
    """Return the values of a variable; equal strings share one object."""
    if variable.dtype == np.float64:
        numbers = room.empty(variable.shape)
        for block in blocks(variable.shape):
            numbers[block] = variable[block]
        return numbers
    if variable.dtype is not str:
        return np.asarray(variable[...])
    values, seen = np.empty(variable.shape, dtype=object), dict[str, str]()
    for block in blocks(variable.shape):
        texts = np.asarray(variable[block], dtype=object)
        values[block] = np.array([seen.setdefault(text, text) for text in texts.flat], object).reshape(texts.shape)
    return values


def blocks(shape: tuple[int, ...]) -> Iterator[tuple[slice | EllipsisType, ...]]:
    """Yield indices that split an array into blocks of a limited number of elements."""
    row = math.prod(shape[1:])
    if not shape:
        yield (...,)
    elif row > _BLOCK_SIZE:
        for first in range(shape[0]):
            for rest in blocks(shape[1:]):
                yield slice(first, first + 1), *rest
    else:
        rows = _BLOCK_SIZE // max(row, 1)
        for first in range(0, shape[0], rows):
            yield slice(first, first + rows), ...

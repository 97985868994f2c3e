"""netCDF files as anyone may have written them: read, or refused with a RoughmdrError.

Where memory gives out while HDF5 converts texts, it frees what it never had, and the process dies: so there must be
room for what it works with, and texts go out of it a few at a time.
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
from roughmdr.storage.files import check_ordinary
from roughmdr.storage.labelled import Array, Labelled
from roughmdr.storage.memory import check_room
from roughmdr.variables import AUXILIARY_COORDINATES

if TYPE_CHECKING:
    import netCDF4

LOCK = threading.Lock()
"""To be held by whoever is in the library, which crashes where two threads are."""
WORKING_MEMORY = 2**26
"""Bytes that the library takes at most while it has a piece of an array."""
_PIECE = 2**16  # elements of an array that are in the library at a time


def load(path: Path) -> Labelled:
    """Read a whole file; RoughmdrError where it cannot be read."""
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


def load_dimensions(path: Path) -> dict[str, tuple[str, ...]]:
    """The dimensions of each array of a file; RoughmdrError where it cannot be read."""
    with _opened(path) as file:
        return {name: variable.dimensions for name, variable in file.variables.items()}


@contextmanager
def _opened(path: Path) -> "Iterator[netCDF4.Dataset]":
    import netCDF4

    check_ordinary(path)
    check_room(WORKING_MEMORY, "to read a file")
    try:
        # Warnings are of types and packings that are not understood: such variables are left out, or left packed.
        with LOCK, warnings.catch_warnings(action="ignore"), netCDF4.Dataset(path) as file:
            yield file
    except Exception as error:  # whatever the library comes upon in a file that was not written by it
        raise RoughmdrError(f"not a netCDF file that can be read ({error})") from None


def _arrays(file: "netCDF4.Dataset") -> Labelled:
    arrays, beside = {}, {*file.dimensions, *AUXILIARY_COORDINATES}
    for name, variable in file.variables.items():
        attrs = {key: variable.getncattr(key) for key in variable.ncattrs()}
        others = attrs.pop("coordinates", "")
        beside |= set(others.split()) if isinstance(others, str) else set()
        attrs.pop("_FillValue", None)
        arrays[name] = Array(variable.dimensions, _values(variable), attrs)
        if arrays[name].values.ndim != len(variable.dimensions):  # letters of a text, in the classic format
            raise ValueError(f"{name} is a text made of letters; it must be one of netCDF-4")
    return Labelled(
        {name: array for name, array in arrays.items() if name not in beside},
        {name: array for name, array in arrays.items() if name in beside},
        {key: file.getncattr(key) for key in file.ncattrs()},
    )


def _values(variable: "netCDF4.Variable[Any]") -> np.ndarray[Any, Any]:
    """The values of a variable; texts that are the same are one."""
    if variable.dtype is not str:
        return np.asarray(variable[...])
    values, known = np.empty(variable.shape, dtype=object), dict[str, str]()
    for piece in pieces(variable.shape):
        part = np.asarray(variable[piece], dtype=object)
        values[piece] = np.array([known.setdefault(text, text) for text in part.flat], dtype=object).reshape(part.shape)
    return values


def pieces(shape: tuple[int, ...]) -> Iterator[tuple[slice | EllipsisType, ...]]:
    """Parts of an array that together are all of it, of a limited number of elements each."""
    row = math.prod(shape[1:])
    if not shape:
        yield (...,)
    elif row > _PIECE:
        for first in range(shape[0]):
            for rest in pieces(shape[1:]):
                yield slice(first, first + 1), *rest
    else:
        rows = _PIECE // max(row, 1)
        for first in range(0, shape[0], rows):
            yield slice(first, first + rows), ...

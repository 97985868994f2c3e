"""NetCDF-4 files: written by one thread, block by block, and read, whoever wrote them.

If memory or disk space runs out while HDF5 converts strings, it frees memory that it never had, and the process dies.
So memory to work with is checked beforehand, all the disk space that a file can take is reserved before anything is
written, and strings are read and written a few at a time.
"""

import errno
import os
import threading
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import EllipsisType
from typing import TYPE_CHECKING, Any

import numpy as np

from roughmdr.errors import RoughmdrError, StoreError
from roughmdr.schema.wording import format_bytes
from roughmdr.storage.files import check_regular_file, replace_atomically
from roughmdr.storage.labelled import Array, Labelled, blocks, chunks_of
from roughmdr.storage.memory import check_memory
from roughmdr.storage.room import Room, beside

if TYPE_CHECKING:
    import netCDF4

_LOCK = threading.Lock()
"""Held by every call of the library, which crashes when two threads are in it."""
_WORKING_MEMORY = 2**26  # bytes that the library needs at most while it handles a block of an array
_BLOCK_SIZE = 2**16  # elements of an array handed to the library at a time
_NOT_SUPPORTED = (errno.EOPNOTSUPP, errno.EINVAL, errno.ENOSYS, errno.ENODEV)  # file systems that cannot reserve space
# Bounds on the size of a file besides its numbers [byte]: in all, for each array and attribute, and for each text.
_FILE_OVERHEAD, _ARRAY_OVERHEAD, _ATTRIBUTE_OVERHEAD, _TEXT_OVERHEAD = 2**15, 2**11, 2**8, 56


def write_netcdf(data: Labelled, path: Path, folder: Path | None = None) -> None:
    """Write ``data`` to ``path`` atomically, through a temporary file in ``folder``; StoreError if that fails."""
    with replace_atomically(path, folder) as temporary:
        try:
            write_arrays(data, temporary)
        except RuntimeError as error:  # raised by the library
            raise StoreError(f"{path}: cannot be written: {error}") from None


def write_arrays(data: Labelled, path: Path) -> None:
    """Turn ``path``, an empty file, into a netCDF-4 file; OSError, RuntimeError or MemoryError if that fails.

    The OSError gives the size of the file if the disk is full.
    """
    import netCDF4

    check_memory(_WORKING_MEMORY, "to write a file")
    size = max_file_size(data)
    _reserve(path, size)
    with _LOCK:
        with netCDF4.Dataset(path, "w", format="NETCDF4") as file:
            _define(file, data)
        _reserve(path, size)
        with netCDF4.Dataset(path, "r+") as file:  # closing it truncates the excess that was reserved
            for name, array in (data.coordinates | data.variables).items():
                values = array.values
                for block in _blocks(values.shape):
                    part = values[block]
                    file[name][block] = part.astype(object) if part.dtype.kind == "U" else part


def _define(file: "netCDF4.Dataset", data: Labelled) -> None:
    """Write everything but the values."""
    file.setncatts(data.attrs)
    for dimension, size in data.sizes.items():
        file.createDimension(dimension, size)
    for name, array in (data.coordinates | data.variables).items():
        kind = array.values.dtype.kind
        fill = np.nan if kind == "f" and name in data.variables else None
        variable = file.createVariable(name, str if kind in "OU" else array.values.dtype, array.dims, fill_value=fill)
        variable.setncatts(data.attributes_in_file(name))


def _reserve(path: Path, size: int) -> None:
    """Reserve disk space for a file; OSError if there is too little, or if no file may become so large."""
    if not hasattr(os, "posix_fallocate"):
        return
    with path.open("r+b") as file:
        try:
            os.posix_fallocate(file.fileno(), 0, size)
        except OSError as error:
            if error.errno not in _NOT_SUPPORTED:
                reason = f"{os.strerror(error.errno or 0)}, and it takes up to {format_bytes(size)}"
                raise OSError(error.errno, reason) from None


def max_file_size(data: Labelled) -> int:
    """Return an upper bound [byte] of the file that these arrays make."""
    arrays = [*data.variables.values(), *data.coordinates.values()]
    attrs = [data.attrs, *(array.attrs for array in arrays)]
    attr_size = sum(_ATTRIBUTE_OVERHEAD + len(str(value).encode()) for each in attrs for value in each.values())
    return _FILE_OVERHEAD + attr_size + sum(_ARRAY_OVERHEAD + _size_in_file(array.values) for array in arrays)


def _size_in_file(values: np.ndarray[Any, Any]) -> int:
    if values.dtype.kind not in "OU":
        return values.nbytes
    texts = sum(len("".join(map(str, values[block].ravel().tolist())).encode()) for block in _blocks(values.shape))
    return texts + values.size * _TEXT_OVERHEAD


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
        return Labelled.from_file(arrays, {key: file.getncattr(key) for key in file.ncattrs()})


def read_netcdf_outline(path: Path) -> tuple[dict[str, Any], dict[str, tuple[str, ...]]]:
    """Return the attributes of a file, and the dimensions of each array; RoughmdrError if it cannot be read."""
    with _open(path) as file:
        dimensions = {name: variable.dimensions for name, variable in file.variables.items()}
        return {name: file.getncattr(name) for name in file.ncattrs()}, dimensions


@contextmanager
def _open(path: Path) -> "Iterator[netCDF4.Dataset]":
    import netCDF4

    check_regular_file(path)
    check_memory(_WORKING_MEMORY, "to read a file")
    try:
        # Warnings are on types and packings that netCDF4 does not support: such variables are left out or left packed.
        with _LOCK, warnings.catch_warnings(action="ignore"), netCDF4.Dataset(path) as file:
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
        for block in _blocks(variable.shape):
            numbers[block] = variable[block]
        return numbers
    if variable.dtype is not str:
        return np.asarray(variable[...])
    values, seen = np.empty(variable.shape, dtype=object), dict[str, str]()
    for block in _blocks(variable.shape):
        texts = np.asarray(variable[block], dtype=object)
        values[block] = np.array([seen.setdefault(text, text) for text in texts.flat], object).reshape(texts.shape)
    return values


def _blocks(shape: tuple[int, ...]) -> Iterator[tuple[slice | EllipsisType, ...]]:
    """Yield the indices of the blocks in which an array is handed to the library."""
    return blocks(shape, chunks_of(shape, _BLOCK_SIZE))

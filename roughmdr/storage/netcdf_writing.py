"""Writing netCDF-4 files, by one thread, block by block.

If memory or disk space runs out while HDF5 converts strings, it frees memory that it never had, and the process dies.
So all the disk space that a file can take is reserved before anything is written, and strings are written a few at a
time.
"""

import errno
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from roughmdr.errors import StoreError
from roughmdr.schema.wording import format_bytes
from roughmdr.storage.coordinates import attributes_in_file
from roughmdr.storage.files import replace_atomically
from roughmdr.storage.labelled import Labelled
from roughmdr.storage.memory import check_memory
from roughmdr.storage.netcdf_reading import LOCK, WORKING_MEMORY, blocks

if TYPE_CHECKING:
    import netCDF4

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

    check_memory(WORKING_MEMORY, "to write a file")
    size = max_file_size(data)
    _reserve(path, size)
    with LOCK:
        with netCDF4.Dataset(path, "w", format="NETCDF4") as file:
            _define(file, data)
        _reserve(path, size)
        with netCDF4.Dataset(path, "r+") as file:  # closing it truncates the excess that was reserved
            for name, array in (data.coordinates | data.variables).items():
                values = array.values
                for block in blocks(values.shape):
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
        variable.setncatts(attributes_in_file(data, name))


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
    texts = sum(len("".join(map(str, values[block].ravel().tolist())).encode()) for block in blocks(values.shape))
    return texts + values.size * _TEXT_OVERHEAD

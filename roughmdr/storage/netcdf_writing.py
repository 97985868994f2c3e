"""Arrays into a netCDF-4 file, by one thread, piece by piece.

Where memory or the disk gives out while HDF5 converts texts, it frees what it never had, and the process dies. So all
the room that a file can take is its own before anything is written, and texts go in a few at a time.
"""

import errno
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from roughmdr.schema.wording import bytes_in_words
from roughmdr.storage.labelled import Labelled
from roughmdr.storage.memory import check_room
from roughmdr.storage.netcdf import LOCK, WORKING_MEMORY, pieces

if TYPE_CHECKING:
    import netCDF4

_UNABLE = (errno.EOPNOTSUPP, errno.EINVAL, errno.ENOSYS, errno.ENODEV)  # what disks say that give no room beforehand
# What a file takes at most beside its numbers [byte]: in all, for each array and attribute, and for each text.
_FILE, _ARRAY, _ATTRIBUTE, _TEXT = 2**15, 2**11, 2**8, 56


def write_arrays(data: Labelled, path: Path) -> None:
    """Make ``path``, which is there and empty, a netCDF-4 file; OSError, RuntimeError or MemoryError where that fails.

    OSError names the reason where the disk is full.
    """
    import netCDF4

    check_room(WORKING_MEMORY, "to write a file")
    size = most_bytes(data)
    _reserve(path, size)
    with LOCK:
        with netCDF4.Dataset(path, "w", format="NETCDF4") as file:
            _define(file, data)
        _reserve(path, size)
        with netCDF4.Dataset(path, "r+") as file:  # what is too much is cut off at the end
            for name, array in (data.coordinates | data.variables).items():
                values = array.values
                for piece in pieces(values.shape):
                    part = values[piece]
                    file[name][piece] = part.astype(object) if part.dtype.kind == "U" else part


def _define(file: "netCDF4.Dataset", data: Labelled) -> None:
    """All of a file but the values."""
    beside = {name: set(array.dims) for name, array in data.coordinates.items() if array.dims != (name,)}
    file.setncatts(data.attrs)
    for dimension, size in data.sizes.items():
        file.createDimension(dimension, size)
    for name, array in (data.coordinates | data.variables).items():
        kind = array.values.dtype.kind
        variable = file.createVariable(
            name,
            str if kind in "OU" else array.values.dtype,
            array.dims,
            fill_value=np.nan if kind == "f" and name in data.variables else None,
        )
        variable.setncatts(array.attrs)
        if name in data.variables and (apt := [other for other, dims in beside.items() if dims <= set(array.dims)]):
            variable.coordinates = " ".join(apt)


def _reserve(path: Path, size: int) -> None:
    """Give a file room on the disk; OSError where there is not enough, or where it must not become so large."""
    if not hasattr(os, "posix_fallocate"):
        return
    with path.open("r+b") as file:
        try:
            os.posix_fallocate(file.fileno(), 0, size)
        except OSError as error:
            if error.errno not in _UNABLE:
                what = f"{os.strerror(error.errno or 0)}, and it takes up to {bytes_in_words(size)}"
                raise OSError(error.errno, what) from None


def most_bytes(data: Labelled) -> int:
    """The most bytes that a file of these arrays takes."""
    arrays = [*data.variables.values(), *data.coordinates.values()]
    attrs = [data.attrs, *(array.attrs for array in arrays)]
    said = sum(_ATTRIBUTE + len(str(value).encode()) for some in attrs for value in some.values())
    return _FILE + said + sum(_ARRAY + _bytes_of(array.values) for array in arrays)


def _bytes_of(values: np.ndarray[Any, Any]) -> int:
    if values.dtype.kind not in "OU":
        return values.nbytes
    letters = sum(len("".join(map(str, values[piece].ravel().tolist())).encode()) for piece in pieces(values.shape))
    return letters + values.size * _TEXT

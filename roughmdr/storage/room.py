"""Room for curves that would fill the memory: files without a name, whose pages the system takes back."""

import os
import tempfile
from contextlib import suppress
from pathlib import Path

import numpy as np

from roughmdr.numerics.arguments import Floats
from roughmdr.storage.memory import check_memory

IN_MEMORY = 2**30  # most bytes of curves that stay in memory, an eighth of that of a small computer


class Room:
    """Room in memory and, beyond ``IN_MEMORY``, in a ``folder`` while its disk has space; without one all in memory."""

    def __init__(self, folder: Path | None) -> None:
        self._folder, self._kept, self._block = folder, 0, np.zeros(0)

    def empty(self, shape: tuple[int, ...]) -> Floats:
        """Return an array whose values are not set; StoreError where neither disk nor memory have the space."""
        size = 8 * int(np.prod(shape, dtype=np.int64))
        if self._folder is not None and self._kept + size > IN_MEMORY:
            with suppress(OSError), tempfile.TemporaryFile(dir=self._folder) as file:
                if hasattr(os, "posix_fallocate"):  # to write to a file that the disk has no space for ends the process
                    os.posix_fallocate(file.fileno(), 0, size)
                else:
                    file.truncate(size)
                return np.asarray(np.memmap(file, np.float64, "r+", shape=shape))
            check_memory(size, "an array of the curves")
        self._kept += size
        return np.empty(shape)

    def keep(self, array: Floats) -> Floats:
        """Return an array that is kept for long: itself, or a copy in a file where much is kept already."""
        if self._folder is None or self._kept + array.nbytes <= IN_MEMORY:
            self._kept += array.nbytes
            return array
        if self._block.size < array.size:
            self._block = self.empty((max(IN_MEMORY // 256, array.size),))
        copy, self._block = self._block[: array.size].reshape(array.shape), self._block[array.size :]
        copy[...] = array
        return copy


def beside(path: Path) -> Room:
    """Return room for what a file holds, beside it if one may write there."""
    return Room(path.parent if os.access(path.parent, os.W_OK) else None)

"""Room for curves that would fill the memory: files without a name, whose pages the system takes back."""

import os
import tempfile
from pathlib import Path

import numpy as np

from roughmdr.numerics.arguments import Floats
from roughmdr.storage.files import convert_os_errors

IN_MEMORY = 2**28  # most bytes of arrays that stay in memory: what a process takes that has imported all


class Room:
    """Room in memory and, beyond ``IN_MEMORY``, in a ``folder``; without a folder all is in memory."""

    def __init__(self, folder: Path | None) -> None:
        self._folder, self._kept, self._block = folder, 0, np.zeros(0)

    def empty(self, shape: tuple[int, ...]) -> Floats:
        """Return an array whose values are not set; StoreError where the disk has too little space."""
        size = 8 * int(np.prod(shape, dtype=np.int64))
        if self._folder is None or size <= IN_MEMORY:
            return np.empty(shape)
        with convert_os_errors(self._folder), tempfile.TemporaryFile(dir=self._folder) as file:
            if hasattr(os, "posix_fallocate"):  # to write to a file that the disk has no space for ends the process
                os.posix_fallocate(file.fileno(), 0, size)
            else:
                file.truncate(size)
            return np.asarray(np.memmap(file, np.float64, "r+", shape=shape))

    def keep(self, array: Floats) -> Floats:
        """Return an array that is kept for long: itself, or a copy in a file where much is kept already."""
        self._kept += array.nbytes
        if self._folder is None or self._kept <= IN_MEMORY:
            return array
        if self._block.size < array.size:
            self._block = self.empty((max(IN_MEMORY // 8 + 1, array.size),))
        copy, self._block = self._block[: array.size].reshape(array.shape), self._block[array.size :]
        copy[...] = array
        return copy


def beside(path: Path) -> Room:
    """Return room for what a file holds, beside it if one may write there."""
    return Room(path.parent if os.access(path.parent, os.W_OK) else None)

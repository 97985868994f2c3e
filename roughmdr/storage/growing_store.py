"""Zarr stores that grow: a chunk, which holds a block of runs, is written as soon as all of them are computed."""

import shutil
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from roughmdr.numerics.arguments import Ints
from roughmdr.storage.files import convert_os_errors, is_zarr
from roughmdr.storage.labelled import Labelled, block_of
from roughmdr.storage.zarr_store import write_arrays
from roughmdr.variables import NOT_RUN


class GrowingStore:
    """A store that is written while its curves are computed; those that are not there yet read as NaN."""

    def __init__(self, data: Labelled, status: NDArray[Any], folder: Path) -> None:
        """Begin with all but the values of the variables [..., realization, step]; ``status`` is that of their runs.

        StoreError if that fails.
        """
        self.folder = folder
        with convert_os_errors(folder.parent):
            created = write_arrays(data, folder, later=data.variables)
        self._curves = {name: (created[name], array.values) for name, array in data.variables.items()}
        self._runs, self._chunk = next((each.shape[:-1], each.chunks[:-1]) for each, _ in self._curves.values())
        self._status = status.reshape(self._runs)

    def whole(self, runs: Ints) -> Iterator[tuple[slice, ...]]:
        """Yield the chunks with any of these runs, counted over all dimensions, of which every run is there."""
        counts = [-(-size // chunk) for size, chunk in zip(self._runs, self._chunk, strict=True)]
        along = [each // chunk for each, chunk in zip(np.unravel_index(runs, self._runs), self._chunk, strict=True)]
        for number in np.unique(np.ravel_multi_index(along, counts)):
            block = block_of(np.unravel_index(number, counts), self._chunk)
            if (self._status[block] != NOT_RUN).all():
                yield block

    def write(self, block: tuple[slice, ...]) -> None:
        """Write the curves of a chunk; StoreError if that fails."""
        with convert_os_errors(self.folder.parent):
            try:
                for stored, values in self._curves.values():
                    stored[block] = values[block]
            finally:
                if not is_zarr(self.folder):  # somebody removed it; Zarr made its folders again for the chunk
                    shutil.rmtree(self.folder, ignore_errors=True)
                    with suppress(OSError):
                        self.folder.parent.rmdir()
                    self.folder.stat()

"""Zarr stores: a result as a folder of compressed chunks, of which xarray reads those that are needed.

They can grow: a chunk, which holds a block of runs, is written as soon as all of them are computed.
"""

import math
import shutil
import warnings
from collections.abc import Collection, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from roughmdr.errors import RoughmdrError, StoreError
from roughmdr.numerics.arguments import Ints
from roughmdr.storage.files import convert_os_errors, is_zarr, replace_atomically
from roughmdr.storage.labelled import Array, Labelled, block_of, blocks, chunks_of, texts_as_objects
from roughmdr.storage.room import Room, beside
from roughmdr.variables import LAW_VARIABLES, NOT_RUN

if TYPE_CHECKING:
    import zarr

_DIMENSIONS = "_ARRAY_DIMENSIONS"
"""Attribute of format 2 with the names of the dimensions, as xarray writes it."""
_ORDER = {name: place for place, name in enumerate(LAW_VARIABLES)}
_CHUNK_SIZE = 2**18  # most elements of a chunk, 2 MB of numbers: Zarr advises at least 1 MB, uncompressed


def write_zarr(data: Labelled, path: Path, folder: Path | None = None, grown: Path | None = None) -> None:
    """Write ``data`` to ``path`` by way of a temporary folder in ``folder``, beside ``path`` by default.

    A store that has ``grown`` until it holds all curves of ``data`` becomes it. StoreError if that fails.
    """
    with replace_atomically(path, folder, as_zarr=True, begun=grown) as temporary:
        write_arrays(data, temporary)


def write_arrays(data: Labelled, folder: Path, later: Collection[str] = ()) -> dict[str, "zarr.Array[Any]"]:
    """Write all that is not there yet, but the values of arrays that come ``later``; return arrays that were not."""
    zarr, created = _package(), dict[str, Any]()
    # Warnings are of texts and of common metadata, which later versions of the format may store in other ways.
    with warnings.catch_warnings(action="ignore"):
        group = zarr.open_group(folder, mode="a", zarr_format=3)
        group.attrs.put({name: _plain(value) for name, value in data.attrs.items()})
        arrays = data.coordinates | data.variables
        largest = max(arrays.values(), key=lambda array: array.values.size)
        # All steps of as many realisations, and cells, as a chunk holds.
        chunks = dict(zip(largest.dims, chunks_of(largest.values.shape, _CHUNK_SIZE), strict=True))
        for name, array in arrays.items():
            attrs = {key: _plain(value) for key, value in data.attributes_in_file(name).items()}
            along = tuple(chunks.get(dim, data.sizes[dim]) for dim in array.dims)
            if name in group and group[name].chunks == along:
                group[name].attrs.put(attrs)
                continue
            created[name] = _create(group, name, array, attrs, along)
            for block in () if name in later else blocks(array.values.shape, along):
                part = np.asarray(array.values[block])
                created[name][block] = part.astype(object) if part.dtype.kind in "OU" else part
        zarr.consolidate_metadata(folder)
    return created


def _create(
    group: "zarr.Group", name: str, array: Array, attrs: dict[str, Any], chunks: tuple[int, ...]
) -> "zarr.Array[Any]":
    kind = array.values.dtype.kind
    return group.create_array(
        name,
        shape=array.values.shape,
        chunks=chunks,
        dtype=str if kind in "OU" else array.values.dtype,
        fill_value=math.nan if kind == "f" else None,
        attributes=attrs,
        dimension_names=array.dims,
        config={"write_empty_chunks": True},  # else NaN would lose their signs
        overwrite=True,
    )


def _plain(value: Any) -> Any:
    """Return an attribute as JSON has it."""
    return value.tolist() if isinstance(value, np.ndarray | np.generic) else value


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


def read_zarr(path: Path) -> Labelled:
    """Return a whole store; RoughmdrError if it cannot be read."""
    with _opened(path) as group:
        room, found = beside(path), sorted(group.arrays(), key=lambda each: _place(each[0]))
        arrays, sizes = {name: _read(stored, room) for name, stored in found}, dict[str, int]()
        for name, (dims, values, _) in arrays.items():
            if any(sizes.setdefault(dim, size) != size for dim, size in zip(dims, values.shape, strict=True)):
                raise ValueError(f"{name} has another number of {', '.join(dims)} than other arrays")
        return Labelled.from_file(arrays, dict(group.attrs))


def read_zarr_outline(path: Path) -> tuple[dict[str, Any], dict[str, tuple[str, ...]]]:
    """Return the attributes of a store, and the dimensions of each array; RoughmdrError if it cannot be read."""
    with _opened(path) as group:
        return dict(group.attrs), {name: _dimensions(stored) for name, stored in group.arrays()}


@contextmanager
def _opened(path: Path) -> Iterator["zarr.Group"]:
    zarr = _package()
    try:
        with warnings.catch_warnings(action="ignore"):
            yield zarr.open_group(path, mode="r")
    except RoughmdrError:
        raise
    except Exception as error:  # a damaged or foreign store can make the library raise anything
        raise RoughmdrError(f"not a Zarr store that can be read ({error})") from None


def check_package(path: Path) -> None:
    """Raise StoreError if a store at ``path`` cannot be written, for lack of the package."""
    try:
        _package()
    except RoughmdrError as error:
        raise StoreError(f"{path}: {error}") from None


def _package() -> Any:
    try:
        import zarr

        zarr.Group.create_array  # noqa: B018 - which versions before 3 lack
    except (ImportError, AttributeError):
        raise RoughmdrError(
            "Zarr stores need the package zarr, 3.0 or newer: pip install -e '.[zarr]' in the clone of roughmdr"
        ) from None
    return zarr


def _read(stored: "zarr.Array[Any]", room: Room) -> Array:
    dims = _dimensions(stored)
    if stored.dtype == np.float64:
        values = room.empty(stored.shape)
        for block in blocks(stored.shape, stored.chunks):
            values[block] = stored[block]
    else:
        values = texts_as_objects(np.asarray(stored[...]))
    attrs = {key: np.array(value) if isinstance(value, list) else value for key, value in stored.attrs.items()}
    attrs.pop(_DIMENSIONS, None)
    if len(dims) != values.ndim:
        raise ValueError(f"{stored.basename} has no names of its dimensions")
    return Array(dims, values, attrs)


def _place(name: str) -> tuple[int, str]:
    """Return the place of an array among others, which a store holds in no order: of variables as they are declared."""
    return _ORDER.get(name, _ORDER.get(name.rpartition("_")[0], len(_ORDER))), name


def _dimensions(stored: "zarr.Array[Any]") -> tuple[str, ...]:
    names: Any = getattr(stored.metadata, "dimension_names", None) or stored.attrs.get(_DIMENSIONS, ())
    return tuple(map(str, names))

"""Labelled arrays: variables, coordinates and attributes as xarray has them, without the time to import xarray."""

import hashlib
from collections.abc import Hashable, Iterable, Iterator, Mapping
from types import EllipsisType
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from roughmdr.variables import AUXILIARY_COORDINATES, STATED, STEP_COORDINATES

if TYPE_CHECKING:
    import xarray as xr

_TEXTS_AT_ONCE, _BYTES_AT_ONCE = 2**16, 2**23  # most texts, and bytes of numbers, that are copied to be hashed
RUN_TIME = "run_time"
"""The only variable that depends on the clock."""


class Array(NamedTuple):
    """Values over named dimensions."""

    dims: tuple[str, ...]
    values: NDArray[Any]
    attrs: dict[str, Any]


class Labelled(NamedTuple):
    """Variables and coordinates without groups, as in a netCDF file or a Dataset."""

    variables: dict[str, Array]
    coordinates: dict[str, Array]
    attrs: dict[str, Any]

    @property
    def sizes(self) -> dict[str, int]:
        """Length of each dimension, in the order in which the variables name them."""
        sizes: dict[str, int] = {}
        for array in (*self.variables.values(), *self.coordinates.values()):
            sizes |= dict(zip(array.dims, array.values.shape, strict=True))
        return sizes

    @classmethod
    def of(cls, dataset: "xr.Dataset") -> "Labelled":
        """Convert a Dataset."""

        def arrays(variables: "Mapping[Hashable, xr.DataArray]") -> dict[str, Array]:
            return {
                str(name): Array(tuple(map(str, array.dims)), texts_as_objects(array.to_numpy()), dict(array.attrs))
                for name, array in variables.items()
            }

        return cls(arrays(dataset.data_vars), arrays(dataset.coords), dict(dataset.attrs))

    @classmethod
    def from_file(cls, arrays: Mapping[str, Array], attrs: dict[str, Any]) -> "Labelled":
        """Tell the coordinates of a file from its variables: dimensions, those declared, and those that others name.

        ``arrays`` have all their attributes, of which ``coordinates`` names others (CF-1.11, chapter 5).
        """
        coordinates, own = {dim for array in arrays.values() for dim in array.dims} | {*AUXILIARY_COORDINATES}, {}
        for name, array in arrays.items():
            text = array.attrs.get("coordinates", "")
            named = set(text.split()) if isinstance(text, str) else set()
            coordinates |= named
            if "separation" not in named and not named.isdisjoint(STEP_COORDINATES):  # a machine moves the flat
                coordinates.discard("separation")
            kept = {key: value for key, value in array.attrs.items() if key not in ("coordinates", "_FillValue")}
            own[name] = array._replace(attrs=kept)
        return cls(
            {name: array for name, array in own.items() if name not in coordinates},
            {name: array for name, array in own.items() if name in coordinates},
            attrs,
        )

    def attributes_in_file(self, name: str) -> dict[str, Any]:
        """Return the attributes of an array, of a variable with those coordinates that are no dimension."""
        if name in self.coordinates:
            return self.coordinates[name].attrs
        dims, _, attrs = self.variables[name]
        named = [other for other, each in self.coordinates.items() if each.dims != (other,) and {*each.dims} <= {*dims}]
        return {**attrs, "coordinates": " ".join(named)} if named else attrs

    def checksum(self) -> str:
        """Return a hash of the ``STATED`` attributes and of all arrays but ``run_time``, which depends on the clock."""
        stated = [(name, str(self.attrs.get(name, ""))) for name in STATED]
        digest = hashlib.sha256(repr(stated).encode(errors="replace"))
        for name, array in sorted((self.variables | self.coordinates).items()):
            if name != RUN_TIME:
                told = [str(array.attrs.get(key, "")) for key in ("units", "flag_meanings")]
                digest.update(repr((name, array.dims, told)).encode(errors="replace"))
                for part in _bytes_of(array.values):
                    digest.update(part)
        return digest.hexdigest()

    def integrity_fault(self) -> str:
        """Return why the numbers cannot be trusted; empty if the attribute ``checksum`` matches the arrays."""
        if "checksum" not in self.attrs:
            return "has no checksum: its numbers may not be those that were written"
        if str(self.attrs["checksum"]) != self.checksum():
            return "its numbers are not those that were written"
        return ""

    def to_xarray(self) -> "xr.Dataset":
        """Convert to a Dataset."""
        import xarray as xr

        from roughmdr.storage.clocked import Clocked

        variables: dict[str, Any] = dict(self.variables)
        if RUN_TIME in variables:
            variables[RUN_TIME] = Clocked(*variables[RUN_TIME])
        return xr.Dataset(variables, coords=self.coordinates, attrs=self.attrs)


def texts_as_objects(values: NDArray[Any]) -> NDArray[Any]:
    """Return an array, texts of NumPy's type of variable width, as Zarr stores are read, as objects."""
    return values.astype(object) if values.dtype.kind == "T" else values


def _bytes_of(values: NDArray[Any]) -> Iterator[bytes | memoryview]:
    """Yield the bytes to hash, part by part: numbers as they are, texts separated by a zero byte."""
    if values.dtype.kind not in "OU":
        for block in blocks(values.shape, chunks_of(values.shape, _BYTES_AT_ONCE // max(values.itemsize, 1))):
            yield np.ascontiguousarray(values[block]).reshape(-1).view(np.uint8).data
        return
    texts = values.ravel()
    for first in range(0, texts.size, _TEXTS_AT_ONCE):
        yield ("\0" * (first > 0) + "\0".join(map(str, texts[first : first + _TEXTS_AT_ONCE].tolist()))).encode()


def chunks_of(shape: tuple[int, ...], most: int) -> tuple[int, ...]:
    """Return the lengths of blocks of ``most`` elements at most, whole along as many last dimensions as fit."""
    lengths, room = list[int](), most
    for size in reversed(shape):
        lengths.insert(0, max(1, min(size, room)))
        room //= lengths[0]
    return tuple(lengths)


def blocks(shape: tuple[int, ...], lengths: tuple[int, ...]) -> Iterator[tuple[slice | EllipsisType, ...]]:
    """Yield the indices of all blocks of these lengths, each an array."""
    for number in np.ndindex(*(-(-size // length) for size, length in zip(shape, lengths, strict=True))):
        yield block_of(number, lengths) or (...,)


def block_of(number: Iterable[int], lengths: tuple[int, ...]) -> tuple[slice, ...]:
    """Return the indices of what is in a block, which is given by its number along each dimension."""
    return tuple(slice(i * length, (i + 1) * length) for i, length in zip(number, lengths, strict=True))


def is_text(value: object) -> bool:
    """Return whether a value is a text that can be written as UTF-8."""
    return isinstance(value, str) and value.encode(errors="replace").decode() == value

"""A height map as a file states it, and how maps are worked on in blocks of rows."""

from collections.abc import Iterator
from typing import Any, NamedTuple

from numpy.typing import NDArray

from roughmdr.errors import RoughmdrError

BLOCK_SIZE = 2**20
"""Points of a block."""


class RawMap(NamedTuple):
    """A map as a file states it; None is what the file does not say."""

    height: NDArray[Any]
    """Over x and y, not yet checked; the reader may overwrite it."""
    unit: str | None = None
    """Of the heights."""
    spacing: tuple[float, float] | None = None
    """Along x and y [m]."""
    periodic: bool | None = None


def check_points(shape: tuple[int, ...]) -> None:
    """Raise RoughmdrError where a map of this shape has no inner point."""
    if len(shape) != 2 or min(shape) < 3:
        points = " x ".join(map(str, shape)) or "no"
        raise RoughmdrError(f"the map has {points} points; it needs at least 3 x 3, over two dimensions")


def blocks(rows: int, columns: int, chunk: int = 1) -> Iterator[slice]:
    """Yield slices over the rows of a map, which bound the memory that work on it takes.

    ``chunk`` rows that belong together are never split.
    """
    size = chunk * -(-BLOCK_SIZE // (columns * chunk))
    return (slice(first, min(first + size, rows)) for first in range(0, rows, size))

"""What a file says of its height map."""

from collections.abc import Iterator
from typing import Any, NamedTuple

from numpy.typing import NDArray

from roughmdr.errors import RoughmdrError

_TOGETHER = 2**20  # points of a block


class RawMap(NamedTuple):
    """A map as it stands in a file; None is what the file does not say."""

    height: NDArray[Any]
    """Over x and y; not yet checked, and for whoever takes it to write to."""
    unit: str | None = None
    """Of the heights."""
    spacing: tuple[float, float] | None = None
    """Along x and y [m]."""
    periodic: bool | None = None


def check_points(shape: tuple[int, ...]) -> None:
    """RoughmdrError where a map of this shape has no inner point."""
    if len(shape) != 2 or min(shape) < 3:
        points = " x ".join(map(str, shape)) or "no"
        raise RoughmdrError(f"the map has {points} points; it needs at least 3 x 3, over two dimensions")


def blocks(rows: int, columns: int, together: int = 1) -> Iterator[slice]:
    """Some rows at a time of so many with so many columns: a map is worked on in parts that need little beside it.

    Rows that belong ``together``, so many of them, are not parted.
    """
    size = together * -(-_TOGETHER // (columns * together))
    return (slice(first, min(first + size, rows)) for first in range(0, rows, size))

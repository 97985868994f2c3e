"""What a file says of its height map."""

from typing import Any, NamedTuple

from numpy.typing import NDArray

from roughmdr.errors import RoughmdrError


class Content(NamedTuple):
    """A map as it stands in a file; None is what the file does not say."""

    height: NDArray[Any]
    """Over x and y; not yet checked."""
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

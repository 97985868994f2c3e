"""A map as a file states it, and its size, which the file or the user gives."""

from typing import Any, NamedTuple

from numpy.typing import NDArray

from roughmdr.errors import RoughmdrError
from roughmdr.schema.json_schema import JsonSchema, of_any_type
from roughmdr.schema.quantities import Quantity

Size = float | tuple[float, float]
"""The side of a square map, or the lengths along x and y [m]."""


class RawMap(NamedTuple):
    """A map as a file states it; None is what the file does not say."""

    height: NDArray[Any]  # over x and y, not yet checked; it may be overwritten
    unit: str | None = None  # of the heights
    spacing: tuple[float, float] | None = None  # along x and y [m]
    periodic: bool | None = None


class SizeReader:
    """Reads the size of a map."""

    dimension = "m"
    _side = Quantity("m", above=0.0)

    def __call__(self, value: object) -> Size:
        """Return one side, or both, in SI."""
        if not isinstance(value, list | tuple):
            return self._side(value)
        if len(value) != 2:
            raise RoughmdrError('must be one side, as "100 um", or two, along x and y, as ["100 um", "50 um"]')
        return self._side(value[0]), self._side(value[1])

    def json_schema(self) -> JsonSchema:
        """Return the schema of one side, or of two."""
        side = self._side.json_schema()
        return of_any_type(side, {"type": "array", "items": side, "minItems": 2, "maxItems": 2})

    def __str__(self) -> str:
        return f"{self._side}; or a list of two"


def check_points(shape: tuple[int, ...]) -> None:
    """Raise RoughmdrError where a map of this shape has no inner point."""
    if len(shape) != 2 or min(shape) < 3:
        points = " x ".join(map(str, shape)) or "no"
        raise RoughmdrError(f"the map has {points} points; it needs at least 3 x 3, over two dimensions")


def spacings(raw: RawMap, size: Size | None) -> tuple[float, float]:
    """Return the spacings along x and y [m], which the file or the user gives."""
    nx, ny = raw.height.shape
    if raw.spacing is not None:
        if size is not None:
            sides = f"{raw.spacing[0] * nx:.4g} m x {raw.spacing[1] * ny:.4g} m"
            raise RoughmdrError(f"the file says itself that the map is {sides}; leave out size")
        return raw.spacing
    if size is None:
        raise RoughmdrError('the file does not say how large the map is; give size, as size = "100 um"')
    return spacings_of_sides(size, nx, ny)


def spacings_of_sides(size: Size, nx: int, ny: int) -> tuple[float, float]:
    """Return the spacings along x and y [m] of a map of this size; RoughmdrError where one side is not both."""
    if not isinstance(size, tuple) and nx != ny:
        raise RoughmdrError(
            f"the map has {nx} x {ny} points, and one size is that of a square; "
            'give the sides along x and y, as size = ["100 um", "50 um"]'
        )
    along_x, along_y = size if isinstance(size, tuple) else (size, size)
    return along_x / nx, along_y / ny

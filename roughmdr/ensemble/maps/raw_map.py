"""A map as a file states it, and its size, which the file or the user gives."""

import math
from typing import Any, NamedTuple

from numpy.typing import NDArray

from roughmdr.errors import RoughmdrError
from roughmdr.schema.json_schema import JsonSchema, of_any_type
from roughmdr.schema.quantities import Quantity, Reader
from roughmdr.schema.units import format_quantity, unit_factor


class Sides(NamedTuple):
    """The lengths of a map as its file shows it [m]."""

    across: float  # along a row of numbers
    down: float  # from the first row to the last


Size = Sides | float | tuple[float, float]
"""The side of a square map, the lengths along x and y, or those across a row of the file and down its rows [m]."""

_SAME = 1e-3
"""Relative difference of two statements of one length: both may be rounded to four digits."""
_SQUARE = math.log(1.05)  # logarithm of the ratio of the spacings of a grid that counts as square


class RawMap(NamedTuple):
    """A map as a file states it; None where the file does not."""

    height: NDArray[Any]  # over x and y, not yet checked; it may be overwritten
    unit: str | None = None  # of the heights
    spacing: tuple[float, float] | None = None  # along x and y [m]
    periodic: bool | None = None
    steps: tuple[float, float] | None = None  # spacings by coordinates in a unit that the file does not name
    rows_along: str = "y"  # the direction of a row of numbers in the file


class SizeReader(Reader):
    """Reads the size of a map."""

    dimension = "m"
    _side = Quantity("m", above=0.0)

    def __call__(self, value: object) -> Size:
        """Return one side, or both, in SI."""
        if isinstance(value, Sides):
            return value
        if isinstance(value, dict):
            if value.keys() != set(Sides._fields):
                raise RoughmdrError('must name both sides, as { across = "100 um", down = "50 um" }')
            return Sides(**{name: self._side(side) for name, side in value.items()})
        if not isinstance(value, list | tuple):
            return self._side(value)
        if len(value) != 2:
            raise RoughmdrError('must be one side, as "100 um", or two, along x and y, as ["100 um", "50 um"]')
        return self._side(value[0]), self._side(value[1])

    def json_schema(self) -> JsonSchema:
        """Return the schema of one side, or of two."""
        side = self._side.json_schema()
        named = {
            "type": "object",
            "properties": {
                "across": {**side, "description": "Length of a row of numbers of the file"},
                "down": {**side, "description": "Length from the first row to the last"},
            },
            "required": list(Sides._fields),
            "additionalProperties": False,
        }
        return of_any_type(side, {"type": "array", "items": side, "minItems": 2, "maxItems": 2}, named)

    def __str__(self) -> str:
        return f"{self._side}; or a list of two, along x and y; or across a row of the file, and down its rows"


def metres(unit: str, of: str = "x and y") -> float:
    """Return a unit [m]; RoughmdrError, which names what it is of, where it is no length."""
    try:
        return float(unit_factor(unit, "m"))
    except RoughmdrError as error:
        raise RoughmdrError(f"units of {of}: {error}") from None


def check_points(shape: tuple[int, ...]) -> None:
    """Raise RoughmdrError where a map of this shape has no inner point."""
    if len(shape) != 2 or min(shape) < 3:
        points = " x ".join(map(str, shape)) or "no"
        raise RoughmdrError(f"the map has {points} points; it needs at least 3 x 3, over two dimensions")


def spacings(raw: RawMap, size: Size | None, unit: str | None) -> tuple[float, float]:
    """Return the spacings along x and y [m], which the file or the user gives; RoughmdrError where they disagree."""
    nx, ny = raw.height.shape
    if raw.spacing is not None:
        said = raw.spacing[0] * nx, raw.spacing[1] * ny
        if size is not None and not _same(said, _along_axes(size, raw.rows_along)):
            raise RoughmdrError(f"the file says itself that the map is {_sides(said)}, and size differs; leave it out")
        return raw.spacing
    if raw.steps is not None:
        return _scaled(raw.steps, (nx, ny), size, unit)
    if size is None:
        raise RoughmdrError('the file does not say how large the map is; give size, as size = "100 um"')
    return spacings_of_sides(size, nx, ny, raw.rows_along)


def spacings_of_sides(size: Size, nx: int, ny: int, rows_along: str = "y") -> tuple[float, float]:
    """Return the spacings along x and y [m] of a map of this size.

    RoughmdrError where one side is not both, and where two, unnamed, would make the grid square in the other order.
    """
    if not isinstance(size, tuple) and nx != ny:
        raise RoughmdrError(
            f"the map has {nx} x {ny} points, and one size is that of a square; "
            'give the sides along x and y, as size = ["100 um", "50 um"]'
        )
    along_x, along_y = _along_axes(size, rows_along)
    dx, dy = along_x / nx, along_y / ny
    swapped = along_y / nx, along_x / ny
    oblong = abs(math.log(dx / dy))
    if not isinstance(size, Sides) and oblong > _SQUARE and abs(math.log(swapped[0] / swapped[1])) <= oblong:
        named = Sides(along_x, along_y) if rows_along == "y" else Sides(along_y, along_x)
        across, down = (format_quantity(side, "m") for side in named)
        raise RoughmdrError(
            f"size: {nx} x {ny} points, rows of numbers along {rows_along}, would lie {_sides((dx, dy))} apart; with "
            f"the sides the other way round {_sides(swapped)}, as near to a square grid or nearer; say which is which, "
            f'as size = {{ across = "{across}", down = "{down}" }}: across a row of the file, and down its rows'
        )
    return dx, dy


def _along_axes(size: Size, rows_along: str) -> tuple[float, float]:
    """Return the sides along x and y."""
    if isinstance(size, Sides):
        return (size.across, size.down) if rows_along == "x" else (size.down, size.across)
    return size if isinstance(size, tuple) else (size, size)


def _scaled(
    steps: tuple[float, float], points: tuple[int, int], size: Size | None, unit: str | None
) -> tuple[float, float]:
    """Return spacings [m] by coordinates without a unit, in the unit that agrees with the size, or else in ``unit``."""
    if unit is None:
        raise RoughmdrError(
            f"its coordinates, {points[0]} along x and {points[1]} along y, {steps[0]:.4g} and {steps[1]:.4g} "
            "apart, have no unit; give unit, of coordinates and heights, or unit, of heights, and size"
        )
    if size is None:
        factor = float(unit_factor(unit, "m"))
        return steps[0] * factor, steps[1] * factor
    wanted = _along_axes(size, "x")
    for last in (0, 1):  # the size may be counted from the first point to the last
        extents = tuple(step * (n - last) for step, n in zip(steps, points, strict=True))
        power = round(math.log10(wanted[0] / extents[0]))
        if _same((extents[0] * 10.0**power, extents[1] * 10.0**power), wanted):
            return steps[0] * 10.0**power, steps[1] * 10.0**power
    raise RoughmdrError(
        f"its coordinates span {steps[0] * points[0]:.4g} along x and {steps[1] * points[1]:.4g} along y, and size is "
        f"{_sides(wanted)}: no unit makes them the same"
    )


def _same(one: tuple[float, ...], other: tuple[float, ...]) -> bool:
    return all(math.isclose(a, b, rel_tol=_SAME) for a, b in zip(one, other, strict=True))


def _sides(lengths: tuple[float, float]) -> str:
    return " x ".join(format_quantity(length, "m") for length in lengths)

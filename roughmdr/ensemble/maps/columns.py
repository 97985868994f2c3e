"""Heights given as columns x, y, z of points on a grid."""

import re

import numpy as np

from roughmdr.ensemble.maps.raw_map import RawMap, check_points, metres
from roughmdr.ensemble.maps.text_table import TextTable
from roughmdr.errors import RoughmdrError
from roughmdr.numerics.arguments import Floats

_FEWEST = 9  # points of the smallest map
_MOST_COLUMNS = 8  # most numbers in a row that is a point, x, y, z and others; a map is wider
_LEAST_SHARE = 0.5
"""Share of the points of a grid that a file must hold: instruments leave out those that they could not measure."""
_OFF_GRID = 0.2
"""Distance of a coordinate from the grid at most, in spacings: it may be rounded to one digit of a spacing."""
_TITLE = re.compile(
    r"\s*\"?(?:pos\w*\s*)?([xyz]|height)"
    r"(?:_(nm|[uµμ]m|mm|m)\b|(?:\b|_)[^\[(/]*(?:[\[(]\s*([^\])]*?)\s*[\])]|/\s*([^\s\"]+))?).*",
    re.IGNORECASE,
)
"""Title of a column with its unit: "x [um]", "x (um)", "x/um" or "x_um"."""


def is_of_points(table: TextTable) -> bool:
    """Return whether rows are points with three coordinates, in contrast to a map that is three points wide.

    RoughmdrError where they are points with further numbers.
    """
    count, columns = table.numbers.shape
    if count < _FEWEST or not 3 <= columns <= _MOST_COLUMNS:
        return False
    if columns > 3:
        of_x, of_y = _grid(table.numbers[:, 0]), _grid(table.numbers[:, 1])
        if of_x is not None and of_y is not None and (of_x[0].max() + 1) * (of_y[0].max() + 1) == count:
            raise RoughmdrError(f"its rows begin with x and y on a grid, and have {columns - 2} numbers more; keep z")
    return bool(columns == 3)


def map_of_points(table: TextTable) -> RawMap:
    """Return the map of rows x, y, z in any order on an evenly spaced grid; points that are not there are undefined.

    Titles of the columns, or their values, tell which is z. RoughmdrError where the points do not lie on a grid.
    """
    (lateral, unit), order = _titles(table)
    points = table.numbers
    grids = [_grid(points[:, first]) for first in range(3)]
    lines = ""
    for x, y, z in [order] if order else [(0, 1, 2), (0, 2, 1), (1, 2, 0)]:
        of_x, of_y = grids[x], grids[y]
        if of_x is None or of_y is None:
            continue
        shape = int(of_x[0].max()) + 1, int(of_y[0].max()) + 1
        if len(points) < _LEAST_SHARE * shape[0] * shape[1]:
            continue
        check_points(shape)
        flat = of_x[0] * shape[1] + of_y[0]
        times = np.bincount(flat)
        if times.max() > 1:
            lines = lines or " and ".join(str(table.lines[k]) for k in np.flatnonzero(flat == times.argmax())[:2])
            continue
        height = np.full(shape, np.nan)
        height[of_x[0], of_y[0]] = points[:, z]
        if not lateral:
            return RawMap(height, unit, steps=(of_x[1], of_y[1]))
        return RawMap(height, unit, (metres(lateral) * of_x[1], metres(lateral) * of_y[1]))
    if lines:
        raise RoughmdrError(f"columns x, y, z: lines {lines} give a height to one point")
    kinds = " and ".join(f"{np.unique(points[:, k]).size} different {name}" for k, name in enumerate("xy"))
    raise RoughmdrError(
        f"its {len(points)} rows of three numbers are points x, y, z, with {kinds}, that do not lie on an evenly "
        "spaced grid along x and y; interpolate scattered points to one, and give the map that they make"
    )


def _grid(values: Floats) -> tuple[np.ndarray, float] | None:
    """Return the number of the grid line of each coordinate, from 0, and their spacing; None where there is no grid."""
    distinct = np.unique(values)
    if not np.isfinite(distinct).all() or distinct.size < 3:
        return None
    steps = np.diff(distinct)
    steps = steps[steps > 0.1 * steps.max()]
    extent = float(distinct[-1] - distinct[0])
    for step in (np.median(steps), np.mean(steps)):  # lines may be missing, or steps rounded
        intervals = round(extent / float(step))
        at = (values - distinct[0]) * (intervals / extent)
        lines = np.rint(at).astype(np.int64)
        if intervals < values.size and float(np.abs(at - lines).max()) <= _OFF_GRID:
            return lines, extent / intervals
    return None


def _titles(table: TextTable) -> tuple[tuple[str | None, str | None], tuple[int, int, int] | None]:
    """Return the units of coordinates and heights, and the columns of x, y and z, as far as comments say them."""
    lateral, height = (table.header[name].text if name in table.header else None for name in ("lateral", "unit"))
    for _, comment in table.comments[::-1]:
        words = re.split(r"[;,\t]|\s+(?=[xyzXYZ]\b)", comment.strip())
        found = [match for match in map(_TITLE.fullmatch, filter(None, words)) if match]
        names = ["z" if match[1].lower() == "height" else match[1].lower() for match in found]
        if sorted(names) == ["x", "y", "z"]:
            of = {name: match[2] or match[3] or match[4] for name, match in zip(names, found, strict=True)}
            if of["x"] != of["y"]:
                raise RoughmdrError(f"x is in {of['x']}, y in {of['y']}; both must be in one unit")
            return (of["x"] or lateral, of["z"] or height), (names.index("x"), names.index("y"), names.index("z"))
    return (lateral, height), None

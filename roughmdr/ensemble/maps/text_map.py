"""Read a height map from a text file: rows of heights, with or without a header, or columns x, y, z."""

import itertools
import math
import re
from pathlib import Path

import numpy as np

from roughmdr.ensemble.maps.instrument import read_instrument
from roughmdr.ensemble.maps.raw_map import RawMap, check_points, metres
from roughmdr.ensemble.maps.text_table import Said, TextTable, read_header, read_table, text_of
from roughmdr.errors import RoughmdrError
from roughmdr.numerics.arguments import Floats
from roughmdr.schema.units import unit_factor

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
_OF_ROWS = {"across", "down", "step", "columns"}  # entries of a header with which rows are no points
_OF_INSTRUMENTS = ("aISO", "bISO", "aBCR", "bBCR", "fileformat", "Wyko")
"""Beginnings of text formats whose rows are not those of the map, or whose heights are in units of their own."""


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


def read_text(path: Path, channel: str | None) -> RawMap:
    """Read rows of heights, along y, or along x where there is a header, and in .asc; or columns x, y, z.

    Binary files and text formats of instruments are left to ``read_instrument``.
    """
    text = text_of(path)
    if text is None or text.startswith(_OF_INSTRUMENTS):
        return read_instrument(path, channel)
    table = read_table(text)
    if is_of_points(table) and not table.header.keys() & _OF_ROWS:
        refuse_channel(channel)
        return map_of_points(table)
    if table.header:
        return _channel(table, channel)
    refuse_channel(channel)
    if path.suffix.lower() == ".asc":
        return RawMap(table.numbers.T, rows_along="x")
    return RawMap(table.numbers)


def refuse_channel(channel: str | None) -> None:
    """RoughmdrError where a channel is asked for of a file that holds one map only."""
    if channel is not None:
        raise RoughmdrError(f"holds one map only; leave out channel = {channel!r}")


def _channel(table: TextTable, channel: str | None) -> RawMap:
    """Return the map of that name, or else the first of heights: each has a header of its own that names it."""
    begins = [line for line, comment in table.comments if "channel" in read_header([(line, comment)])]
    lines, maps = np.array(table.lines), dict[str, tuple[Floats, dict[str, Said]]]()
    for begin, end in itertools.pairwise([0, *begins[1:], math.inf]):
        header = read_header((line, comment) for line, comment in table.comments if line < end)
        rows = table.numbers[(lines >= begin) & (lines < end)]
        if len(rows):
            maps[header["channel"].text if "channel" in header else "Default"] = rows, header
    if channel is not None and channel not in maps:
        raise RoughmdrError(f"has no channel {channel!r}, but {list(maps)}")
    first = next((name for name, (_, header) in maps.items() if _is_length(header.get("unit"))), next(iter(maps)))
    return _map_of(*maps[channel or first])


def _is_length(unit: Said | None) -> bool:
    """Return whether a unit is one of heights, or may be."""
    try:
        return unit is None or bool(unit_factor(unit.text, "m"))
    except RoughmdrError:
        return False


def _map_of(rows: Floats, header: dict[str, Said]) -> RawMap:
    """Return the map of rows along x, with size and unit from their header."""
    if "rows" in header and header["rows"].points != len(rows):
        raise RoughmdrError(f"has {len(rows)} rows, but line {header['rows'].line} says {header['rows'].text}")
    height, unit = rows.T, header["unit"].text if "unit" in header else None
    if "undefined" in header:
        height[height == header["undefined"].number] = np.nan
    if "factor" in header:
        height, unit = height * header["factor"].number, header["factor"].unit or unit
    elif "bit2nm" in header and unit is None:
        height, unit = height * header["bit2nm"].number, "nm"
    lateral = header["lateral"].text if "lateral" in header else unit
    along_x = _spacing(header, ("across", "step_x", "step"), height.shape[0])
    along_y = _spacing(header, ("down", "step_y", "step"), height.shape[1])
    raw = RawMap(height, unit, rows_along="x")
    if along_x is None or along_y is None:
        return raw
    units = along_x[1] or lateral, along_y[1] or lateral
    if units[0] is None or units[1] is None:
        return raw._replace(steps=(along_x[0], along_y[0]))
    return raw._replace(spacing=(along_x[0] * metres(units[0]), along_y[0] * metres(units[1])))


def _spacing(header: dict[str, Said], names: tuple[str, ...], points: int) -> tuple[float, str | None] | None:
    """Return the spacing along an axis, and its unit, by the first of some words: a side, or steps; None without one.

    A width without a unit that equals the number of points is that number.
    """
    for name in names:
        said = header.get(name)
        if said is None or not 0.0 < said.number < math.inf:
            continue
        if name.startswith("step"):
            return said.number, said.unit
        if said.unit is not None or said.number != points or "columns" in header:
            return said.number / points, said.unit
    return None

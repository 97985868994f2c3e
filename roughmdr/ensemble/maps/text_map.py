"""Read a height map from a text file: rows of heights, with or without a header, or columns x, y, z."""

import itertools
import math
from pathlib import Path

import numpy as np

from roughmdr.ensemble.maps.columns import is_of_points, map_of_points
from roughmdr.ensemble.maps.instrument import read_instrument
from roughmdr.ensemble.maps.raw_map import RawMap, metres
from roughmdr.ensemble.maps.text_header import Said, read_header
from roughmdr.ensemble.maps.text_table import TextTable, read_table, text_of
from roughmdr.errors import RoughmdrError
from roughmdr.numerics.arguments import Floats
from roughmdr.schema.units import unit_factor

_OF_ROWS = {"across", "down", "step", "columns"}  # entries of a header with which rows are no points
_OF_INSTRUMENTS = ("aISO", "bISO", "aBCR", "bBCR", "fileformat", "Wyko")
"""Beginnings of text formats whose rows are not those of the map, or whose heights are in units of their own."""


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

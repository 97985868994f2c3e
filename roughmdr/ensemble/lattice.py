"""Square and hexagonal lattices that fill a periodic patch without vacancies: its sides are multiples of a site.

So the patch of a hexagonal lattice is never a square: rows are sqrt(3)/2 of the pitch apart, every second one is
shifted by half of it, and their number is even.
"""

import math
from typing import Any, NamedTuple

import numpy as np

from roughmdr.errors import RoughmdrError
from roughmdr.numerics.arguments import Floats
from roughmdr.schema.quantities import EntryError, Quantity
from roughmdr.schema.units import format_quantity

_ROW_DISTANCE = {"square": 1.0, "hexagonal": math.sqrt(0.75)}  # distance of rows, in pitches
_PERIOD = {"square": 1, "hexagonal": 2}  # rows after which the lattice repeats
_MOST_OBLONG = 2.0  # largest ratio of the sides of a patch
_SUGGESTED_WITHIN = 1000  # largest change of a number of asperities to one that fits, in a message
_MOST_ON_A_SIDE = 30_000  # sites: as many as the asperities that a patch may hold
LATTICES = tuple(_ROW_DISTANCE)


class Lattice(NamedTuple):
    """A lattice on its patch."""

    rows: int
    """Number of rows, along y."""
    columns: int
    """Sites of a row, along x."""
    pitch: float
    """Distance of neighbours in a row [m]."""
    kind: str

    @property
    def sides(self) -> tuple[float, float]:
        """Sides of the patch along x and y [m]."""
        return self.columns * self.pitch, self.rows * _ROW_DISTANCE[self.kind] * self.pitch

    def positions(self) -> tuple[Floats, Floats]:
        """Return x and y [m] of the sites."""
        row, column = np.divmod(np.arange(self.rows * self.columns), self.columns)
        shift = 0.5 / _PERIOD[self.kind] + 0.5 * (row % _PERIOD[self.kind])
        return (column + shift) * self.pitch, (row + 0.5) * _ROW_DISTANCE[self.kind] * self.pitch


def lattice_of(kind: str, count: int, area: float) -> Lattice | None:
    """Return the lattice of so many sites on an area [m2] whose patch is the nearest to a square; None without one."""
    divisors = [number for number in range(1, math.isqrt(count) + 1) if count % number == 0]
    rows = [row for number in divisors for row in {number, count // number} if row % _PERIOD[kind] == 0]
    oblong, best = min(((_oblong(kind, count, row), row) for row in rows), default=(math.inf, 0))
    if oblong > _MOST_OBLONG:
        return None
    return Lattice(best, count // best, math.sqrt(area / count / _ROW_DISTANCE[kind]), kind)


def _oblong(kind: str, count: int, rows: int) -> float:
    """Return the longer side of a patch with so many rows over the shorter one."""
    ratio = count / (rows * rows * _ROW_DISTANCE[kind])
    return max(ratio, 1.0 / ratio)


def with_sites_counted(table: Any) -> Any:
    """Return a table [asperities] that has a pitch with the sites on its patch as count, and the patch that they fill.

    EntryError where the pitch does not go with count or density, or with the patch.
    """
    if not isinstance(table, dict) or table.get("pitch") is None:
        return table
    pitch, kind = table["pitch"], table.get("placement")
    if kind not in LATTICES or table.get("vacancies"):  # refused by ``check_pitch``, after misspelt keys
        return table
    if given := [key for key in ("count", "density") if table.get(key) is not None]:
        raise EntryError("pitch", pitch, f"does not go with {given[0]}: the sites on the patch are counted")
    try:
        length, patch = (Quantity("m", above=0.0)(table.get(key)) for key in ("pitch", "patch"))
    except RoughmdrError:  # refused by the validators of these fields
        return table
    if length > patch:
        raise EntryError("pitch", pitch, f"must be at most the side of the patch, {format_quantity(patch, 'm')}")
    if not patch / length < _MOST_ON_A_SIDE:
        raise EntryError("pitch", pitch, f"puts more than {_MOST_ON_A_SIDE} sites on a side of the patch")
    count, side = _filled(kind, length, patch)
    return {**table, "count": count, "patch": side}


def check_pitch(pitch: float | None, placement: str, vacancies: bool) -> None:
    """Raise EntryError where a pitch is given for no lattice that is full."""
    if pitch is not None and (placement not in LATTICES or vacancies):
        names = " or ".join(map(repr, LATTICES))
        raise EntryError("pitch", format_quantity(pitch, "m"), f"goes with placement = {names}, without vacancies")


def _filled(kind: str, pitch: float, patch: float) -> tuple[int, float]:
    """Return the number of sites that come nearest to a square patch [m], and the root of the area [m] they fill."""
    period = _PERIOD[kind]
    rows = period * max(1, round(patch / (period * _ROW_DISTANCE[kind] * pitch)))
    count = rows * max(1, round(patch / pitch))
    return count, pitch * math.sqrt(count * _ROW_DISTANCE[kind])


def at_most(kind: str, count: int) -> int:
    """Return a number of sites, ``count`` or somewhat less, that fills a patch which is nearly a square."""
    if lattice_of(kind, count, 1.0) is not None:
        return count
    period = _PERIOD[kind]
    rows = period * max(1, round(math.sqrt(count / _ROW_DISTANCE[kind]) / period))
    return rows * max(1, count // rows)


def nearest_that_fit(kind: str, count: int) -> list[int]:
    """Return the nearest numbers of sites, below and above ``count``, that fill a patch."""
    below = range(count - 1, max(0, count - _SUGGESTED_WITHIN), -1)
    above = range(count + 1, count + _SUGGESTED_WITHIN)
    fitting = (next((n for n in numbers if lattice_of(kind, n, 1.0)), 0) for numbers in (below, above))
    return [number for number in fitting if number]

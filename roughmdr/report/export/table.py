"""The stable part of a law, thinned to the knots of a table of the error asked for, and how far it may be off."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from roughmdr.errors import StoreError
from roughmdr.numerics.arguments import Floats
from roughmdr.report.export.law import Law, Quantity
from roughmdr.report.export.part import StablePart, even_points, stable_part, whole_part
from roughmdr.result.between import ANYWHERE, REACH, off_line
from roughmdr.schema.units import format_quantity

MOST_ERROR = 0.1
"""Largest error that a table may have, over the value."""
_AT_KNOTS = ("overclosure", "pressure", "value", "standard_error")
_FEWEST = 4
"""Steps that tell how far a law is off the lines between them."""
RELATIVE_FROM = 0.1
"""Part of the largest value from which a tolerance is relative to the value itself; below it is to this part."""


class Table(NamedTuple):
    """The knots of a table, steps of the path but for zero pressure itself, and how far lines between them are off."""

    law: StablePart
    """At the knots."""
    steps: int
    """Number of stable steps, from which the knots were chosen."""
    error: float
    """Largest interpolation error, by thinning and between the steps, with jumps, over the largest value."""
    relative_error: float
    """Largest error over the value itself, where that is in the upper decade."""
    statistical_error: float
    """Largest standard error over the largest value; NaN of a single realisation."""
    warnings: tuple[str, ...]
    """Parts of the law that the table leaves out, in words."""


@np.errstate(all="ignore")  # numbers that no float can hold are refused
def table_of(
    law: Law, quantity: Quantity, branch: str, *, error: float, with_tension: bool, distance: float | None = None
) -> Table:
    """Return the table of a law with the fewest knots that keep within ``error``, as ``tolerances`` says.

    With the ``distance`` [m] of two centres at zero overclosure the knots are at even steps of the squared distance.
    StoreError where the steps of the path are too far apart for that error, and errors of ``stable_part``.
    """
    negligible = error * RELATIVE_FROM * float(np.abs(law.pressure).max())
    if quantity.whole:
        part = whole_part(law, branch, negligible)
    else:
        part = stable_part(law, branch, with_tension=with_tension, negligible=negligible)
    x, y = (part.pressure, part.value) if quantity.over_pressure else (part.overclosure, part.value)
    largest = float(np.abs(y).max())
    if not largest > 0.0 or x.size < 2:
        raise StoreError(f"the {branch} has no {quantity.name} at more than one step: there is no law to export")
    steps = int(part.step[-1] - np.floor(part.step[0])) + 1
    if steps < _FEWEST:
        raise StoreError(
            f"the {branch} has {steps} steps in contact: what is between them is known of {_FEWEST} or more"
        )
    lines = between_points(law, part, quantity)
    before, after = (np.pad(lines, ((0, 0), end)) for end in ((1, 0), (0, 1)))
    bent, jumps = np.maximum(before, after)
    between, allowed = bent + jumps, tolerances(y, error)
    if not (np.isfinite(between / allowed).all() and np.isfinite(part.datum)):
        raise StoreError(f"no float holds the {quantity.name} of the {branch}: there is no law to export")
    if (between > allowed).any():
        from roughmdr.report.export.remedy import remedy

        reached = error * float((between / allowed).max())
        ask = f"ask for an error of {1.1 * reached:.2g}, or " if 1.1 * reached < MOST_ERROR else ""
        raise StoreError(
            f"error is {error:g}, and between the steps of the path the {quantity.name} is known to {reached:.2g} "
            f"only: {ask}{remedy(law, quantity, float((bent / allowed).max()), float((jumps / allowed).max()))}"
        )
    if distance is None:
        kept = knots(x, y, allowed - between)
        at, read = x[kept], np.interp(x, x[kept], y[kept])
    else:
        at, read = even_points(x, y, allowed - between, distance)
    off = np.abs(read - y) + between
    upper = np.abs(y) >= RELATIVE_FROM * largest
    return Table(
        part._replace(**{name: np.interp(at, x, getattr(part, name)) for name in _AT_KNOTS}),
        x.size,
        float(off.max()) / largest,
        float((off[upper] / np.abs(y[upper])).max()),
        float(part.standard_error.max()) / largest,
        tuple(_warnings(part, branch, float(np.abs(law.pressure).max()) * error)),
    )


def _warnings(part: StablePart, branch: str, tolerance: float) -> list[str]:
    warnings = []
    if part.tension > 0.0:
        warnings.append(
            f"the {branch} is in tension up to {format_quantity(part.tension, 'Pa')} where the surfaces are farther "
            "apart than at zero pressure: the table leaves that out"
        )
    if part.departure > tolerance:
        warnings.append(
            f"the pressure of the {branch} is not monotone: steps that a load jumps over are left out, off by up to "
            f"{format_quantity(part.departure, 'Pa')}"
        )
    return warnings


def between_points(law: Law, part: StablePart, quantity: Quantity) -> Floats:
    """Return how far a law may be off the line between neighbouring points, bent and by jumps: [2, point - 1].

    Over the pressure, value and pressure jump together: what counts is the value less the slope times the pressure. The
    slope is taken over three steps, since one step of the pressure may be tiny. Where a load jumps over steps, the line
    may be off by its whole rise. Steps beyond the stable part, where contact is made or lost, say nothing of it.
    """
    x, y = (part.pressure, part.value) if quantity.over_pressure else (part.overclosure, part.value)
    steps = np.arange(law.separation.size - 1)[:, None] + np.arange(-REACH, REACH + 2)
    there = (steps >= np.floor(part.step[0])) & (steps <= part.step[-1])
    steps = np.where(there, steps, 0)
    around = law.value[steps]
    if quantity.over_pressure:
        points = np.arange(y.size - 1)
        low, high = np.maximum(points - 1, 0), np.minimum(points + 2, y.size - 1)
        slope = (y[high] - y[low]) / (x[high] - x[low])
        at = np.searchsorted(part.step, np.arange(law.separation.size - 1) + 0.5) - 1
        around = around - slope[np.clip(at, 0, slope.size - 1), None] * law.pressure[steps]
    off = np.array(off_line(law.separation[steps], np.where(there, around, np.nan), spreads=ANYWHERE))
    found = np.empty((2, y.size - 1))
    for point, (begin, end) in enumerate(zip(part.step[:-1], part.step[1:], strict=True)):
        first, last = int(np.floor(begin)), int(np.ceil(end))
        found[:, point] = off[:, first:last].max(axis=1)
        if last > first + 1 and quantity.name == "area":
            skipped = slice(first + 1, last)
            line = np.interp(part.datum - law.separation[skipped], x, y)
            found[1, point] += np.abs(line - law.value[skipped]).max()
        elif last > first + 1:
            found[1, point] += abs(y[point + 1] - y[point])
    return found


def tolerances(y: Floats, error: float) -> Floats:
    """Return how far a table may be off at each point of a curve y.

    It is ``error`` of the value itself in the upper decade, and ``error`` of a tenth of the largest value below it.
    """
    size = np.abs(y)
    return np.asarray(error * np.maximum(size, RELATIVE_FROM * size.max()))


def knots(x: Floats, y: Floats, tolerance: Floats) -> NDArray[np.int64]:
    """Return the indices of the fewest points, first and last among them, whose lines stay within ``tolerance``.

    x rises. From each point the slopes that pass all later points within their tolerance narrow down to none; of the
    lines that these allow the shortest chain is taken.
    """
    n = x.size
    x, y, tolerance = x / np.abs(x).max(), *(part / np.abs(y).max() for part in (y, tolerance))
    count, before = np.full(n, n, dtype=np.int64), np.zeros(n, dtype=np.int64)
    count[0] = 0
    for i in range(n - 1):
        run, rise = x[i + 1 :] - x[i], y[i + 1 :] - y[i]
        least = np.maximum.accumulate((rise - tolerance[i + 1 :]) / run)
        most = np.minimum.accumulate((rise + tolerance[i + 1 :]) / run)
        slope = rise / run
        allowed = np.append(True, (least[:-1] <= slope[1:]) & (slope[1:] <= most[:-1]))
        better = np.flatnonzero(allowed & (count[i] + 1 < count[i + 1 :])) + i + 1
        count[better], before[better] = count[i] + 1, i
    kept = [n - 1]
    while kept[-1] > 0:
        kept.append(int(before[kept[-1]]))
    return np.array(kept[::-1])

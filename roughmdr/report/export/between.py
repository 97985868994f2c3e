"""How far a law may be off the lines between the points of its stable part."""

import numpy as np

from roughmdr.numerics.arguments import Floats
from roughmdr.report.export.law import Law, Quantity
from roughmdr.report.export.stable import StablePart
from roughmdr.result.between import ANYWHERE, REACH, off_line


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

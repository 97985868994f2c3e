"""How far a law may be off the lines between the points of its stable part, and what would bring it nearer."""

import math

import numpy as np

from roughmdr.numerics.arguments import Floats
from roughmdr.report.export.law import Law, Quantity
from roughmdr.report.export.stable import StablePart
from roughmdr.result.between import ANYWHERE, REACH, off_line

_MARGIN = 1.5
"""Factor on steps and realisations that are foreseen to do."""
_FOR_JUMPS = 0.75
"""Largest share of an allowed error that jumps may take; the rest is for the bend."""


def between_points(law: Law, part: StablePart, quantity: Quantity) -> Floats:
    """Return how far a law may be off the line between neighbouring points, bent and by jumps: [2, point - 1].

    Over the pressure, value and pressure jump together: what counts is the value less the slope times the pressure. The
    slope is taken over three steps, since one step of the pressure may be tiny. Where a load jumps over steps, the line
    may be off by its whole rise.
    """
    x, y = (part.pressure, part.value) if quantity.over_pressure else (part.overclosure, part.value)
    steps = np.arange(law.separation.size - 1)[:, None] + np.arange(-REACH, REACH + 2)
    there = (steps >= 0) & (steps < law.separation.size)
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


def remedy(law: Law, bent: float, jumps: float) -> str:
    """Return what would reduce errors between steps, given over those allowed, to 1.

    By a bend they fall with the square of the number of steps; by jumps with the root of the number of realisations,
    while more steps do not help against the largest of them.
    """
    if law.realizations == 0:
        more = max((_MARGIN * (bent + jumps)) ** 0.5, _MARGIN * jumps)
        return f"compute about {math.ceil(law.separation.size * more)} steps"
    steps, runs = law.separation.size, law.realizations
    for_jumps = min(_MARGIN * jumps, _FOR_JUMPS)
    more_steps = max(_MARGIN * bent / (1.0 - for_jumps), 1.0) ** 0.5
    more_runs = max(_MARGIN * jumps / _FOR_JUMPS, 1.0) ** 2
    asked = [f"{math.ceil(steps * more_steps)} steps"] if more_steps > 1.0 else []
    if more_runs > 1.0:
        asked.append(f"{math.ceil(runs * more_runs)} realisations, or take the expected law, which has no jumps")
    return f"compute about {' and '.join(asked)}"

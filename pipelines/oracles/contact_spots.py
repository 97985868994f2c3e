"""The spots of a contact on a periodic grid: how many there are, and their area without the bias of counted cells.

Cells under pressure count too much along the edge of a spot. Its squared pressure falls to zero there about linearly
in the area that it encloses (Hertz: exactly), and so the area above a few levels well inside tells that above zero.
"""

from typing import NamedTuple

import numpy as np
from scipy import ndimage

from roughmdr.numerics.arguments import Floats

_LEVELS = np.linspace(0.05, 0.6, 45)  # of the largest squared pressure of a spot
_MIN_CELLS = 50  # of a spot; smaller ones are counted


class Spots(NamedTuple):
    """Spots of a contact."""

    count: int
    area: float
    """As a share of the grid."""


def spots(pressure: Floats) -> Spots:
    """Return the spots of a pressure on a periodic grid, in any unit, shape (n, n)."""
    labels, number = ndimage.label(pressure > 0.0, structure=np.ones((3, 3)))
    same = np.arange(number + 1)
    for one, other in ((labels[0], labels[-1]), (labels[:, 0], labels[:, -1])):
        for shift in (-1, 0, 1):
            across = np.roll(other, shift)
            for i, j in zip(*(edge[(one > 0) & (across > 0)].tolist() for edge in (one, across)), strict=True):
                same[same == same[j]] = same[i]
    labels = same[labels]
    cells = pressure > 0.0
    order = np.argsort(labels[cells], kind="stable")
    squares, own = pressure[cells][order] ** 2, labels[cells][order]
    parts = np.split(squares, np.flatnonzero(np.diff(own)) + 1) if own.size else []
    return Spots(len(parts), sum(_area(part) for part in parts) / pressure.size)


def _area(squares: Floats) -> float:
    """Return the number of cells of a spot, from its squared pressures."""
    if squares.size < _MIN_CELLS:
        return float(squares.size)
    ordered = np.sort(squares)
    above = squares.size - np.searchsorted(ordered, _LEVELS * ordered[-1])
    return float(np.polynomial.Polynomial.fit(_LEVELS, above, 2)(0.0))

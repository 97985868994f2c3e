"""The normal closure of rock joints, a hyperbola, fitted to a law.

S. C. Bandis, A. C. Lumsden, N. R. Barton, Int. J. Rock Mech. Min. Sci. 20 (1983) 249.
"""

from typing import NamedTuple

import numpy as np

from roughmdr.numerics.arguments import Floats

SEATING = 0.01
"""Seating pressure over the largest: where a law begins exponentially, first touch is a matter of chance."""
_FEWEST = 4  # steps above the seating pressure
_WIDEST = 12.0
"""Largest log(v_m/v - 1), in size, at the largest closure v: beyond it the hyperbola is vertical there, or straight."""


class Hyperbola(NamedTuple):
    """Constants of p = k_ni v/(1 - v/v_m), p and v from a seating pressure on."""

    stiffness: float
    """k_ni [Pa/m]."""
    closure: float
    """v_m [m]."""
    misfit: float
    """Largest deviation of the hyperbola from the pressure, over the largest."""
    seating: float
    """Seating pressure [Pa]."""


def hyperbola(separation: Floats, pressure: Floats) -> Hyperbola | None:
    """Return the hyperbola of least squares of the pressure over the closure; None where too few steps are loaded."""
    seating = SEATING * float(pressure.max())
    loaded = np.flatnonzero(pressure > seating)
    if loaded.size < _FEWEST or loaded[0] == 0:
        return None
    first = int(loaded[0])
    datum = np.interp(seating, pressure[first - 1 : first + 1], separation[first - 1 : first + 1])
    v, p = (np.append(0.0, values) for values in (datum - separation[first:], pressure[first:] - seating))
    closure, largest, weight = float(v[-1]), float(p.max()), np.gradient(v)
    v, p, room, width = v / closure, p / largest, 0.0, _WIDEST
    while width > 1e-9:
        rooms = room + width * np.linspace(-1.0, 1.0, 41)
        shapes = v / (1.0 - v / (1.0 + np.exp(rooms[:, None])))
        slopes = (weight * shapes * p).sum(axis=1) / (weight * shapes * shapes).sum(axis=1)
        off = slopes[:, None] * shapes - p
        best = int(np.argmin((weight * off * off).sum(axis=1)))
        room, width = float(rooms[best]), width / 10.0
    room = 1.0 + float(np.exp(room))
    return Hyperbola(float(slopes[best]) * largest / closure, closure * room, float(np.abs(off[best]).max()), seating)

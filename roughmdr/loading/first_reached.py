"""Where loading first reaches a value of a quantity, such as a contact fraction."""

from collections.abc import Callable

import numpy as np

from roughmdr.errors import OutOfRange, TooMuchContact
from roughmdr.numerics.arguments import Floats

_POINTS = 16  # positions at which the law is computed in one call
_MAX_DOUBLINGS = 60

Law = Callable[[Floats], Floats]
"""Falling positions [m] of the flat, or of the far end of its spring -> the quantity there, in loading from the start.
"""


class OutOfReach(OutOfRange):
    """The value is exceeded at the start of loading, or is never reached."""


def first_reached(law: Law, value: float, start: float, distance: float, rtol: float, name: str) -> float:
    """Return the largest position [m] with a value, by search in ever longer and then ever shorter intervals.

    ``distance`` [m] is the depth to which it is sought first, ``rtol`` the error over the distance from the start,
    ``name`` that of the quantity. OutOfReach where it is not found.
    """
    if law(np.array([start]))[0] >= value:
        raise OutOfReach(f"is reached above the start, {start:.4g} m; start must be higher")
    above, below, most = start, start - distance, 0.0
    for _ in range(_MAX_DOUBLINGS):
        h = _positions(above, below)
        values = _until(law, h, value)
        if (values >= value).any():
            break
        most = max(most, float(values.max()))
        above, below, distance = below, below - 2.0 * distance, 2.0 * distance
    else:
        raise OutOfReach(f"is out of reach: the largest {name} of these asperities is {most:.4g}")
    while True:
        first = int(np.argmax(values >= value))
        above, below = float(h[first - 1]) if first else above, float(h[first])
        resolution = max(rtol * (start - below), float(np.spacing(max(abs(above), abs(below)))))
        if above - below <= resolution:
            return below
        h = _positions(above, below)
        values = _capped(law, h)


def _positions(above: float, below: float) -> Floats:
    """Return positions [m] from next to ``above`` to ``below``."""
    return np.linspace(above, below, _POINTS + 1)[1:]


def _until(law: Law, positions: Floats, value: float) -> Floats:
    """Return the law at falling positions [m], in halves: if the first half has reached ``value``, the second is inf.
    Far beyond, most asperities may be in contact, which takes long where they feel each other.
    """
    half = (positions.size + 1) // 2
    first, rest = _capped(law, positions[:half]), positions[half:]
    if rest.size == 0 or (first >= value).any():
        return np.concatenate([first, np.full(rest.size, np.inf)])
    return np.concatenate([first, _until(law, rest, value)])


def _capped(law: Law, positions: Floats) -> Floats:
    """Return the law at falling positions [m]: inf where there would be more contact than nominal area."""
    try:
        return law(positions)
    except TooMuchContact:
        if positions.size == 1:
            return np.array([np.inf])
        half = positions.size // 2
        first, rest = _capped(law, positions[:half]), np.full(positions.size - half, np.inf)
        return np.concatenate([first, _capped(law, positions[half:]) if not np.isposinf(first[-1]) else rest])

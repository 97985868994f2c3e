"""Where asperities stand on a square patch that repeats itself."""

import math

import numpy as np
from numpy.typing import NDArray

from roughmdr.ensemble.streams import POSITION, Streams
from roughmdr.errors import OutOfRange
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.jit import njit

_JAMMED = 0.547
"""The part of the plane that discs cover when at random no place is found for one more (J. Feder, J. Theor. Biol. 87
(1980) 237)."""
_TRIES = 2**10  # places tried for one point, on average, before the patch counts as full


def at_random(draws: Streams, count: int, patch: float) -> tuple[Floats, Floats]:
    """x and y [m] of ``count`` points anywhere on a patch of side ``patch`` [m]."""
    x, y = draws(POSITION, 2 * count).reshape(count, 2).T * patch
    return x, y


def hexagonal(count: int, patch: float) -> tuple[Floats, Floats]:
    """x and y [m] of ``count`` points in rows, as near to a hexagonal lattice as a square patch [m] allows.

    Every second row is shifted by half a place, and their number is even, so that the patch repeats itself. Where the
    rows have more places than there are points, those left free are spread evenly.
    """
    rows = 2 * max(round(math.sqrt(count / (2.0 * math.sqrt(3.0)))), 1)
    columns = -(-count // rows)
    row, column = np.divmod((np.arange(count) * (rows * columns)) // max(count, 1), max(columns, 1))
    return (column + 0.25 + 0.5 * (row % 2)) * (patch / max(columns, 1)), (row + 0.5) * (patch / rows)


def hard_core(draws: Streams, count: int, patch: float, distance: float) -> tuple[Floats, Floats]:
    """x and y [m] of ``count`` points at least ``distance`` [m] apart, also across the edges of the patch [m].

    Placed one after the other at random, each where there is room. OutOfRange where they do not fit.
    """
    most = _JAMMED * (patch / distance) ** 2 / (0.25 * math.pi)
    tries = 4
    while count <= most and tries <= _TRIES:
        places = draws(POSITION, 2 * tries * count).reshape(tries * count, 2)
        chosen = _apart(places, count, (distance / patch) ** 2, max(min(int(patch / distance), int(count**0.5)), 1))
        if chosen.size == count:
            x, y = places[chosen].T * patch
            return x, y
        tries *= 4
    raise OutOfRange(
        f"min_distance is {distance:g} m: {count} asperities do not fit so far apart on a patch of {patch:g} m; at "
        f"random about {int(0.95 * most)} do"
    )


@njit
def _apart(places: Floats, count: int, square: float, cells: int) -> NDArray[np.int64]:
    """The numbers of the first ``count`` places, on a unit patch, that are not within sqrt(square) of a chosen one."""
    head, following = np.full((cells, cells), -1), np.full(places.shape[0], -1)
    chosen = np.empty(count, dtype=np.int64)
    found = 0
    for i in range(places.shape[0]):
        if found == count:
            break
        column, row = int(places[i, 0] * cells), int(places[i, 1] * cells)
        free = True
        for across in range(-1, 2):
            for along in range(-1, 2):
                j = head[(column + across) % cells, (row + along) % cells]
                while j >= 0 and free:
                    dx, dy = abs(places[i, 0] - places[j, 0]), abs(places[i, 1] - places[j, 1])
                    dx, dy = min(dx, 1.0 - dx), min(dy, 1.0 - dy)
                    free = dx * dx + dy * dy >= square
                    j = following[j]
        if free:
            chosen[found] = i
            found += 1
            following[i] = head[column, row]
            head[column, row] = i
    return chosen[:found]

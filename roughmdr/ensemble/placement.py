"""Positions of asperities on a square patch that repeats periodically; ``lattice`` has those that fill a lattice."""

import math

import numpy as np
from numpy.typing import NDArray

from roughmdr.ensemble.streams import POSITION, Streams
from roughmdr.errors import OutOfRange
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.jit import njit

_JAMMING_COVERAGE = 0.547  # share of the plane that jammed random discs cover (J. Feder, J. Theor. Biol. 87 (1980) 237)
_MAX_TRIES = 2**10  # candidates for one point, on average, before the patch counts as full


def nearly_hexagonal_positions(count: int, patch: float) -> tuple[Floats, Floats]:
    """Return x and y [m] of ``count`` points in rows, as near to a hexagonal lattice as a square patch [m] allows.

    Every second row is shifted by half a site, and the number of rows is even, so that the patch is periodic. Where the
    rows have more sites than there are points, the empty ones are spread evenly.
    """
    rows = 2 * max(round(math.sqrt(count / (2.0 * math.sqrt(3.0)))), 1)
    columns = -(-count // rows)
    row, column = np.divmod((np.arange(count) * (rows * columns)) // max(count, 1), max(columns, 1))
    return (column + 0.25 + 0.5 * (row % 2)) * (patch / max(columns, 1)), (row + 0.5) * (patch / rows)


def hard_core_positions(streams: Streams, count: int, patch: float, min_distance: float) -> tuple[Floats, Floats]:
    """Return x and y [m] of ``count`` points at least ``min_distance`` [m] apart, also across the edges of the patch.

    Points are placed one after the other (random sequential addition). OutOfRange where they do not fit.
    """
    max_count = _JAMMING_COVERAGE * (patch / min_distance) ** 2 / (0.25 * math.pi)
    tries = 4
    while count <= max_count and tries <= _MAX_TRIES:
        candidates = streams(POSITION, 2 * tries * count).reshape(tries * count, 2)
        cells = max(min(int(patch / min_distance), int(count**0.5)), 1)
        chosen = _select_apart(candidates, count, (min_distance / patch) ** 2, cells)
        if chosen.size == count:
            x, y = candidates[chosen].T * patch
            return x, y
        tries *= 4
    message = f"{count} asperities do not fit so far apart on a patch of {patch:g} m; at random about"
    raise OutOfRange(f"min_distance is {min_distance:g} m: {message} {int(0.95 * max_count)} do")


@njit
def _select_apart(candidates: Floats, count: int, min_square: float, cells: int) -> NDArray[np.int64]:
    """Return the indices of the first ``count`` candidates whose squared distance to each earlier one suffices.

    Candidates lie on the unit square; each of cells x cells has a linked list of the points chosen in it.
    """
    head, following = np.full((cells, cells), -1), np.full(candidates.shape[0], -1)
    chosen = np.empty(count, dtype=np.int64)
    size = 0
    for i in range(candidates.shape[0]):
        if size == count:
            break
        column, row = int(candidates[i, 0] * cells), int(candidates[i, 1] * cells)
        free = True
        for across in range(-1, 2):
            for along in range(-1, 2):
                j = head[(column + across) % cells, (row + along) % cells]
                while j >= 0 and free:
                    dx, dy = abs(candidates[i, 0] - candidates[j, 0]), abs(candidates[i, 1] - candidates[j, 1])
                    dx, dy = min(dx, 1.0 - dx), min(dy, 1.0 - dy)
                    free = dx * dx + dy * dy >= min_square
                    j = following[j]
        if free:
            chosen[size] = i
            size += 1
            following[i] = head[column, row]
            head[column, row] = i
    return chosen[:size]

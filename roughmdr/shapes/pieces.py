"""Profiles in pieces: their params, and the one on which a radius lies.

The params hold the number of pieces, the length of a row, a row for each piece, whose first number is the t where it
begins, the number of softening intervals, and the beginning and end of each. The last piece goes on without end.
"""

from roughmdr.shapes.profile import Params

ROWS = 2
"""Offset of the first row."""


def row(number: int, params: Params) -> int:
    """Return the offset of the row of a piece."""
    return ROWS + int(params[1]) * number


def find(t: float, length: int, params: Params) -> int:
    """Return the offset of the row of the piece that t lies on, from the length of rows: sooner if it is a constant."""
    low, left = 0, int(params[0])
    while left > 1:
        half = left // 2
        low, left = (low + half if t >= params[ROWS + length * (low + half)] else low), left - half
    return ROWS + length * low


def breakpoint_count(params: Params) -> int:
    """Return the number of places between two pieces."""
    return int(params[0]) - 1


def softening_count(params: Params) -> int:
    """Return the number of softening intervals."""
    return int(params[row(int(params[0]), params)])


def softening_interval(index: int, params: Params) -> tuple[float, float]:
    """Return the beginning and end of one."""
    first = row(int(params[0]), params) + 1 + 2 * index
    return params[first], params[first + 1]

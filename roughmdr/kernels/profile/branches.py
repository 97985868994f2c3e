"""The state of one curved asperity on its branches, and the jumps between them. Notation of ``row``."""

import math
from collections.abc import Callable
from typing import Any

from roughmdr.kernels.profile.layout import COUNT, DEPTH, FOOT, FOOT_X, ONSET, TOP, TOP_X
from roughmdr.numerics.arguments import Floats

# Names that ``specialise`` fills with the functions of ``balance``, ``root`` and ``start``.
energy: Callable[..., float]
NODE: int
first_guess: Callable[..., float]
root: Callable[..., float]


def state_on(x: float, rung: float, row: Floats) -> float:
    """t at the distance x to the lowest foot on branch number ``rung`` = 1, 2, ..."""
    j = int(rung) - 1
    foot = row[FOOT + j]
    if x <= row[FOOT_X + j]:
        return foot
    if j == int(row[COUNT]) - 1:
        start = first_guess(x, row)
        return root(x * row[DEPTH], start if start > foot else foot + 1e-9 * row[NODE + 2], foot, math.inf, j, row)
    top = row[TOP + j]
    if x >= row[TOP_X + j]:
        return top
    return root(x * row[DEPTH], 0.5 * (foot + top), foot, top, j, row)


def state(x: float, row: Floats) -> float:
    """t at the distance x >= 0 to the lowest foot, on the branch of a slow retraction: the last that reaches so low."""
    j = int(row[COUNT])
    while j > 1 and x < row[FOOT_X + j - 1]:
        j -= 1
    return state_on(x, float(j), row)


def rung(x: float, before: float, touched: bool, row: Floats) -> float:
    """The branch, 1, 2, ... or 0 for none, after a way in one direction to x from where the contact was on ``before``.

    It begins where it is ``touched``, at ONSET, and moves to the next stable root where its branch ends.
    """
    j = int(before)
    if j == 0 and touched:
        j = 1
    while 0 < j < int(row[COUNT]) and x > row[TOP_X + j - 1]:
        j += 1
    while j > 0 and x <= row[FOOT_X + j - 1]:
        j -= 1
    return float(j)


def spent(before: float, after: float, row: Floats) -> float:
    """The energy lost in the jumps from one branch to another, over that of ``energy``; each where its branch ends."""
    j, last, lost = int(before), int(after), 0.0
    if j == 0 and last > 0:
        first = rung(row[ONSET], 0.0, True, row)
        lost -= energy(state_on(row[ONSET], first, row), row) if first > 0.0 else 0.0
        j = max(int(first), 1)  # attraction can also begin without a jump
    while j < last:
        x, u = row[TOP_X + j - 1], energy(row[TOP + j - 1], row)
        j += 1
        while j < int(row[COUNT]) and x > row[TOP_X + j - 1]:
            j += 1
        lost += u - energy(state_on(x, float(j), row), row)
    while j > last:
        x, u = row[FOOT_X + j - 1], energy(row[FOOT + j - 1], row)
        j -= 1
        while j > 0 and x <= row[FOOT_X + j - 1]:
            j -= 1
        lost += u - (energy(state_on(x, float(j), row), row) if j > 0 else 0.0)
    return lost


PARTS: tuple[Callable[..., Any], ...] = (state_on, state, rung, spent)

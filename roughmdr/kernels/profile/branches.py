"""The state of one curved asperity on its branches, and the jumps between them. Notation of ``params``."""

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


def state_on(x: float, rung: float, params: Floats) -> float:
    """t at the distance x to the lowest foot on branch number ``rung`` = 1, 2, ..."""
    j = int(rung) - 1
    foot = params[FOOT + j]
    if x <= params[FOOT_X + j]:
        return foot
    if j == int(params[COUNT]) - 1:
        start = first_guess(x, params)
        return root(
            x * params[DEPTH], start if start > foot else foot + 1e-9 * params[NODE + 2], foot, math.inf, j, params
        )
    top = params[TOP + j]
    if x >= params[TOP_X + j]:
        return top
    return root(x * params[DEPTH], 0.5 * (foot + top), foot, top, j, params)


def state(x: float, params: Floats) -> float:
    """t at the distance x >= 0 to the lowest foot, on the branch of a slow retraction: the last that reaches so low."""
    j = int(params[COUNT])
    while j > 1 and x < params[FOOT_X + j - 1]:
        j -= 1
    return state_on(x, float(j), params)


def rung(x: float, before: float, touched: bool, params: Floats) -> float:
    """The branch, 1, 2, ... or 0 for none, after a way in one direction to x from where the contact was on ``before``.

    It begins where it is ``touched``, at ONSET, and moves to the next stable root where its branch ends.
    """
    j = int(before)
    if j == 0 and touched:
        j = 1
    while 0 < j < int(params[COUNT]) and x > params[TOP_X + j - 1]:
        j += 1
    while j > 0 and x <= params[FOOT_X + j - 1]:
        j -= 1
    return float(j)


def spent(before: float, after: float, params: Floats) -> float:
    """The energy lost in the jumps from one branch to another, over that of ``energy``; each where its branch ends."""
    j, last, lost = int(before), int(after), 0.0
    if j == 0 and last > 0:
        first = rung(params[ONSET], 0.0, True, params)
        lost -= energy(state_on(params[ONSET], first, params), params) if first > 0.0 else 0.0
        j = max(int(first), 1)  # attraction can also begin without a jump
    while j < last:
        x, u = params[TOP_X + j - 1], energy(params[TOP + j - 1], params)
        j += 1
        while j < int(params[COUNT]) and x > params[TOP_X + j - 1]:
            j += 1
        lost += u - energy(state_on(x, float(j), params), params)
    while j > last:
        x, u = params[FOOT_X + j - 1], energy(params[FOOT + j - 1], params)
        j -= 1
        while j > 0 and x <= params[FOOT_X + j - 1]:
            j -= 1
        lost += u - (energy(state_on(x, float(j), params), params) if j > 0 else 0.0)
    return lost


PARTS: tuple[Callable[..., Any], ...] = (state_on, state, rung, spent)

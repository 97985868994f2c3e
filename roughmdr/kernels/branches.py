"""The state of one curved asperity on its branches, and the jumps between them. Notation of ``row``."""

import math
from collections.abc import Callable
from typing import Any

from roughmdr.arguments import Floats
from roughmdr.kernels.row import (
    COUNT,
    DEPTH,
    FOOT,
    FOOT_X,
    NODE,
    OCTAVES,
    SLOPE,
    TENSION,
    TOP,
    TOP_X,
)  # fmt: skip

# Names that ``specialise`` fills with the functions of a profile and of ``balance``.
_kink: Callable[..., bool]
load: Callable[..., tuple[float, float]]
energy: Callable[..., float]

_NEAR = 2e-3  # from here on to a foot the integral of the slope is better than the difference of the values
_GAUSS = 0.5 * math.sqrt(0.6)  # three nodes: exact for a slope of fifth degree
_FINE = 1e-8  # the square of a last step is below rounding
_PATIENCE = 6  # steps: the slope of a table can change so much that Newton's method goes in circles
_LOWEST = 2.0 ** (OCTAVES // 2)  # over which depth the start without adhesion begins
_LARGEST = 2.0**OCTAVES


def _above(t: float, j: int, row: Floats) -> tuple[float, float]:
    """How far the controlled quantity lies above the lowest foot, and its slope."""
    value, slope = load(t, row)
    foot = row[FOOT + j]
    step = t - foot
    if row[TENSION] == 0.0:
        return value, slope
    if step > _NEAR * t or _kink(foot, t, row):
        return value + row[DEPTH], slope
    middle = foot + 0.5 * step
    outer = load(middle - _GAUSS * step, row)[1] + load(middle + _GAUSS * step, row)[1]
    return row[FOOT_X + j] * row[DEPTH] + step * (5.0 * outer + 8.0 * load(middle, row)[1]) / 18.0, slope


def _root(wanted: float, t: float, low: float, high: float, j: int, row: Floats) -> float:
    """The t on branch j, between low and high, which lies ``wanted`` above the lowest foot: Newton's method from t."""
    foot = row[FOOT + j]
    for i in range(200):
        value, slope = _above(t, j, row)
        if value < wanted:
            low = t
        elif value > wanted:
            high = t
        else:
            return t
        step = (value - wanted) / slope if slope > 0.0 else math.inf
        if abs(step) <= _FINE * (t - foot):
            return t - step
        better = t - step
        circling = i % 3 == 2 and i > _PATIENCE and high < math.inf
        if circling or not low < better < high:
            better = 0.5 * (low + high) if high < math.inf else 2.0 * t
            if not low < better < high:
                return t
        t = better
    return math.nan


def _start(x: float, row: Floats) -> float:
    """A first guess on the last branch: cubic over each octave of y, a power law outside."""
    if row[TENSION] > 0.0:
        root = 1.0 + math.sqrt(x - row[FOOT_X + int(row[COUNT]) - 1])
        y = root * root  # smooth at a fold
    else:
        y = x * _LOWEST
    if not 1.0 <= y < _LARGEST:
        end = 0 if y < 1.0 else OCTAVES
        power = row[SLOPE + end] / row[NODE + end]
        return row[NODE + end] * math.pow(y * 2.0**-end, power)
    mantissa, exponent = math.frexp(y)
    i, u = exponent - 1, 2.0 * mantissa - 1.0
    t, rise = row[NODE + i], row[NODE + i + 1] - row[NODE + i]
    first, last = row[SLOPE + i], 0.5 * row[SLOPE + i + 1]
    return t + u * (first + u * ((3.0 * rise - 2.0 * first - last) + u * (first + last - 2.0 * rise)))


def find_start(row: Floats) -> None:
    """Fill in the first guesses of the last branch: t at the octaves of y, and dt/dy times y."""
    j = int(row[COUNT]) - 1
    foot, t = row[FOOT + j], row[FOOT + j]
    for i in range(OCTAVES + 1):
        y = math.ldexp(1.0, i)
        if row[TENSION] > 0.0:
            root = math.sqrt(y)
            x, dx = row[FOOT_X + j] + (root - 1.0) * (root - 1.0), (root - 1.0) * root
        else:
            x, dx = y / _LOWEST, y / _LOWEST
        if i > 0 or row[TENSION] == 0.0:
            guess = 2.0 * t - foot if t > foot else max(2.0 * foot, 1e-3)
            t = _root(x * row[DEPTH], guess, t, math.inf, j, row)
            row[SLOPE + i] = dx * row[DEPTH] / load(t, row)[1]
        elif foot == 0.0 or load(foot, row)[1] > 1e-6 * row[DEPTH] / foot:
            row[SLOPE] = 0.0  # a corner
        else:
            bent = load(foot + 1e-4 * foot, row)[1] / (1e-4 * foot)
            row[SLOPE] = math.sqrt(0.5 * row[DEPTH] / bent)
        row[NODE + i] = t


def state_on(x: float, rung: float, row: Floats) -> float:
    """t at the distance x to the lowest foot on branch number ``rung`` = 1, 2, ..."""
    j = int(rung) - 1
    foot = row[FOOT + j]
    if x <= row[FOOT_X + j]:
        return foot
    if j == int(row[COUNT]) - 1:
        start = _start(x, row)
        return _root(x * row[DEPTH], start if start > foot else foot + 1e-9 * row[NODE + 1], foot, math.inf, j, row)
    top = row[TOP + j]
    if x >= row[TOP_X + j]:
        return top
    return _root(x * row[DEPTH], 0.5 * (foot + top), foot, top, j, row)


def state(x: float, row: Floats) -> float:
    """t at the distance x >= 0 to the lowest foot, on the branch of a slow retraction: the last that reaches so low."""
    j = int(row[COUNT])
    while j > 1 and x < row[FOOT_X + j - 1]:
        j -= 1
    return state_on(x, float(j), row)


def rung(x: float, before: float, row: Floats) -> float:
    """The branch, 1, 2, ... or 0 for none, after a way in one direction to x from where the contact was on ``before``.

    It begins at first touch, x = 1, and moves to the next stable root where its branch ends.
    """
    j = int(before)
    if j == 0 and x >= 1.0:
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
        first = rung(1.0, 0.0, row)
        lost -= energy(state_on(1.0, first, row), row)
        j = int(first)
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


PARTS: tuple[Callable[..., Any], ...] = (_above, _root, _start, find_start, state_on, state, rung, spent)

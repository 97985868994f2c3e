"""Where Newton's method begins on the last branch: cubics over octaves of y, or parts of them, and power laws outside.

y = (1 + sqrt(x - x of the foot))^2, in which t is smooth at a fold; without adhesion a multiple of x. Notation of
``params``.
"""

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from roughmdr.kernels.profile.layout import CONTROL, COUNT, DEPTH, LAST, LAST_X, OCTAVES, TENSION
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.vector_math import binade_cell

# Names that ``specialise`` fills with the functions of ``balance`` and ``root``, and with how fine the nodes are.
SPLIT: int
NODE: int
load: Callable[..., tuple[float, float]]
root: Callable[..., float]
nearer: Callable[..., tuple[float, float, float]]

_LOWEST = 2.0 ** (OCTAVES // 2)  # over which depth the start without adhesion begins
_LARGEST = 2.0**OCTAVES
_ROUGH = 0.1  # of the way from the foot: a larger second step to a node is not trusted
_CORNER = 1e-6  # of the depth over the foot: a fold has no slope
_BEND = 1e-4  # of the foot: over it the slope at a fold is linear


def scale(x: float, params: Floats) -> float:
    """y at the distance x to the lowest foot."""
    side = 1.0 + math.sqrt(max(x - params[LAST_X], 0.0))
    return side * side if params[TENSION] > 0.0 else x * _LOWEST


def guess(x: float, params: Floats) -> float:
    """t within the octaves; beyond them anything."""
    node, u = binade_cell(scale(x, params), SPLIT)
    node = min(max(node, 0), (OCTAVES << SPLIT) - 1)
    at, parts = NODE + 2 * node, (1 << SPLIT) + (node & ((1 << SPLIT) - 1))  # parts in the y of the node
    t, rise = params[at], params[at + 2] - params[at]
    first, last = params[at + 1] / float(parts), params[at + 3] / float(parts + 1)
    return float(t + u * (first + u * ((3.0 * rise - 2.0 * first - last) + u * (first + last - 2.0 * rise))))


def first_guess(x: float, params: Floats) -> float:
    """t anywhere."""
    y = scale(x, params)
    if 1.0 <= y < _LARGEST:
        return guess(x, params)
    end = NODE if y < 1.0 else NODE + 2 * (OCTAVES << SPLIT)
    return float(params[end] * math.pow(y if y < 1.0 else y / _LARGEST, params[end + 1] / params[end]))


def place(y: float, params: Floats) -> tuple[float, float]:
    """The distance x to the lowest foot at y, and dx/dy times y."""
    side = math.sqrt(y)
    if params[TENSION] > 0.0:
        return params[LAST_X] + (side - 1.0) * (side - 1.0), (side - 1.0) * side
    return y / _LOWEST, y / _LOWEST


def extrapolated(node: int, interval: float, params: Floats) -> float:
    """About t at a node, from the one before with ln y less by ``interval``: the way from the foot is a power of y."""
    foot, at = params[LAST], NODE + 2 * node
    way, step = params[at - 2] - foot, params[at - 1] * interval
    power = step / way if way > 0.0 else 0.0
    return float(params[at - 2] + step * (1.0 + power * (0.5 + power / 6.0)))


def find_first_node(params: Floats) -> None:
    """Fill in the first node: the foot, or without adhesion a small contact."""
    foot = params[LAST]
    if params[TENSION] == 0.0:
        find_node(0, 1.0, params)
        return
    params[NODE] = foot
    if foot == 0.0 or load(foot, params)[1] > _CORNER * params[DEPTH] / foot:
        params[NODE + 1] = 0.0
    else:
        bent = load(foot + _BEND * foot, params)[1] / (_BEND * foot)
        params[NODE + 1] = math.sqrt(0.5 * params[DEPTH] / bent)


def find_node(node: int, y: float, params: Floats) -> None:
    """Fill in a node by itself."""
    foot, at = params[LAST], NODE + 2 * node
    x, dx = place(y, params)
    before = params[at - 2] if node > 0 else 0.0
    start = 2.0 * before - foot if before > foot else max(2.0 * foot, 1e-3)
    params[at] = root(x * params[DEPTH], start, foot, math.inf, int(params[COUNT]) - 1, params)
    params[at + 1] = dx * params[DEPTH] / load(params[at], params)[1]


def find_starts(rows: Floats) -> None:
    """Fill in the nodes of all rows, one after the other for all at once, so that no row waits for another."""
    count = rows.shape[0]
    t, step, per = np.empty(count), np.empty(count), np.empty(count)
    for i in range(count):
        if rows[i, COUNT] > 0.0:
            find_first_node(rows[i])
    y = 1.0
    for node in range(1, (OCTAVES << SPLIT) + 1):
        before = y
        y = math.ldexp(1.0 + math.ldexp(float(node & ((1 << SPLIT) - 1)), -SPLIT), node >> SPLIT)
        interval = math.log(y / before)
        for i in range(count):
            t[i] = extrapolated(node, interval, rows[i])
        for _ in range(2):
            for i in range(count):
                t[i], step[i], per[i] = nearer(t[i], place(y, rows[i])[0], rows[i])
        for i in range(count):
            rows[i, NODE + 2 * node], rows[i, NODE + 2 * node + 1] = t[i], place(y, rows[i])[1] * per[i]
        for i in range(count):
            # Under dead load ``nearer`` has gone elsewhere.
            trusted = (abs(step[i]) < _ROUGH * (t[i] - rows[i, LAST])) & (rows[i, CONTROL] == 0.0)
            if not trusted and rows[i, COUNT] > 0.0:
                find_node(node, y, rows[i])


PARTS: tuple[Callable[..., Any], ...] = (
    scale,
    guess,
    first_guess,
    place,
    extrapolated,
    find_node,
    find_first_node,
    find_starts,
)

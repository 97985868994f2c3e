"""The initial guess for Newton's method on the last branch: cubics over octaves of y, or parts of them, and
power laws beyond.

y = (1 + sqrt(x - x of the foot))^2, in which t is smooth at a fold; without adhesion a multiple of x. Notation of
``layout``.
"""

import math

import numpy as np

from roughmdr.kernels.profile.interface import law
from roughmdr.kernels.profile.layout import CONTROL, COUNT, DEPTH, LAST, LAST_X, OCTAVES, TENSION
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.jit import compiled
from roughmdr.numerics.vector_math import binade_cell

_octave = compiled(binade_cell, small=True)

_LOWEST = 2.0 ** (OCTAVES // 2)  # without adhesion the octaves begin at 1/_LOWEST of the depth
_LARGEST = 2.0**OCTAVES
_MAX_STEP = 0.1  # of the distance to the foot: after a larger second step a node is solved for by itself
_CORNER = 1e-6  # of the depth over the foot: a steeper foot is a corner, not a fold
_BEND = 1e-4  # of the foot: so far from a fold the slope is linear


def y_of_x(x: float, params: Floats) -> float:
    """y at x."""
    side = 1.0 + math.sqrt(max(x - params[LAST_X], 0.0))
    return side * side if params[TENSION] > 0.0 else x * _LOWEST


def y_of_node(node: int) -> float:
    """y at a node."""
    return math.ldexp(1.0 + math.ldexp(float(node & ((1 << law.split) - 1)), -law.split), node >> law.split)


def cubic(u: float, first: float, slope: float, last: float, last_slope: float) -> float:
    """The cubic from u = 0 to 1 with these values and slopes at the ends."""
    rise = last - first
    return first + u * (slope + u * ((3.0 * rise - 2.0 * slope - last_slope) + u * (slope + last_slope - 2.0 * rise)))


def initial_guess(x: float, params: Floats) -> float:
    """t within the octaves; meaningless outside."""
    node, u = _octave(law.y_of_x(x, params), law.split)
    node = min(max(node, 0), (OCTAVES << law.split) - 1)
    at = law.first_node + 2 * node
    parts = (1 << law.split) + (node & ((1 << law.split) - 1))  # y of the node over the width of its part
    return law.cubic(u, params[at], params[at + 1] / float(parts), params[at + 2], params[at + 3] / float(parts + 1))


def guess_anywhere(x: float, params: Floats) -> float:
    """t within and outside the octaves."""
    y = law.y_of_x(x, params)
    if 1.0 <= y < _LARGEST:
        return law.initial_guess(x, params)
    end = law.first_node if y < 1.0 else law.first_node + 2 * (OCTAVES << law.split)
    return float(params[end] * math.pow(y if y < 1.0 else y / _LARGEST, params[end + 1] / params[end]))


def x_of_y(y: float, params: Floats) -> tuple[float, float]:
    """x at y, and y dx/dy."""
    side = math.sqrt(y)
    if params[TENSION] > 0.0:
        return params[LAST_X] + (side - 1.0) * (side - 1.0), (side - 1.0) * side
    return y / _LOWEST, y / _LOWEST


def extrapolate_node(node: int, interval: float, params: Floats) -> float:
    """t at a node, from the node before, whose ln y is less by ``interval``: t - foot is about a power of y."""
    foot, before = params[LAST], law.first_node + law.node_size * (node - 1)
    way, step = params[before] - foot, params[before + 1] * interval
    power = step / way if way > 0.0 else 0.0
    return float(params[before] + step * (1.0 + power * (0.5 + power / 6.0)))


def fill_first_node(params: Floats) -> None:
    """Fill in the first node: the foot, or without adhesion a small contact."""
    foot = params[LAST]
    if params[TENSION] == 0.0:
        law.fill_node(0, 1.0, params)
        return
    params[law.first_node] = foot
    if foot == 0.0 or law.control_at(foot, params)[1] > _CORNER * params[DEPTH] / foot:
        params[law.first_node + 1] = 0.0
    else:
        bent = law.control_at(foot + _BEND * foot, params)[1] / (_BEND * foot)
        params[law.first_node + 1] = math.sqrt(0.5 * params[DEPTH] / bent)


def fill_node(node: int, y: float, params: Floats) -> None:
    """Fill in one node, solved for by itself."""
    foot, at = params[LAST], law.first_node + law.node_size * node
    x, dx = law.x_of_y(y, params)
    before = params[at - law.node_size] if node > 0 else 0.0
    start = 2.0 * before - foot if before > foot else max(2.0 * foot, 1e-3)
    params[at] = law.solve_on_branch(x * params[DEPTH], start, foot, math.inf, int(params[COUNT]) - 1, params)
    params[at + 1] = dx * params[DEPTH] / law.control_at(params[at], params)[1]


def fill_nodes(rows: Floats) -> None:
    """Fill in the nodes of all rows, each node for all rows at a time, so that no row waits for another."""
    count = rows.shape[0]
    t, step, per = np.empty(count), np.empty(count), np.empty(count)
    for i in range(count):
        if rows[i, COUNT] > 0.0:
            law.fill_first_node(rows[i])
    y = 1.0
    for node in range(1, (OCTAVES << law.split) + 1):
        before = y
        y = law.y_of_node(node)
        interval = math.log(y / before)
        for i in range(count):
            t[i] = law.extrapolate_node(node, interval, rows[i])
        for _ in range(2):
            for i in range(count):
                t[i], step[i], per[i] = law.newton_step(t[i], law.x_of_y(y, rows[i])[0], rows[i])
        for i in range(count):
            rows[i, law.first_node + 2 * node], rows[i, law.first_node + 2 * node + 1] = (
                t[i],
                law.x_of_y(y, rows[i])[1] * per[i],
            )
        for i in range(count):
            # ``newton_step`` is for fixed grips.
            trusted = (abs(step[i]) < _MAX_STEP * (t[i] - rows[i, LAST])) & (rows[i, CONTROL] == 0.0)
            if not trusted and rows[i, COUNT] > 0.0:
                law.fill_node(node, y, rows[i])

"""The initial guess for Newton's method on the last branch: cubics over octaves of y, or parts of them, and
power laws beyond.

y = (1 + 4 sqrt(x - x of the foot))^2, in which t is smooth at a fold; without adhesion a multiple of x. A node has t
there and its slope over the part of an octave that begins there. Notation of ``layout``.
"""

import math

import numpy as np

from roughmdr.kernels.profile.interface import kernel
from roughmdr.kernels.profile.layout import CONTROL, COUNT, DEPTH, FLAT, LAST, LAST_X, TENSION
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.jit import compiled
from roughmdr.numerics.vector_math import binade_cell

_octave = compiled(binade_cell, small=True)

_PER_DEPTH = 2.0**12  # inverse of the depth at which the octaves begin without adhesion
_FINE = 4.0  # factor on the root in y: the larger, the more octaves next to the foot
_MAX_ERROR = 1e-4  # error over the distance to the foot above which a node is solved for by itself
_BEYOND = 2  # more nodes: the end of the part, and one as a rounding can lead into the next
_STEPS = 8  # steps of Newton's method for all rows together before that
_CORNER = 1e-6  # slope of the control at a foot, over depth/foot, above which it is a corner, not a fold
_BEND = 1e-4  # distance from a fold, over its state, within which the slope is linear


def y_of_x(x: float, params: Floats) -> float:
    """y at x."""
    side = 1.0 + _FINE * math.sqrt(max(x - params[LAST_X], 0.0))
    return side * side if params[TENSION] > 0.0 else x * _PER_DEPTH


def y_over_part(node: int) -> float:
    """y at a node over the length of the part of an octave that begins there."""
    return float((1 << kernel.split) + (node & ((1 << kernel.split) - 1)))


def y_of_node(node: int) -> float:
    """y at a node."""
    return kernel.y_over_part(node) / float(1 << kernel.split) * float(1 << (node >> kernel.split))


def shortening(node: int) -> float:
    """The length of the part that ends at a node over that of the next: 1/2 where an octave begins, else 1."""
    return 0.5 if node & ((1 << kernel.split) - 1) == 0 else 1.0


def cubic(u: float, first: float, slope: float, last: float, last_slope: float) -> float:
    """The cubic from u = 0 to 1 with these values and slopes at the ends."""
    rise = last - first
    return first + u * (slope + u * ((3.0 * rise - 2.0 * slope - last_slope) + u * (slope + last_slope - 2.0 * rise)))


def initial_guess(y: float, params: Floats) -> float:
    """t within the octaves; meaningless outside."""
    node, u = _octave(y, kernel.split)
    node = min(max(node, 0), (kernel.octaves << kernel.split) - 1)
    at = kernel.first_node + 2 * node
    return kernel.cubic(u, params[at], params[at + 1], params[at + 2], params[at + 3] * kernel.shortening(node + 1))


def guess_anywhere(x: float, params: Floats) -> float:
    """t within and outside the octaves."""
    y, largest = kernel.y_of_x(x, params), math.ldexp(1.0, kernel.octaves)
    if 1.0 <= y < largest:
        return kernel.initial_guess(y, params)
    end = kernel.first_node if y < 1.0 else kernel.first_node + 2 * (kernel.octaves << kernel.split)
    return float(
        params[end] * math.pow(y if y < 1.0 else y / largest, float(1 << kernel.split) * params[end + 1] / params[end])
    )


def x_of_y(y: float, params: Floats) -> tuple[float, float]:
    """x at y, and y dx/dy."""
    side = math.sqrt(y)
    way = (side - 1.0) / _FINE
    if params[TENSION] > 0.0:
        return params[LAST_X] + way * way, way * side / _FINE
    return y / _PER_DEPTH, y / _PER_DEPTH


def extrapolate_node(node: int, step: float, params: Floats) -> float:
    """t at a node, by a ``step_to`` from the node before: t - foot is about an exponential of such steps."""
    foot, before = params[LAST], kernel.first_node + kernel.node_size * (node - 1)
    way = params[before] - foot
    z = kernel.y_over_part(node - 1) * params[before + 1] * step / way if way > 0.0 else 0.0
    bend = 1.0 + z * z / 12.0
    return float(foot + way * (bend + 0.5 * z) / (bend - 0.5 * z))


def step_to(node: int, params: Floats) -> float:
    """The step from the node before to node > 1: in ln y; or, as t - foot grows with sqrt y - 1 next to a foot, in the
    logarithm of that, times d ln y by it at the node before.
    """
    y, before = kernel.y_of_node(node), kernel.y_of_node(node - 1)
    if params[TENSION] == 0.0:
        return math.log(y / before)
    side = math.sqrt(before)
    return 2.0 * (side - 1.0) / side * math.log((math.sqrt(y) - 1.0) / (side - 1.0))


def fill_first_node(params: Floats) -> float:
    """Fill in the first node, the foot or without adhesion a small contact; return about the t at the next."""
    foot, y = params[LAST], kernel.y_of_node(1)
    if params[TENSION] == 0.0:
        kernel.fill_node(0, 1.0, params)
        return float(kernel.extrapolate_node(1, math.log(y), params))
    params[kernel.first_node] = foot
    slope = kernel.control_at(foot, params)[1] if foot > 0.0 or params[FLAT] > 0.0 else math.inf
    if foot == 0.0 or slope > _CORNER * params[DEPTH] / foot:
        params[kernel.first_node + 1] = 0.0
        way = (kernel.x_of_y(y, params)[0] - params[LAST_X]) * params[DEPTH]
        return float(foot + way / slope if slope > 0.0 else foot)
    bent = kernel.control_at(foot + _BEND * foot, params)[1] / (_BEND * foot)
    slope = math.sqrt(0.5 * params[DEPTH] / bent) / _FINE
    params[kernel.first_node + 1] = slope / kernel.y_over_part(0)
    return float(foot + 2.0 * slope * (math.sqrt(y) - 1.0))


def fill_node(node: int, y: float, params: Floats) -> None:
    """Fill in one node, solved for by itself."""
    foot, at = params[LAST], kernel.first_node + kernel.node_size * node
    x, dx = kernel.x_of_y(y, params)
    before = params[at - kernel.node_size] if node > 0 else 0.0
    start = 2.0 * before - foot if before > foot else max(2.0 * foot, 1e-3)
    params[at] = kernel.solve_on_branch(x * params[DEPTH], start, foot, math.inf, int(params[COUNT]) - 1, params)
    params[at + 1] = dx * params[DEPTH] / kernel.control_at(params[at], params)[1] / kernel.y_over_part(node)


def node_beyond(indentation: float, params: Floats) -> int:
    """The last node that a guess up to an indentation over rise can need."""
    if params[COUNT] == 0.0:
        return 0
    above_foot = max(indentation + (params[DEPTH] if params[TENSION] > 0.0 else 0.0), 0.0)
    y = min(max(kernel.y_of_x(above_foot / params[DEPTH], params), 1.0), math.ldexp(1.0, kernel.octaves))
    return int(min(_octave(y, kernel.split)[0] + _BEYOND, kernel.octaves << kernel.split))


def fill_nodes(last: int, rows: Floats) -> None:
    """Fill in the nodes up to ``last``, each for all rows before the next, so that no row waits for another."""
    count = rows.shape[0]
    found = np.empty((3, count))
    t, error, per = found[0], found[1], found[2]
    for i in range(count):
        t[i] = kernel.fill_first_node(rows[i]) if rows[i, COUNT] > 0.0 else 0.0
    for node in range(1, last + 1):
        y = kernel.y_of_node(node)
        if node > 1:
            step = kernel.step_to(node, rows[0])
            for i in range(count):
                t[i] = kernel.extrapolate_node(node, step, rows[i])
        for _ in range(_STEPS):
            kernel.one_step_all(y, found, rows)
            unsure = 0
            for i in range(count):
                unsure += error[i] > _MAX_ERROR
            if unsure == 0:
                break
        for i in range(count):
            rows[i, kernel.first_node + 2 * node] = t[i]
            rows[i, kernel.first_node + 2 * node + 1] = kernel.x_of_y(y, rows[i])[1] * per[i] / kernel.y_over_part(node)
        for i in range(count):
            # ``one_step`` is for fixed grips.
            trusted = (error[i] < _MAX_ERROR) & (rows[i, CONTROL] == 0.0)
            if not trusted and rows[i, COUNT] > 0.0:
                kernel.fill_node(node, y, rows[i])


def one_step_all(y: float, found: Floats, rows: Floats) -> None:
    """Do ``one_step`` to y for all rows; ``found`` has their states, then the bounds of the errors and the slopes."""
    t, error, per = found[0], found[1], found[2]
    for i in range(rows.shape[0]):
        t[i], error[i], per[i] = kernel.one_step(t[i], kernel.x_of_y(y, rows[i])[0], rows[i])

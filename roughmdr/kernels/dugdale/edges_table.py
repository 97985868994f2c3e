"""The initial guess for Newton's method on both edges: a table like that of ``profile.initial_guess``, with two values.

Each node has s and m, both with their slopes over the part of an octave that begins there. Notation of ``both_edges``.
"""

import math

import numpy as np

from roughmdr.kernels.interface import Columns, Material
from roughmdr.kernels.profile.interface import kernel
from roughmdr.kernels.profile.layout import COUNT, JUNCTION, LAST
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.jit import compiled
from roughmdr.numerics.vector_math import binade_cell

_cell = compiled(binade_cell, small=True)

_MOST_LOG = 300.0  # largest logarithm of the growth of a guess, which must not overflow


def guess_both(x: float, params: Floats) -> tuple[float, float]:
    """s and m: within the octaves by cubics, beyond by power laws."""
    y, last = kernel.y_of_x(x, params), kernel.octaves << kernel.split
    node, u = _cell(y, kernel.split)
    if node >= last:
        at = kernel.first_node + 4 * last
        beyond = float(1 << kernel.split) * (math.log(y) - kernel.octaves * math.log(2.0))
        return (
            params[at] * math.exp(min(beyond * params[at + 1] / params[at], _MOST_LOG)),
            params[at + 2] * math.exp(min(beyond * params[at + 3] / params[at + 2], _MOST_LOG)),
        )
    node = max(node, 0)
    at = kernel.first_node + 4 * node
    share = kernel.shortening(node + 1)
    return (
        kernel.cubic(u, params[at], params[at + 1], params[at + 4], params[at + 5] * share),
        kernel.cubic(u, params[at + 2], params[at + 3], params[at + 6], params[at + 7] * share),
    )


def fill_nodes(last: int, rows: Floats) -> None:
    """Fill in the nodes up to ``last`` of all rows."""
    for i in range(rows.shape[0]):
        if rows[i, COUNT] > 0.0:
            kernel.fill_nodes_of(last, rows[i])


def prepare(material: Material, columns: Columns, start: int, stop: int, control: float, deepest: float) -> Floats:
    """Return a row for each of the asperities from start to stop; those like the one before are not computed again."""
    rows = np.zeros((stop - start, 2 - kernel.first_node))
    for i in range(start, stop):
        row = rows[i - start]
        if i > start and kernel.repeated(columns, i):
            row[:] = rows[i - start - 1]
            continue
        row[0] = columns.params[i]
        kernel.fill_params(material, columns.width[i], columns.rise[i], control, row)
        if row[COUNT] > 0.0:
            kernel.fill_nodes_of(kernel.node_beyond(deepest / columns.rise[i], row), row)
    return rows


def fill_nodes_of(last: int, params: Floats) -> None:
    """Fill in the nodes up to ``last`` of one row, each from the one before."""
    first = kernel.fill_first_node(params)
    at = kernel.first_node
    m, slope = kernel.zone_at(params[LAST], params)
    params[at + 2], params[at + 3] = m, slope * params[at + 1]
    for node in range(1, last + 1):
        at, y = kernel.first_node + 4 * node, kernel.y_of_node(node)
        x, dx = kernel.x_of_y(y, params)
        s = kernel.extrapolate_node(node, kernel.step_to(node, params), params) if node > 1 else first
        m_before = params[at - 2]
        growth = kernel.y_over_part(node - 1) * params[at - 1] / m_before
        grown = min(growth * math.log(y / kernel.y_of_node(node - 1)), _MOST_LOG)
        found, s, m, s_slope, m_slope = kernel.both_edges(x, s, m_before * math.exp(grown), params)
        if found:
            per_part = dx / kernel.y_over_part(node)
            params[at], params[at + 1], params[at + 2], params[at + 3] = s, s_slope * per_part, m, m_slope * per_part
        else:
            kernel.fill_node(node, y, params)
            m, slope = kernel.zone_at(params[at], params)
            params[at + 2], params[at + 3] = m, slope * params[at + 1]


def zone_at(s: float, params: Floats) -> tuple[float, float]:
    """m at s, and its derivative by s along the equilibria."""
    if s <= 1.0:
        return s * params[JUNCTION], params[JUNCTION]
    m = kernel.zone_edge(s, params)[2]
    _, _, s_slope, m_slope = kernel.newton_of_both(s, m, 0.0, params)
    return m, m_slope / s_slope


def guess_anywhere(x: float, params: Floats) -> float:
    """s at x >= that of the foot."""
    s, _ = kernel.guess_both(x, params)
    return s

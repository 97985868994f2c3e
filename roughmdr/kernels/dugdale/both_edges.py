"""The edges of the contact and of its zone found together, by Newton's method on two equations under fixed grips:

    g(a) - beta m = delta,   J + beta (m theta - c + a) = pi/2 w/sigma0,

with the derivatives of the second by a and m

    a B/c^2 - theta g',   m B/c^2 + beta theta,

so that one evaluation of J and K is a step of both. Notation of ``equilibrium``; the state is s, and with it m. The
initial guess is a table as in ``profile.initial_guess``, of both: s, y ds/dy, m and y dm/dy at each node.
"""

import math

from roughmdr.kernels.profile.interface import law
from roughmdr.kernels.profile.layout import (
    CANCELLED,
    CONTROL,
    COUNT,
    DEPTH,
    JUNCTION,
    LAST,
    LAST_X,
    NEAR,
    RANGE,
    STRENGTH,
)
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.jit import compiled
from roughmdr.numerics.vector_math import atan, binade_cell

_atan, _cell = compiled(atan, small=True), compiled(binade_cell, small=True)

_RTOL_STEP = 3e-8  # of the distance to the foot and of m: the next error, its square, is below rounding
_MAX_STEPS = 12
_MIN_SHARE = 1e-2  # of the distance to the foot and of m: left after a step that would go beyond 0
_MOST_GROWTH = 10.0  # of m in a step


def newton_of_both(s: float, m: float, wanted: float, params: Floats) -> tuple[float, float, float, float]:
    """The steps of s and m, and their derivatives by the indentation along the equilibria."""
    beta, size = params[STRENGTH], params[JUNCTION]
    if s <= 1.0:
        value, slope = law.indentation_at(s, params)
        step = (wanted - value) / slope
        return step, size * (s + step) - m, 1.0 / slope, size / slope
    t, a, g, da, dg = law.contact_edge(s, params)
    if law.end < math.inf and not m < law.widest_zone(a):
        return law.newton_at_end(s, wanted, params)
    theta, square = _atan(m / a), a * a + m * m
    j, k = law.gap_integrals(t, a, g, m, theta, params)
    short = m * m / (math.sqrt(square) + a)  # c - a
    firm = (k - beta * short) / square  # B/c^2
    off = g - beta * m - wanted
    open_ = j + beta * (m * theta - short) - 0.5 * math.pi * params[RANGE]
    by_s, by_m = da * a * firm - dg * theta, m * firm + beta * theta
    both = firm * (dg * m + beta * a * da)
    return -(off * by_m + beta * open_) / both, (off * by_s - dg * open_) / both, by_m / both, -by_s / both


def newton_at_end(s: float, wanted: float, params: Floats) -> tuple[float, float, float, float]:
    """As ``newton_of_both`` where the zone stays at the end of the profile; NaN where it does not."""
    t, a, g, da, dg = law.contact_edge(s, params)
    m = law.widest_zone(a)
    if law.gap_at(t, a, g, m, params)[0] > 0.5 * math.pi * params[RANGE]:
        return math.nan, math.nan, math.nan, math.nan
    m_by_s = -a * da / m
    slope = dg - params[STRENGTH] * m_by_s
    step = (wanted - g + params[STRENGTH] * m) / slope
    return step, step * m_by_s, 1.0 / slope, m_by_s / slope


def both_edges(x: float, s: float, m: float, params: Floats) -> tuple[bool, float, float, float, float]:
    """Whether Newton's method from s and m converges on the last branch; then s, m, ds/dx and dm/dx at x."""
    foot, wanted = params[LAST], (x - 1.0) * params[DEPTH]
    for _ in range(_MAX_STEPS if params[CONTROL] == 0.0 else 0):
        ds, dm, s_slope, m_slope = law.newton_of_both(s, m, wanted, params)
        beyond = s - foot
        if not (abs(ds) < math.inf and abs(dm) < math.inf):
            break
        if abs(ds) <= _RTOL_STEP * beyond and abs(dm) <= _RTOL_STEP * m:
            far = s + ds > foot + params[NEAR] * s and (foot > 0.0 or x > params[LAST_X] + CANCELLED)
            return far, s + ds, m + dm, s_slope * params[DEPTH], m_slope * params[DEPTH]
        s = max(s + ds, foot + _MIN_SHARE * beyond)
        m = min(max(m + dm, _MIN_SHARE * m), _MOST_GROWTH * m)
    return False, s, m, 0.0, 0.0


def guess_both(x: float, params: Floats) -> tuple[float, float]:
    """s and m: within the octaves by cubics, beyond by power laws."""
    y, last = law.y_of_x(x, params), law.octaves << law.split
    node, u = _cell(y, law.split)
    if node >= last:
        at, beyond = law.first_node + 4 * last, math.log(y) - law.octaves * math.log(2.0)
        return (
            params[at] * math.exp(beyond * params[at + 1] / params[at]),
            params[at + 2] * math.exp(beyond * params[at + 3] / params[at + 2]),
        )
    node = max(node, 0)
    at = law.first_node + 4 * node
    parts = (1 << law.split) + (node & ((1 << law.split) - 1))  # y of the node over the width of its part
    share, next_share = 1.0 / float(parts), 1.0 / float(parts + 1)
    return (
        law.cubic(u, params[at], params[at + 1] * share, params[at + 4], params[at + 5] * next_share),
        law.cubic(u, params[at + 2], params[at + 3] * share, params[at + 6], params[at + 7] * next_share),
    )


def fill_nodes(rows: Floats) -> None:
    """Fill in the nodes of all rows."""
    for i in range(rows.shape[0]):
        if rows[i, COUNT] > 0.0:
            law.fill_nodes_of(rows[i])


def fill_nodes_of(params: Floats) -> None:
    """Fill in the nodes of one row, each from the one before."""
    law.fill_first_node(params)
    foot, at = params[LAST], law.first_node
    m, slope = law.zone_at(foot, params)
    params[at + 2], params[at + 3] = m, slope * params[at + 1]
    y = 1.0
    for node in range(1, (law.octaves << law.split) + 1):
        before, last = y, law.first_node + 4 * (node - 1)
        y = math.ldexp(1.0 + math.ldexp(float(node & ((1 << law.split) - 1)), -law.split), node >> law.split)
        x, dx = law.x_of_y(y, params)
        interval = math.log(y / before)
        way, step = params[last] - foot, params[last + 1] * interval
        power = step / way if way > 0.0 else 0.0
        s = params[last] + step * (1.0 + power * (0.5 + power / 6.0))
        grown = params[last + 3] / params[last + 2] * interval
        found, s, m, s_slope, m_slope = law.both_edges(x, s, params[last + 2] * math.exp(grown), params)
        if not found:
            start = 2.0 * params[last] - foot if params[last] > foot else max(2.0 * foot, 1e-3)
            s = law.solve_on_branch(x * params[DEPTH], start, foot, math.inf, int(params[COUNT]) - 1, params)
            m, per_s = law.zone_at(s, params)
            s_slope = params[DEPTH] / law.control_at(s, params)[1]
            m_slope = per_s * s_slope
        at = law.first_node + 4 * node
        params[at], params[at + 1], params[at + 2], params[at + 3] = s, s_slope * dx, m, m_slope * dx


def zone_at(s: float, params: Floats) -> tuple[float, float]:
    """m at s, and its derivative by s along the equilibria."""
    if s <= 1.0:
        return s * params[JUNCTION], params[JUNCTION]
    m = law.zone_edge(s, params)[2]
    _, _, s_slope, m_slope = law.newton_of_both(s, m, 0.0, params)
    return m, m_slope / s_slope


def guess_anywhere(x: float, params: Floats) -> float:
    """s at x >= that of the foot."""
    s, _ = law.guess_both(x, params)
    return s


def edges_at(x: float, branch: float, params: Floats) -> tuple[bool, float, float]:
    """Whether s and m at x on a branch are found together; then both."""
    if branch < params[COUNT] or x <= params[LAST_X]:
        return False, 0.0, 0.0
    s, m = law.guess_both(x, params)
    found, s, m, _, _ = law.both_edges(x, s, m, params)
    return found, s, m


def state_on_branch(x: float, branch: float, params: Floats) -> float:
    """s at x on branch number ``branch`` = 1, 2, ..."""
    found, s, _ = law.edges_at(x, branch, params)
    return s if found else law.state_by_search(x, branch, params)


def contact_at(x: float, branch: float, params: Floats) -> tuple[float, float, float, float]:
    """s, a over width, P over 2 E* width rise and k over 2 E* width at x on a branch."""
    found, s, m = law.edges_at(x, branch, params)
    if not found or s <= 1.0:
        s = s if found else law.state_by_search(x, branch, params)
        a, push, k = law.radius_force_stiffness(s, params)
        return s, a, push, k
    t, a, g, da, dg = law.contact_edge(s, params)
    a, _, rise, push, growth = law.state_between((t, a, m, _atan(m / a), g, da, dg), params)
    return s, a, push, growth / rise

"""The edges of the contact and of its zone found together, by Newton's method on two equations under fixed grips:

    g(a) - beta m = delta,   J + beta (m theta - c + a) = pi/2 w/sigma0,

with the derivatives of the second by a and m

    a B/c^2 - theta g',   m B/c^2 + beta theta,

so that one evaluation of J and K is a step of both. Notation of ``equilibrium``; the state is s, and with it m.
"""

import math

from roughmdr.kernels.profile.interface import kernel
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
from roughmdr.numerics.vector_math import atan

_atan = compiled(atan, small=True)

_RTOL_STEP = 3e-8  # last step over the distance to the foot, and of m: the next error, its square, is below rounding
_ROUNDINGS = 4e-16  # step of m, over m, that is always the last
_MAX_STEPS = 12
_MIN_SHARE = 1e-2  # share of the distance to the foot, and of m, that is left after a step that would go beyond 0
_MOST_GROWTH = 10.0  # largest factor of m in a step


def newton_of_both(s: float, m: float, wanted: float, params: Floats) -> tuple[float, float, float, float]:
    """The steps of s and m, and their derivatives by the indentation along the equilibria."""
    beta, size = params[STRENGTH], params[JUNCTION]
    if s <= 1.0:
        value, slope = kernel.indentation_at(s, params)
        step = (wanted - value) / slope
        return step, size * (s + step) - m, 1.0 / slope, size / slope
    t, a, g, da, dg = kernel.contact_edge(s, params)
    if kernel.end < math.inf and not m < kernel.widest_zone(a):
        return kernel.newton_at_end(s, m, wanted, params)
    theta, square = _atan(m / a), a * a + m * m
    j, k = kernel.gap_integrals(t, a, g, m, theta, params)
    short = m * m / (math.sqrt(square) + a)  # c - a
    firm = (k - beta * short) / square  # B/c^2
    off = g - beta * m - wanted
    open_ = j + beta * (m * theta - short) - 0.5 * math.pi * params[RANGE]
    by_s, by_m = da * a * firm - dg * theta, m * firm + beta * theta
    per = 1.0 / (firm * (dg * m + beta * a * da))
    return -(off * by_m + beta * open_) * per, (off * by_s - dg * open_) * per, by_m * per, -by_s * per


def newton_at_end(s: float, m: float, wanted: float, params: Floats) -> tuple[float, float, float, float]:
    """Do as ``newton_of_both`` where the zone stays at the end of the profile; NaN where it does not."""
    t, a, g, da, dg = kernel.contact_edge(s, params)
    widest = kernel.widest_zone(a)
    if kernel.gap_at(t, a, g, widest, params)[0] > 0.5 * math.pi * params[RANGE]:
        return math.nan, math.nan, math.nan, math.nan
    m_by_s = -a * da / widest
    slope = dg - params[STRENGTH] * m_by_s
    step = (wanted - g + params[STRENGTH] * widest) / slope
    return step, widest + step * m_by_s - m, 1.0 / slope, m_by_s / slope


def room(s: float, m: float, params: Floats) -> float:
    """m, or its distance to the end of the profile where that is shorter: next to the end the gap goes as a root."""
    if kernel.end < math.inf and s > 1.0:
        way = kernel.widest_zone(kernel.contact_edge(s, params)[1]) - m
        return min(m, way) if way > 0.0 else m
    return m


def both_edges(x: float, s: float, m: float, params: Floats) -> tuple[bool, float, float, float, float]:
    """Whether Newton's method from s and m converges on the last branch; then s, m, ds/dx and dm/dx at x."""
    foot, wanted = params[LAST], (x - 1.0) * params[DEPTH]
    for _ in range(_MAX_STEPS if params[CONTROL] == 0.0 else 0):
        ds, dm, s_slope, m_slope = kernel.newton_of_both(s, m, wanted, params)
        beyond = s - foot
        if not (abs(ds) < math.inf and abs(dm) < math.inf):
            break
        if abs(ds) <= _RTOL_STEP * beyond and abs(dm) <= _RTOL_STEP * kernel.room(s, m, params) + _ROUNDINGS * m:
            far = s + ds > foot + params[NEAR] * s and (foot > 0.0 or x > params[LAST_X] + CANCELLED)
            return far, s + ds, m + dm, s_slope * params[DEPTH], m_slope * params[DEPTH]
        s = max(s + ds, foot + _MIN_SHARE * beyond)
        m = min(max(m + dm, _MIN_SHARE * m), _MOST_GROWTH * m)
    return False, s, m, 0.0, 0.0


def edges_at(x: float, branch: float, params: Floats) -> tuple[bool, float, float]:
    """Whether Newton's method on both edges finds s and m at x on a branch; then both."""
    if branch < params[COUNT] or x <= params[LAST_X]:
        return False, 0.0, 0.0
    s, m = kernel.guess_both(x, params)
    found, s, m, _, _ = kernel.both_edges(x, s, m if m > 0.0 else params[JUNCTION], params)
    return found, s, m


def state_on_branch(x: float, branch: float, params: Floats) -> float:
    """s at x on branch number ``branch`` = 1, 2, ..."""
    found, s, _ = kernel.edges_at(x, branch, params)
    return s if found else kernel.state_by_search(x, branch, params)


def contact_at(x: float, branch: float, params: Floats) -> tuple[float, float, float, float]:
    """s, a over width, P over 2 E* width rise and k over 2 E* width at x on a branch."""
    found, s, m = kernel.edges_at(x, branch, params)
    if not found or s <= 1.0:
        s = s if found else kernel.state_by_search(x, branch, params)
        a, push, k = kernel.radius_force_stiffness(s, params)
        return s, a, push, k
    t, a, g, da, dg = kernel.contact_edge(s, params)
    m = min(m, kernel.widest_zone(a))
    a, _, rise, push, growth = kernel.state_between((t, a, m, _atan(m / a), g, da, dg), params)
    return s, a, push, growth / rise

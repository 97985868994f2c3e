"""The edges of contact and cohesive zone, for any profile, along all equilibria. Notation of ``equilibrium``."""

import math

import numpy as np

from roughmdr.kernels.profile.interface import kernel
from roughmdr.kernels.profile.layout import COUNT, JUNCTION, RANGE, STRENGTH, TENSION, UNIT
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.jit import compiled
from roughmdr.numerics.vector_math import atan

_atan = compiled(atan, small=True)

_RTOL_STEP = 1e-9  # last step over m: the error left, its square, is below rounding
_WIDE = 0.5 * math.pi - 1.0  # m theta - c + a over m where a is small
_LEAST_SHARE = 1e-2  # least share of m that is left after a step
_NEXT_TO_AXIS = 0.3  # largest a next to the axis, over the cohesive radius where contact begins
_ROUNDING = 1e-15
_MAX_ITERATIONS = 100
_LARGEST = 1e150  # largest number whose square, and that of its inverse, is a float


def find_junction(params: Floats) -> bool:
    """Find c where contact begins: f(c) + (1 - 2/pi) beta c = w/sigma0. False where the body ends before, or floats do
    not hold its square.
    """
    wanted, per_c = params[RANGE], (1.0 - 2.0 / math.pi) * params[STRENGTH]
    low, high = 0.0, min(wanted / per_c, kernel.end)
    if not (high > 0.0 and kernel.f_and_slope(high, params)[0] + per_c * high >= wanted * (1.0 - _ROUNDING)):
        return False
    c = high if high < kernel.end else 0.5 * high
    for _ in range(_MAX_ITERATIONS):
        f, slope = kernel.f_and_slope(c, params)
        value = f + per_c * c
        low, high = (c, high) if value < wanted else (low, c)
        better = c * math.exp((math.log(wanted) - math.log(value)) * value / (c * (slope + per_c)))
        if abs(better - c) <= _RTOL_STEP * c:
            c = better
            break
        c = better if low < better < high else 0.5 * (low + high)
    params[JUNCTION] = c
    t = params[TENSION] if kernel.flat else kernel.t_of_radius(c, 1.0, params)
    params[UNIT] = t
    return 1.0 / _LARGEST < c < _LARGEST and 0.0 < t < math.inf


def gap_at(t: float, a: float, g: float, m: float, params: Floats) -> tuple[float, float]:
    """pi/2 times the gap at c, and its derivative by m^2/2."""
    c, theta = math.sqrt(a * a + m * m), _atan(m / a)
    j, k = kernel.gap_integrals(t, a, g, m, theta, params)
    short = m * m / (c + a)
    return j + params[STRENGTH] * (m * theta - short), (k / c + params[STRENGTH] * (c * theta / m - short / c)) / c


def zone_guess(a: float, slope: float, params: Floats) -> float:
    """About m at the contact radius a with g' there, mostly within a tenth.

    By powers of m that hold where the zone is thin or wide: m theta - c + a is m^2/(2 a) or (pi/2 - 1) m, and J is
    g' m^3/(3 a^2). Next to the axis, and on a flat, J is about as where contact begins.
    """
    c0, wanted = params[JUNCTION], 0.5 * math.pi * params[RANGE]
    wide = wanted / params[STRENGTH] / _WIDE
    thin = 4.0 * _WIDE * a / wide
    flat = wide * math.sqrt(0.5 + 0.5 * math.sqrt(1.0 + thin * thin))
    if a < _NEXT_TO_AXIS * c0 or slope == 0.0:
        return min(c0, flat)
    risen = float(np.cbrt(3.0 * wanted * a * (a / slope)))
    ratio = min(flat, risen) / max(flat, risen)
    return min(flat, risen) / math.sqrt(1.0 + ratio * ratio)


def zone_width(t: float, a: float, g: float, slope: float, near: float, params: Floats) -> float:
    """m = sqrt(c^2 - a^2) at the contact radius a at t, with g and g' there: by Newton's method on about the logarithm
    of the gap, then by the cubic through the last two points of the inverse function with its slopes. It begins at
    ``near`` unless that is 0.

    Where the gap at the end of the profile is below w/sigma0, the zone stays there.
    """
    wanted, widest = 0.5 * math.pi * params[RANGE], kernel.widest_zone(a)
    low, high, m = 0.0, math.inf, min(near if near > 0.0 else kernel.zone_guess(a, slope, params), 0.5 * widest)
    m_before, off_before, rate_before = 0.0, 0.0, 0.0
    for _ in range(_MAX_ITERATIONS):
        value, growth = kernel.gap_at(t, a, g, m, params)
        if not 0.0 < value < math.inf:  # c and a are the same float, near the end of the profile
            low, high = (m, min(high, widest)) if value <= 0.0 else (low, m)
            m, m_before = 0.5 * (low + high), 0.0
            continue
        low, high = (m, high) if value < wanted else (low, m)
        both = wanted + value
        off, rate = 2.0 * (wanted - value) / both, both / wanted * (both / (4.0 * m * growth))
        way = off * rate
        if m_before > 0.0 and off != off_before:
            across = off - off_before
            mean = (m_before - m) / across
            bend, turn = (3.0 * mean - 2.0 * rate - rate_before) / across, (rate + rate_before - 2.0 * mean) / across
            way += off * off * (bend + off * turn / across)
        better = min(max(m + way, _LEAST_SHARE * m), m / _LEAST_SHARE)
        if kernel.end < math.inf and better >= widest and high == math.inf:
            if not kernel.gap_at(t, a, g, widest, params)[0] > wanted:
                return widest
            high = widest
        if abs(off) <= _RTOL_STEP or not low < high:
            return better
        m_before, off_before, rate_before = m, off, rate
        m = better if low < better < high else (0.5 * (low + high) if high < math.inf else 2.0 * m)
    return m


def contact_edge(s: float, params: Floats) -> tuple[float, float, float, float, float]:
    """For s > 1: t, a, g, da/ds and dg/ds. On a flat tip, s <= 2, t is 0.

    At its edge, s = 2, they are those from within: beyond, a and g may begin with a slope of 0.
    """
    if kernel.flat and s <= 2.0:
        return 0.0, s - 1.0, 0.0, 1.0, 0.0
    t = (s - (2.0 if kernel.flat else 1.0)) * params[UNIT]
    a, da, g, dg = kernel.mdr_profile(t, params)
    return t, a, g, da * params[UNIT], dg * params[UNIT]


def zone_edge(s: float, params: Floats) -> tuple[float, float, float, float, float, float, float]:
    """For s > 1: t, a, m = sqrt(c^2 - a^2), theta, g, da/ds and dg/ds."""
    return kernel.zone_edge_near(s, 0.0, params)


def zone_edge_near(s: float, near: float, params: Floats) -> tuple[float, float, float, float, float, float, float]:
    """Do as ``zone_edge``, with ``near`` as a first guess of m; 0 for none."""
    t, a, g, da, dg = kernel.contact_edge(s, params)
    m = kernel.zone_width(t, a, g, dg / da if da > 0.0 else math.inf, near, params)
    return t, a, m, _atan(m / a), g, da, dg


def state_of_radius(radius: float, width: float, params: Floats) -> float:
    """s at a contact radius [m]."""
    if params[COUNT] == 0.0:
        return math.nan
    return kernel.t_of_radius(radius, width, params) / params[UNIT] + (2.0 if kernel.flat else 1.0)

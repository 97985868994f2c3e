"""The cohesive zone of any profile, a < x < c: in closed form where the profile has one, else by quadrature.

Its integrals, in units of the shape's width and rise:

    J = ∫ (g(x) - g(a))/sqrt(c^2 - x^2) dx,   K = ∫ x g'(x)/sqrt(c^2 - x^2) dx,
    L = ∫ (g(x) - g(a)) sqrt(c^2 - x^2) dx.

Where c is at the end of the profile, which is upright there, K is infinite.
Beyond each breakpoint y of the profile, g is smooth in q = sqrt(x^2 - y^2) = sqrt(c^2 - y^2) cos(psi), and
dx/sqrt(c^2 - x^2) is q/x dpsi. Where the zone is thin g(x) - g(a) has few digits; by parts, with A = acos(x/c),

    J = ∫ g'(x) A dx,   L = ∫ g'(x) [c^2 A - x sqrt(c^2 - x^2)]/2 dx.
"""

import math

from roughmdr.kernels.profile.interface import kernel
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.gauss import unit_gauss

# Nodes of Gauss from 0 to 1, packed towards both ends, where g may be no more than a root or a logarithm.
_Z, _WEIGHT = unit_gauss(40)
_NODES = _Z**3 * (10.0 - 15.0 * _Z + 6.0 * _Z**2)
_PANEL_RATIO = 8.0  # largest ratio of the ends of a panel
_THIN = 0.01  # m/a: in a thinner zone g(x) - g(a) has too few digits
_STEEP = 6.0  # psi times sqrt(n) from which on (x/c)^n is below rounding
_NEAREST = 1e-8  # distance to the end of the profile, over it; its square is below rounding
_BEFORE = 1.0 - 2.0**-53  # largest radius over the end of the profile: up to there g is finite
_UNBOUNDED = 1e100  # stands for infinity
_FEW_NODES, _FEW_WEIGHTS = unit_gauss(8)
_FEW_DIGITS = 1e-6  # difference from g(a) theta, over it, below which it has fewer than ten digits
_WEIGHTS = 30.0 * _Z**2 * (1.0 - _Z) ** 2 * _WEIGHT
_PIECE_NODES, _PIECE_WEIGHTS = unit_gauss(12)  # for a piece of a table, on which g is a polynomial in q


def widest_zone(a: float) -> float:
    """m where the zone comes to the end of the profile."""
    return max(math.sqrt((kernel.end - a) * (kernel.end + a)), _NEAREST) if kernel.end < math.inf else math.inf


def t_along(q: float, base: float, params: Floats) -> float:
    """t where q = sqrt(x^2 - base^2)."""
    if kernel.has_t_of_q and base > 0.0:
        return kernel.t_of_q(q, params)
    return kernel.t_of_radius(min(math.sqrt(base * base + q * q), _BEFORE * kernel.end), 1.0, params)


def zone_panel(
    panel: tuple[float, float, float, bool], g: float, c: float, m: float, thin: bool, params: Floats
) -> tuple[float, float, float]:
    """The integrals over a panel: low, high <= c, the base from which on g is smooth, whether it is a piece of a table.

    m = sqrt(c^2 - low^2). By parts where ``thin``.
    """
    low, high, base, piece = panel
    nodes, weights = (_PIECE_NODES, _PIECE_WEIGHTS) if piece else (_NODES, _WEIGHTS)
    reach = math.sqrt((c - base) * (c + base))
    begin = math.atan2(m, math.sqrt((low - base) * (low + base)))
    end = math.atan2(math.sqrt((c - high) * (c + high)), math.sqrt((high - base) * (high + base)))
    j, k, l = 0.0, 0.0, 0.0
    for i in range(nodes.size):
        psi = end + (begin - end) * nodes[i]
        q, below = reach * math.cos(psi), reach * math.sin(psi)
        x = math.sqrt(base * base + q * q)
        _, da, value, dg = kernel.mdr_profile(kernel.t_along(q, base, params), params)
        push = weights[i] * q * dg / da
        k += push
        if thin:
            angle = math.atan2(below, x)
            j += push * angle * below / x
            l += 0.5 * push * (c * c * angle - x * below) * below / x
        else:
            term = weights[i] * (value - g) * q / x
            j += term
            l += term * below * below
    return (begin - end) * j, (begin - end) * k, (begin - end) * l


def rise_begins(low: float, c: float, params: Floats) -> float:
    """The x below which the profile is flat to all digits, where it rises like x^n with a large n; else ``low``."""
    a, da, g, dg = kernel.mdr_profile(kernel.t_of_radius(c, 1.0, params), params)
    n = a * dg / (da * g) if 0.0 < g < math.inf else 0.0
    return max(low, c * math.cos(_STEEP / math.sqrt(n))) if n > _STEEP else low


def zone_quadrature(a: float, g: float, m: float, params: Floats) -> tuple[float, float, float]:
    """J, K and L for the contact radius a, g = g(a) and m = sqrt(c^2 - a^2)."""
    c, thin = math.sqrt(a * a + m * m), m < _THIN * a
    j, k, l = 0.0, 0.0, 0.0
    low, base, beside = a, 0.0, m
    count = kernel.breakpoint_count(params)
    for i in range(count + 1):
        begin, after = kernel.breakpoint(i, params) if i < count else (math.inf, 0.0)
        piece = kernel.of_pieces and i < count
        if begin > low:
            high = min(begin, c)
            while base > 0.0 and _PANEL_RATIO * low < high:  # panels on which g is equally smooth
                parts = kernel.zone_panel((low, _PANEL_RATIO * low, base, piece), g, c, beside, thin, params)
                j, k, l = j + parts[0], k + parts[1], l + parts[2]
                low = _PANEL_RATIO * low
                beside = math.sqrt((c - low) * (c + low))
            if base == 0.0 and not kernel.flat and high == c:
                middle = kernel.rise_begins(low, c, params)
                if middle > low:
                    parts = kernel.zone_panel((low, middle, base, piece), g, c, beside, thin, params)
                    j, k, l = j + parts[0], k + parts[1], l + parts[2]
                    low, beside = middle, math.sqrt((c - middle) * (c + middle))
            if beside > 0.0 and (base > 0.0 or not kernel.flat):
                parts = kernel.zone_panel((low, high, base, piece), g, c, beside, thin, params)
                j, k, l = j + parts[0], k + parts[1], l + parts[2]
            if begin >= c:
                break
            low, beside = begin, math.sqrt((c - begin) * (c + begin))
        base = after
    return j, k if m < kernel.widest_zone(a) else _UNBOUNDED, l


def gap_integrals(t: float, a: float, g: float, m: float, theta: float, params: Floats) -> tuple[float, float]:
    """J and K for the contact radius a at t, g = g(a), m = sqrt(c^2 - a^2) and theta = atan(m/a)."""
    j, k, _ = kernel.zone_quadrature(a, g, m, params)
    return j, k


def gap_integrals_closed(t: float, a: float, g: float, m: float, theta: float, params: Floats) -> tuple[float, float]:
    """J and K where the profile has closed forms: J = I - g(a) theta unless this cancels, as the zone is thin."""
    i, k = kernel.zone_integrals(t, a, m, theta, params)
    j = i - g * theta
    if j < _FEW_DIGITS * g * theta:
        j = kernel.thin_integral(a, g, m, params)
    return j, min(k, _UNBOUNDED) if m < kernel.widest_zone(a) else _UNBOUNDED


def thin_integral(a: float, g: float, m: float, params: Floats) -> float:
    """J of a thin zone by parts, by a rule of few nodes unless there is a breakpoint within."""
    base, c = 0.0, math.sqrt(a * a + m * m)
    for i in range(kernel.breakpoint_count(params)):
        begin, after = kernel.breakpoint(i, params)
        if a < begin < c:
            return kernel.zone_quadrature(a, g, m, params)[0]
        base = after if begin <= a else base
    reach, total = math.sqrt((c - base) * (c + base)), 0.0
    widest = math.atan2(m, math.sqrt((a - base) * (a + base)))
    for i in range(_FEW_NODES.size):
        psi = widest * _FEW_NODES[i]
        q, below = reach * math.cos(psi), reach * math.sin(psi)
        x = math.sqrt(base * base + q * q)
        _, da, _, dg = kernel.mdr_profile(kernel.t_along(q, base, params), params)
        total += _FEW_WEIGHTS[i] * dg / da * math.atan2(below, x) * q * below / x
    return widest * total


def energy_integral(a: float, g: float, m: float, theta: float, params: Floats) -> float:
    """L for the contact radius a, g = g(a), m = sqrt(c^2 - a^2) and theta = atan(m/a)."""
    _, _, l = kernel.zone_quadrature(a, g, m, params)
    return l

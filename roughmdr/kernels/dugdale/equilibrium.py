"""One asperity under adhesion with a range: within the cohesive radius c > a the surfaces attract each other with the
strength sigma0, until the gap is w/sigma0 (D. Maugis, J. Colloid Interface Sci. 150 (1992) 243, for the sphere).

With m = sqrt(c^2 - a^2), theta = atan(m/a) and the integrals of ``zone``, in units of the shape's width and rise and
beta = 2 sigma0/E*, any profile has (from delta = g(a) - beta m and f(c) = 2/pi ∫_0^c g/sqrt(c^2 - x^2) dx)

    gap(c) = 2/pi [J + beta (m theta - c + a)] = w/sigma0,
    P/(2 E*) = a g - G - beta/2 (a m + c^2 theta),
    d(delta) = (g' + beta a/m) da B/D,   c dc = theta (g' + beta a/m) da c^2/D,
    B = K - beta (c - a),   D = B + beta theta c^2/m,

so that a state is stable under fixed grips where B > 0, and k/(2 E*) = a - beta theta^2 c^2/B. Where the zone reaches
the end of the profile, as on a flat punch, c stays there; then the gap is at most w/sigma0, and B is infinite.

The state s goes along all equilibria. For s <= 1 there is no contact yet, a = 0 and c grows with s; for s > 1 the
contact radius a grows with s, on a flat tip as a = s - 1 up to s = 2. Notation of ``layout``.
"""

import math

from roughmdr.kernels.profile.interface import kernel
from roughmdr.kernels.profile.layout import CONTROL, COUNT, DEPTH, JUNCTION, RANGE, STRENGTH, TENSION
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.double_double import ROUNDING

_ZONE_ERROR = 1e-12  # relative error of the force, as tested
_ZONE_ROUNDINGS = 32.0  # roundings of the indentation by the zone, over the part that it adds


def state_along(s: float, params: Floats) -> tuple[float, float, float, float, float]:
    """a/width, delta/rise and its derivative by s, P/(2 E* width rise) and its derivative by s."""
    beta = params[STRENGTH]
    if s <= 1.0:
        size = params[JUNCTION]
        c = s * size
        f, slope = kernel.f_and_slope(c, params)
        delta = f - 2.0 / math.pi * beta * c - params[RANGE]
        rise = size * (slope - 2.0 / math.pi * beta)
        return 0.0, delta, rise, -0.25 * math.pi * beta * c * c, -0.5 * math.pi * beta * c * size
    return kernel.state_between(kernel.zone_edge(s, params), params)


def state_between(edges: tuple[float, ...], params: Floats) -> tuple[float, float, float, float, float]:
    """Do as ``state_along``, given both edges, s > 1, from ``zone_edge``."""
    beta = params[STRENGTH]
    t, a, m, theta, g, da, dg = edges
    _, k = kernel.gap_integrals(t, a, g, m, theta, params)
    square = a * a + m * m
    firm = k - beta * m * m / (math.sqrt(square) + a)  # B
    rise = (dg * m + beta * a * da) / (firm * m + beta * square * theta)
    push = kernel.reduced_load(t, params) - 0.5 * beta * (a * m + square * theta)
    return a, g - beta * m, rise * firm, push, rise * (a * firm - beta * theta * theta * square)


def indentation_at(s: float, params: Floats) -> tuple[float, float]:
    """The indentation at s, and its derivative by s."""
    _, delta, rise, _, _ = kernel.state_along(s, params)
    return delta, rise


def control_at(s: float, params: Floats) -> tuple[float, float]:
    """The controlled quantity, indentation or force, and its derivative by s."""
    _, delta, rise, push, growth = kernel.state_along(s, params)
    return (delta, rise) if params[CONTROL] == 0.0 else (push, growth)


def reduced_control(s: float, params: Floats) -> float:
    """x: the controlled quantity above the lowest foot over DEPTH."""
    return (kernel.control_at(s, params)[0] + params[DEPTH]) / params[DEPTH]


def radius_force_stiffness(s: float, params: Floats) -> tuple[float, float, float]:
    """a over width, P over 2 E* width rise, and k over 2 E* width: a - beta theta^2 c^2/B."""
    a, _, rise, push, growth = kernel.state_along(s, params)
    return a, push, growth / rise


def radius(s: float, params: Floats) -> float:
    """a over width."""
    return kernel.zone_edge(s, params)[1] if s > 1.0 else 0.0


def cohesive_radius(s: float, params: Floats) -> float:
    """c over width."""
    if s <= 1.0:
        return s * params[JUNCTION]
    _, a, m, _, _, _, _ = kernel.zone_edge(s, params)
    return math.sqrt(a * a + m * m)


def force(s: float, params: Floats) -> float:
    """P over 2 E* width rise."""
    return kernel.radius_force_stiffness(s, params)[1]


def stiffness(s: float, params: Floats) -> float:
    """k over 2 E* width, infinite at a smooth fold."""
    return kernel.radius_force_stiffness(s, params)[2]


def edges_at_radius(radius: float, width: float, params: Floats) -> tuple[float, ...]:
    """Both edges at a contact radius [m], as ``zone_edge`` returns them, but for a scale of s: that has no digits left
    of a contact that is far smaller than its zone. NaN where there are no equilibria.
    """
    if params[COUNT] == 0.0:
        return math.nan, math.nan, math.nan, math.nan, math.nan, math.nan, math.nan
    t = kernel.t_of_radius(radius, width, params)
    a, da, g, dg = kernel.mdr_profile(t, params)
    if kernel.flat and t <= 0.0:
        t, a, g, da, dg = kernel.contact_edge(2.0, params)
    m = kernel.zone_width(t, a, g, dg / da if da > 0.0 else math.inf, 0.0, params)
    return t, a, m, math.atan2(m, a), g, da, dg


def equilibrium_at_radius(radius: float, width: float, params: Floats) -> tuple[float, float, float]:
    """delta/rise, P/(2 E* width rise) and k/(2 E* width) at a contact radius [m]."""
    _, delta, rise, push, growth = kernel.state_between(kernel.edges_at_radius(radius, width, params), params)
    return delta, push, growth / rise


def cohesive_at_radius(radius: float, width: float, params: Floats) -> float:
    """c/width at a contact radius [m]."""
    edges = kernel.edges_at_radius(radius, width, params)
    return math.hypot(edges[1], edges[2])


def adhesion_terms(a: float, params: Floats) -> tuple[float, float]:
    """Upper bounds of beta m over rise, and of beta/2 (a m + c^2 theta) over width rise.

    The gap at c is at most w/sigma0, so that beta (m theta - c + a) <= pi/2 RANGE; and the bracket is at least
    2/pi (pi/2 - 1) theta m, theta >= pi/4 min(m/a, 1).
    """
    stretch = 1.33 * params[TENSION] * math.sqrt(a) + 5.5 * params[RANGE]
    return stretch, stretch * (a + 0.25 * math.pi * stretch / params[STRENGTH])


def relative_errors(params: Floats) -> tuple[float, float]:
    """The error of the force, as tested, and of the indentation, from the roundings of the profile and of the zone.

    On a flat m^2 = c^2 - a^2 has the roundings of a and c, where m is sqrt(2 RANGE) or more next to the edge, and
    about sqrt(pi RANGE/beta) at pull-off.
    """
    roundings = kernel.roundings(params) + _ZONE_ROUNDINGS
    if kernel.flat:
        roundings += math.sqrt(params[STRENGTH] / (2.0 * math.pi)) / params[RANGE]
    error = ROUNDING * roundings
    return max(_ZONE_ERROR, error), error


def energy(s: float, params: Floats) -> float:
    """U, elastic and of both surfaces, over 2 E* width rise^2 DEPTH; 0 where the surfaces do not attract each other.

    E* ∫ u1^2 dx - pi w c^2 + sigma0 ∫ gap dA, where u1(x) is the displacement of the spring at x (up to c), and the
    last integral is 4 ∫_a^c (g - delta + u1) sqrt(c^2 - x^2) dx.
    """
    beta, t, a, m, theta, g = params[STRENGTH], 0.0, 0.0, s * params[JUNCTION], 0.5 * math.pi, 0.0
    if s == 0.0:
        return 0.0
    if s > 1.0:
        t, a, m, theta, g, _, _ = kernel.zone_edge(s, params)
    stretch = beta * m if s > 1.0 else -kernel.indentation_at(s, params)[0]
    square = a * a + m * m
    c = math.sqrt(square)
    bent, push = (kernel.elastic_integral(t, params), kernel.reduced_load(t, params)) if s > 1.0 else (0.0, 0.0)
    l = kernel.energy_integral(a, g, m, theta, params)
    short = m * m / (c + a)
    elastic = bent - 2.0 * stretch * push + stretch * stretch * a
    cohesive = 2.0 * l + stretch * (square * theta - a * m) - beta * short * short * (2.0 * c + a) / 3.0
    surface = 0.5 * math.pi * params[RANGE] * square
    return (elastic + beta * (cohesive - surface)) / (2.0 * params[DEPTH])


def kink(low: float, high: float, params: Floats) -> bool:
    """Whether the indentation may not be smooth from low to high."""
    return True


def kink_between(low: float, high: float, params: Floats) -> bool:
    """Whether contact begins, s = 1, from low to high: with a paraboloid there is no other kink."""
    return low < 1.0 < high

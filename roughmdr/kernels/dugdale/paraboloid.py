"""One paraboloid under adhesion with a range, whose equilibria have a closed form. Notation of ``equilibrium``.

With f = r^2 and g = 2 x^2 (width R, rise R/2), sigma = a/m = s - 1 and e = 1 + sigma^2 = c^2/m^2, the gap is

    2/pi [spread c^2 + pull c],   spread = (sigma + theta (1 - sigma^2))/e,
    pull = beta (theta - 1/(sqrt e + sigma))/sqrt e,

so that c follows from a quadratic equation (D. Maugis, J. Colloid Interface Sci. 150 (1992) 243).
"""

import math

from roughmdr.kernels.profile.interface import kernel
from roughmdr.kernels.profile.layout import COUNT, RANGE, STRENGTH
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.jit import compiled
from roughmdr.numerics.vector_math import q_minus_atan

_q_minus_atan = compiled(q_minus_atan, small=True)


def zone_edge(s: float, params: Floats) -> tuple[float, float, float, float, float, float, float]:
    """For s > 1: t = a, a, m, theta, g, and da/ds and dg/ds."""
    beta, wanted = params[STRENGTH], math.pi * params[RANGE]
    sigma = s - 1.0
    e = 1.0 + sigma * sigma
    root, q = math.sqrt(e), 1.0 / sigma
    beyond = _q_minus_atan(q)
    theta = q - beyond
    spread = (theta + sigma * sigma * beyond) / e
    pull = beta * (theta - 1.0 / (root + sigma)) / root
    turned = math.sqrt(pull * pull + 2.0 * spread * wanted)
    c = wanted / (pull + turned)
    m = c / root
    a = sigma * m
    growth = m / e * (theta * sigma * sigma / root * (4.0 * m + beta) / turned + 1.0)
    return a, a, m, theta, 2.0 * a * a, growth, 4.0 * a * growth


def zone_edge_near(s: float, near: float, params: Floats) -> tuple[float, float, float, float, float, float, float]:
    """Do as ``zone_edge``, which needs no first guess."""
    return kernel.zone_edge(s, params)


def gap_integrals(t: float, a: float, g: float, m: float, theta: float, params: Floats) -> tuple[float, float]:
    """J and K of ``zone``."""
    beyond = _q_minus_atan(m / a) if a > 0.0 else 0.0
    return m * m * theta + a * a * beyond, 2.0 * ((a * a + m * m) * theta + a * m)


def energy_integral(a: float, g: float, m: float, theta: float, params: Floats) -> float:
    """L of ``zone``."""
    square = a * a + m * m
    return 0.25 * (square * square * theta - a * m * (2.0 * a * a - square)) - a * a * (square * theta - a * m)


def state_of_radius(radius: float, width: float, params: Floats) -> float:
    """s at a contact radius [m]."""
    if params[COUNT] == 0.0:
        return math.nan
    a = radius / width
    return 1.0 + a / kernel.zone_width(a, a, 2.0 * a * a, 4.0 * a, 0.0, params)

"""A tip that ends at an edge, a flat or a cap, on a surface that is tilted and curved: how far the edge lets it slide.

The contact is a disc of radius a about a centre that has slid to c. At a load P it takes the place of the least
indentation P/(2 E* a) + 2/3 k a^2 - c tilt + k c^2, where k r^2 is the gap of tip and surface alone, but the edge at b
holds it: c <= (b^2 - a^2)/b. So the edge is in contact all around from P = 2 E* b^2 (2 tilt + 4/3 k b) on, which is
exact for a disc (its pressure there is that of a tilted punch), and below, on a flat, P = 4 E* tilt a^3/b. The force of
a tilted flat-ended punch of radius b is then at most 0.09 E* tilt b^2 too large
(``tests/interaction/test_tip_edge.py``).

The radius of the edge is 1 here, P is over 2 E* and a natural depth.
"""

import math

from roughmdr.interaction.interface import Tipped, kernel
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.jit import njit

_RTOL, _MAX_ITERATIONS = 1e-15, 60

Held = tuple[float, float, float]
"""The radius, the centre and the indentation of a contact."""


@njit
def whole_edge(tilt: float, k: float) -> float:
    """Return the load from which on the edge is in contact all around."""
    return 2.0 * tilt + 4.0 / 3.0 * k


@njit
def level(load: float, k: float) -> tuple[float, float]:
    """Return radius and indentation on a surface without a tilt."""
    a = 1.0 if load >= 4.0 / 3.0 * k else math.pow(0.75 * load / k, 1.0 / 3.0)
    return a, (load / a if load > 0.0 else 0.0) + 2.0 / 3.0 * k * a * a


@njit
def held(load: float, tilt: float, k: float) -> Held:
    """Return the contact under a load up to ``whole_edge``; tilt and k >= 0, not both 0.

    The load is a^3 (2 tilt - 8/3 k + 4 k a^2) where the edge holds the contact: convex from the least such a on, so
    that Newton's method comes down to it from a larger one.
    """
    if 0.5 * tilt < k:
        free = 1.0 - 0.5 * tilt / k
        if load <= 4.0 / 3.0 * k * free * math.sqrt(free):
            a, indentation = level(load, k)
            return a, 0.5 * tilt / k, indentation - 0.25 * tilt * tilt / k
    if load <= 0.0:
        return 0.0, 1.0, k - tilt
    first, third = 2.0 * tilt - 8.0 / 3.0 * k, 4.0 * k
    a = math.pow(load / first, 1.0 / 3.0) if load < first else 1.0
    for _ in range(_MAX_ITERATIONS):
        square = a * a
        step = (a * square * (first + third * square) - load) / (square * (3.0 * first + 5.0 * third * square))
        a -= step
        if abs(step) <= _RTOL * a:
            break
    c = 1.0 - a * a
    return a, c, load / a + 2.0 / 3.0 * k * a * a - c * (tilt - k * c)


def edge_curvature(ratio: float, params: Floats) -> float:
    """Return k, that of the cap and of a surface whose curvature adds ratio a^2 to g; not below 0."""
    cap = 0.0 if kernel.pinned or kernel.flat else kernel.terms(1.0, params)[2]
    return max(0.5 * (cap + ratio), 0.0)


def tipped(load: float, tilt: float, ratio: float, params: Floats) -> Tipped:
    """Return the contact under a load below ``whole_edge``, in natural units.

    It slides at least as far as on the flank under that load, without which the flank would hold it at once.
    """
    k, deeper, slide = kernel.edge_curvature(ratio, params), 0.0, 0.0
    if tilt > 0.0 and not kernel.pinned:
        t = kernel.loaded_state(whole_edge(tilt, k), 1.0, ratio, params)
        a, da, _, dg, _ = kernel.terms(t, params)
        deeper, slide = kernel.slid(t, a, dg / da + 2.0 * ratio * a, tilt, ratio, 1.0, 1.0, params)
    radius, centre, indentation = held(load, tilt, k)
    level_radius, level_indentation = level(load, k)
    narrower, turned = 0.0, 1.0
    if load > 0.0:
        share = radius / level_radius
        narrower, turned = 1.0 / radius - 1.0 / level_radius, 3.0 - 2.0 * share * share
    return max(level_indentation - indentation, deeper), max(centre, slide * tilt), narrower, turned

"""One adhesive contact that jumps, on a surface that stays as others have displaced it.

Its state is the next at which the edge is at rest. The energy is that of ``contacts``.
"""

import math
from typing import NamedTuple

from roughmdr.interaction.interface import Asperities, kernel
from roughmdr.numerics.arguments import Floats

_STRIDE, _LEAST_STATE, _MOST_STATE = 1.1, 1e-30, 1e30
_SET_OUT = 0.05  # relative first step from the state at the fold of the contact alone, which neighbours move
_BISECTIONS = 100
MOST_SLIDE = 2.0  # slide of a contact on a tilted surface, over its radius, beyond which there is no contact


class Surface(NamedTuple):
    """The surface that a contact touches."""

    depth: float
    """The indentation delta that it leaves to the contact, over the side of the patch."""
    curvature: float = 0.0
    """c."""
    tilt_square: float = 0.0


def edge(
    t: float, surface: Surface, work: float, size: float, rise: float, params: Floats
) -> tuple[float, float, bool]:
    """Return the force that widens the contact, -de/da, its load P/E*, and whether it slides too far.

    An edge under pressure widens always.
    """
    depth, c, square = surface
    a, _, g, _, first = kernel.terms(t, params)
    a, g, first = size * a, rise * g, size * rise * first
    shift, shift_by_a, _ = kernel.slide(t, size, rise, params) if square > 0.0 else (0.0, 0.0, 0.0)
    stretch = g + 2.0 * c * a * a - depth - 0.5 * shift * square
    p = 2.0 * (first + 4.0 / 3.0 * c * a**3 - a * stretch)
    turning = shift_by_a * (p - 2.0 * first) + 4.0 * a * a * kernel.held(t)
    opening = stretch * stretch if stretch > 0.0 else 0.0
    slides = shift * shift * square > (MOST_SLIDE * a) ** 2
    return 2.0 * math.pi * work * a - opening - 0.5 * square * turning, p, slides


def next_state(t: float, upwards: bool, surface: Surface, work: float, i: int, asperities: Asperities) -> float:
    """Return the next stable state of a contact from t on.

    0 where there is none below, so that it is lost; the state is found by bisection.
    """
    own, size, rise = kernel.params_of(asperities.params, i), asperities.size[i], asperities.depth[i]
    if kernel.pinned:
        return 1.0 if upwards else 0.0
    stride = _STRIDE if upwards else 1.0 / _STRIDE
    driven = False
    last = t = max(t * (1.0 + _SET_OUT if upwards else 1.0 - _SET_OUT), _LEAST_STATE)
    while _LEAST_STATE <= t <= _MOST_STATE:
        force, _, slides = kernel.edge(t, surface, work, size, rise, own)
        if slides and not upwards:
            break
        if slides or (force >= 0.0) == upwards:
            driven = not slides
        elif driven:
            for _ in range(_BISECTIONS):
                middle = 0.5 * (last + t)
                if (kernel.edge(middle, surface, work, size, rise, own)[0] >= 0.0) == upwards:
                    last = middle
                else:
                    t = middle
            return 0.5 * (last + t)
        last = t
        t *= stride
    return 0.0


def lone_load(t: float, surface: Surface, work: float, i: int, asperities: Asperities) -> float:
    """Return the load of a contact at a state, over pi E* L^2."""
    own, size, rise = kernel.params_of(asperities.params, i), asperities.size[i], asperities.depth[i]
    if kernel.pinned:
        return float(2.0 / math.pi * size * (surface.depth - 2.0 / 3.0 * surface.curvature * size * size))
    return float(kernel.edge(t, surface, work, size, rise, own)[1] / math.pi)

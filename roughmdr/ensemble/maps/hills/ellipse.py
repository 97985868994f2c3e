"""The best contact of a hill: of all ellipses of one stiffness, that under which the mean height is largest.

A contact region A carries S_A (<h>_A - D) under a flat punch at D, S_A its stiffness and <h>_A the mean of the heights
under the pressure of that punch, and the region that is in contact is the one which carries most (J. R. Barber, Int. J.
Solids Struct. 10 (1974) 813). An ellipse with the axes a e^q and a e^-q is as stiff as a circle of the radius
(pi/2) a e^q/K(1 - e^-4q); its pressure is proportional to 1/sqrt(1 - r^2), r from its centre over the half axis.
"""

import math

import numpy as np

from roughmdr.ensemble.maps.hills.territory import Territory, height, on_map
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.gauss import unit_gauss
from roughmdr.numerics.jit import njit

MAX_ELONGATION = 0.9
"""Largest q of an ellipse, half the logarithm of the ratio of its axes: a longer ridge is more than one contact."""
MAX_DRIFT = 0.2
"""Largest distance of the centre of a contact from the summit [wavelength]: farther away it belongs to another hill."""
_ANGLES = 12
_NODES, _WEIGHTS = unit_gauss(5)
_RINGS = np.sqrt((1.0 - _NODES) * (1.0 + _NODES))  # radii [1] of rings with equal shares of the load of a punch
_AREAS = 2.0 * _WEIGHTS * _NODES  # shares of the area that belong to the rings
_CUT = 1.0 - 1e-9, 0.125  # shares of the area on a map from which an ellipse is whole, and below which it is none
_SWEEPS = 2
_FIRST_STEPS = np.array([0.2, 0.2, 0.15, 0.15])

# Numbers that describe an ellipse of given stiffness: elongation times cosine and sine of twice the angle of its long
# axis, and the position of its centre over its radius.
PARAMETERS = 4


@njit
def complete_elliptic(k: float) -> float:
    """Return the complete elliptic integral K of the first kind for the complementary modulus k, 0 < k <= 1."""
    a, b = 1.0, k
    for _ in range(8):
        a, b = 0.5 * (a + b), math.sqrt(a * b)
    return 0.5 * math.pi / a


@njit
def mean_height(hill: Territory, radius: float, ellipse: Floats) -> float:
    """Return the mean height [m] under an elliptic punch as stiff as a circle of ``radius`` [wavelength].

    One that the border of a map cuts has the area of a whole one on the map; -inf where hardly any of it is there.
    """
    q = math.hypot(ellipse[0], ellipse[1])
    angle = 0.5 * math.atan2(ellipse[1], ellipse[0])
    stretch = math.exp(q)
    a = radius * math.sqrt(area_share(ellipse))
    long, short = a * stretch, a / stretch
    cosine, sine = math.cos(angle), math.sin(angle)
    total, carried = 0.0, 1.0
    for _ in range(3):  # larger each time by what the border cuts off
        total = carried = area = 0.0
        for i in range(_ANGLES):
            turn = 2.0 * math.pi * (i + 0.5) / _ANGLES
            along, across = long * math.cos(turn), short * math.sin(turn)
            x, y = cosine * along - sine * across, sine * along + cosine * across
            for k in range(_RINGS.size):
                at_x, at_y = radius * ellipse[2] + _RINGS[k] * x, radius * ellipse[3] + _RINGS[k] * y
                if on_map(hill, at_x, at_y):
                    total += _WEIGHTS[k] * height(hill, at_x, at_y)
                    carried += _WEIGHTS[k]
                    area += _AREAS[k]
        if area > _CUT[0] * _ANGLES:
            return total / _ANGLES
        if area < _CUT[1] * _ANGLES:
            return -math.inf
        larger = math.sqrt(_ANGLES / area * a * a / (long * short))
        long, short = larger * long, larger * short
    return total / carried


@njit
def area_share(ellipse: Floats) -> float:
    """Return the area of an ellipse over that of the circle that is as stiff."""
    stretch = math.exp(math.hypot(ellipse[0], ellipse[1]))
    ratio = 2.0 / math.pi * complete_elliptic(1.0 / (stretch * stretch)) / stretch
    return ratio * ratio


@njit
def _allowed(hill: Territory, radius: float, ellipse: Floats) -> bool:
    return (
        math.hypot(ellipse[0], ellipse[1]) <= MAX_ELONGATION
        and radius * math.hypot(ellipse[2], ellipse[3]) <= MAX_DRIFT
        and on_map(hill, radius * ellipse[2], radius * ellipse[3])
    )


@njit
def improve(hill: Territory, radius: float, ellipse: Floats) -> float:
    """Move an ellipse to where the mean height is largest, parabola by parabola, and return that [m]."""
    best = mean_height(hill, radius, ellipse)
    step = _FIRST_STEPS.copy()
    for _ in range(_SWEEPS):
        for k in range(PARAMETERS):
            place = ellipse[k]
            ellipse[k] = place + step[k]
            above = mean_height(hill, radius, ellipse)
            ellipse[k] = place - step[k]
            below = mean_height(hill, radius, ellipse)
            slope, bend = above - below, above + below - 2.0 * best
            move = step[k] if slope > 0.0 else -step[k]
            if bend < 0.0:
                move = min(max(-0.5 * slope / bend, -2.0), 2.0) * step[k]
            ellipse[k] = place + move
            found = mean_height(hill, radius, ellipse) if _allowed(hill, radius, ellipse) else -math.inf
            if found > best:
                best = found
            else:
                ellipse[k] = place
            step[k] = max(min(abs(ellipse[k] - place), step[k]), 0.25 * step[k])
    return best

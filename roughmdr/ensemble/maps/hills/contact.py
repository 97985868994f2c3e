"""The surface of one hill, and the best contact: of all ellipses of one stiffness that with the largest mean height.

Heights between the points of the map are those of its cubic spline. Along rays from the summit the surface must fall:
where it rises, the territory of a neighbour begins, and twice the rise is subtracted.

A contact region A carries S_A (<h>_A - D) under a flat punch at D, S_A its stiffness and <h>_A the mean of the heights
under the pressure of that punch, and the region that is in contact is the one which carries most (J. R. Barber, Int. J.
Solids Struct. 10 (1974) 813). An ellipse with the axes a e^q and a e^-q is as stiff as a circle of the radius
(pi/2) a e^q/K(1 - e^-4q); its pressure is proportional to 1/sqrt(1 - r^2), r from its centre over the half axis.
"""

import math
from functools import partial
from typing import NamedTuple

import numpy as np

from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.gauss import unit_gauss
from roughmdr.numerics.jit import njit

_inlined = partial(njit, small=True)  # a call would count the references to every array of its arguments
RAYS, STEPS = 32, 96
REACH = 3.0
"""Length of a ray, in wavelengths of the map (``find.wavelength``)."""
_CLIMBS, _CLIMB = 10, 0.02  # steps towards a summit along both axes, and their length at most
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


class Spline(NamedTuple):
    """A map as a cubic spline."""

    coefficients: Floats
    """Coefficients of the B-splines at the points [m], [x, y]."""
    spacing_x: float
    """[wavelength]."""
    spacing_y: float
    periodic: bool


class Territory(NamedTuple):
    """The surface of one hill; lengths in wavelengths from its summit."""

    map: Spline
    row: float
    """Row of the summit on the map; a fraction between points, as ``column``."""
    column: float
    taken_off: Floats
    """Height that is taken off along each ray [m], [ray, step]."""
    nearest_rise: Floats
    """Distance from the summit up to which nothing is taken off; an array of one number."""


@_inlined
def _wrapped(index: int, size: int, periodic: bool) -> int:
    """Return the point of the map for one beyond its edges: that of the next period, or the mirrored one."""
    if periodic:
        return index % size
    if size == 1:
        return 0
    index = abs(index) % (2 * size - 2)
    return index if index < size else 2 * size - 2 - index


@_inlined
def _basis(u: float) -> tuple[float, float, float, float]:
    """Return the four cubic B-splines over the interval that u from 0 to 1 lies on."""
    v, square, cube = 1.0 - u, u * u, u * u * u
    return (
        v * v * v / 6.0,
        (4.0 - 6.0 * square + 3.0 * cube) / 6.0,
        (1.0 + 3.0 * (u + square - cube)) / 6.0,
        cube / 6.0,
    )


@_inlined
def raw_height(hill: Territory, x: float, y: float) -> float:
    """Return the height of the map [m] at a position [wavelength] from the summit."""
    c, periodic = hill.map.coefficients, hill.map.periodic
    row, column = hill.row + x / hill.map.spacing_x, hill.column + y / hill.map.spacing_y
    nx, ny = c.shape
    i, j = math.floor(row), math.floor(column)
    along_x, along_y = _basis(row - i), _basis(column - j)
    total = 0.0
    if 1 <= i < nx - 2 and 1 <= j < ny - 2:
        for k in range(4):
            m = i - 1 + k
            line = along_y[0] * c[m, j - 1] + along_y[1] * c[m, j] + along_y[2] * c[m, j + 1] + along_y[3] * c[m, j + 2]
            total += along_x[k] * line
        return total
    for k in range(4):
        line, m = 0.0, _wrapped(i - 1 + k, nx, periodic)
        for n in range(4):
            line += along_y[n] * c[m, _wrapped(j - 1 + n, ny, periodic)]
        total += along_x[k] * line
    return total


@_inlined
def on_map(hill: Territory, x: float, y: float) -> bool:
    """Return whether a position [wavelength] from the summit is on the map, and not beyond its border."""
    row, column = hill.row + x / hill.map.spacing_x + 0.5, hill.column + y / hill.map.spacing_y + 0.5
    nx, ny = hill.map.coefficients.shape
    return hill.map.periodic or (0.0 <= row <= nx and 0.0 <= column <= ny)


@njit
def top_of(hill: Territory) -> tuple[float, float]:
    """Return the position of the summit [wavelength], relative to the top of the paraboloid through its points."""
    x = y = 0.0
    for _ in range(_CLIMBS):
        for dx, dy in ((_CLIMB, 0.0), (0.0, _CLIMB)):
            above, below = raw_height(hill, x + dx, y + dy), raw_height(hill, x - dx, y - dy)
            bend = above + below - 2.0 * raw_height(hill, x, y)
            if bend < 0.0:
                move = min(max(0.5 * (below - above) / bend, -1.0), 1.0)
                x, y = x + move * dx, y + move * dy
    return x, y


@njit
def explore(hill: Territory) -> None:
    """Fill in the height that is taken off along the rays."""
    step, nearest = REACH / STEPS, REACH
    for ray in range(RAYS):
        angle = 2.0 * math.pi * ray / RAYS
        x, y = step * math.cos(angle), step * math.sin(angle)
        before, total = raw_height(hill, 0.0, 0.0), 0.0
        for k in range(STEPS):
            hill.taken_off[ray, k] = total
            here = raw_height(hill, (k + 1) * x, (k + 1) * y)
            if here > before:
                nearest = min(nearest, k * step)
                total += 2.0 * (here - before)
            before = here
        hill.taken_off[ray, STEPS] = total
    hill.nearest_rise[0] = nearest


@_inlined
def height(hill: Territory, x: float, y: float) -> float:
    """Return the height of the hill [m] at a position [wavelength] from its summit."""
    raw, r = raw_height(hill, x, y), math.sqrt(x * x + y * y)
    if r <= hill.nearest_rise[0]:
        return raw
    step = min(r * (STEPS / REACH), STEPS - 1e-9)
    ray = (math.atan2(y, x) / (2.0 * math.pi) % 1.0) * RAYS
    k, m = int(step), int(ray)
    u, v, following = step - k, ray - m, (m + 1) % RAYS
    m %= RAYS
    taken = hill.taken_off
    one = (1.0 - u) * taken[m, k] + u * taken[m, k + 1]
    other = (1.0 - u) * taken[following, k] + u * taken[following, k + 1]
    return float(raw - ((1.0 - v) * one + v * other))


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

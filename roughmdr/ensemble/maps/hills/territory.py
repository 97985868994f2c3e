"""The surface of one hill: the map about its summit, where each rise beyond a valley is turned into a fall.

Heights between the points of the map are those of its cubic spline. Along rays from the summit the surface must fall:
where it rises, the territory of a neighbour begins, and twice the rise is subtracted.
"""

import math
from functools import partial
from typing import NamedTuple

from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.jit import njit

_inlined = partial(njit, small=True)  # a call would count the references to every array of its arguments

RAYS, STEPS = 32, 96
REACH = 3.0
"""Length of a ray, in wavelengths of the map (``find.wavelength``)."""
_CLIMBS, _CLIMB = 10, 0.02  # steps towards a summit along both axes, and their length at most


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

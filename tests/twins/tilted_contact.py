"""An indenter f = c r^n on a tilted plane by the theorem of largest load: no formula of the contact's radius is in it.

Of all flat punches that carry the displacement, the contact is the one with the largest load (J. R. Barber, J. Appl.
Mech. 41 (1974) 813). Among discs of radius a and centre (b, 0) the load is ∫ u/√(a² - r²) dA/π. The edge differs
from a disc in the second order of the tilt; as the load is stationary, it is right up to the third order. E* is 1.
"""

import math
from typing import NamedTuple

import numpy as np
from scipy.optimize import root
from scipy.special import roots_jacobi

from roughmdr.errors import OutOfRange
from roughmdr.numerics.arguments import Floats
from twins.two_contacts import Indenter

_NODES, _DIRECTIONS = 32, 64
_TOLERANCE = 1e-14


class Tilted(NamedTuple):
    """The contact on a surface that is displaced by tilt x, away from the indenter."""

    force: float
    moment: float
    """∫ p x dA about the axis of the indenter."""
    radius: float
    centre: float


class _Disc(NamedTuple):
    """Points of a disc around the tip, in polar coordinates, with the weights of ∫ ... /√(a² - |x - b|²) dA/π."""

    x: Floats
    r: Floats
    weight: Floats


def _disc(radius: float, centre: float) -> _Disc:
    """Return the rule: Gauss and Jacobi along each ray, smooth over the directions, and so at the tip of any cone."""
    angle = (np.arange(_DIRECTIONS) + 0.5) * 2.0 * math.pi / _DIRECTIONS
    half = np.sqrt(radius**2 - (centre * np.sin(angle)) ** 2)[:, None]
    middle = centre * np.cos(angle)[:, None]
    node, weight = roots_jacobi(_NODES, -0.5, 0.0)
    length = half + middle
    r = length * (0.5 + 0.5 * node)
    each = weight * np.sqrt(0.5 * length) * r / np.sqrt(r + half - middle) * 2.0 / _DIRECTIONS
    return _Disc(r * np.cos(angle)[:, None], r, each)


def press_tilted(indenter: Indenter, tilt: float) -> Tilted:
    """Return the contact of an indenter on a surface displaced by ``tilt`` x; OutOfRange where none is found."""
    n, slope, approach = indenter
    unit = indenter.lone_radius

    def displacement(disc: _Disc) -> Floats:
        return np.asarray(approach - slope * disc.r**n - tilt * disc.x)

    def gradient(place: Floats) -> Floats:
        """Derivatives of the load over radius and centre."""
        radius, centre = unit * place
        disc = _disc(radius, centre)
        steepness = slope * n * disc.r ** (n - 2.0)  # the gradient of f is this times the position
        stretched = -steepness * (disc.r**2 - centre * disc.x) - tilt * (disc.x - centre)
        by_radius = np.sum(disc.weight * (displacement(disc) + stretched)) / radius
        by_centre = -np.sum(disc.weight * (steepness * disc.x + tilt))
        return np.array([by_radius, by_centre * unit / approach])

    found = root(gradient, [1.0, -1e-3 * tilt * unit / approach], tol=_TOLERANCE)
    radius, centre = unit * found.x
    if np.abs(found.fun).max() > 1e3 * _TOLERANCE * max(1.0, approach / unit):
        raise OutOfRange(f"tilt is {tilt:g}: the disc of the largest load is not found")
    disc = _disc(radius, centre)
    load = disc.weight * displacement(disc)
    force = float(load.sum())
    return Tilted(force, float(2.0 * np.sum(load * (disc.x - centre)) + centre * force), radius, centre)

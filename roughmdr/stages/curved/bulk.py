"""The half-space under an axisymmetric pressure of either sign, mapped by the method of dimensionality reduction.

q(x) = 2 ∫_x^inf r p/sqrt(r^2 - x^2) dr is the load of the row of springs, w1D = q/E* its displacement, and
u(r) = (2/pi) ∫_0^r w1D/sqrt(r^2 - x^2) dx that of the surface, within the contact and outside it (H 17-24). With
r^2 = x^2 + t^2, and then x = r sin(theta), neither integral is singular:

    q(x) = 2 ∫_0^inf p(sqrt(x^2 + t^2)) dt,    u(r) = (2/(pi E*)) ∫_0^(pi/2) q(r sin(theta)) d(theta).

Pressure and q are quadratic on each element, and Gauss's rule takes each integral over an element to rounding.
"""

import math

import numpy as np

from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.gauss import unit_gauss
from roughmdr.numerics.jit import njit
from roughmdr.stages.curved.rings import Rings

_NODES, _WEIGHTS = unit_gauss(12)


def displacement_matrix(rings: Rings, effective_modulus: float) -> Floats:
    """Return the matrix [m/Pa] that takes the pressure on each ring to the displacement of each: [ring, ring].

    E* [Pa]; the displacement is positive into the half-space.
    """
    matrix = _product(_row_displacement(rings.radius), row_load(rings.radius))
    matrix *= 2.0 / (math.pi * effective_modulus)
    return matrix


@njit
def _add_parabola(row: Floats, radius: Floats, element: int, r: float, weight: float) -> None:
    """Add to ``row`` the weights of an element's three rings in the value at r, times ``weight``."""
    y = (r - radius[2 * element]) / (radius[2 * element + 2] - radius[2 * element])
    row[2 * element] += weight * (1.0 - y) * (1.0 - 2.0 * y)
    row[2 * element + 1] += weight * 4.0 * y * (1.0 - y)
    row[2 * element + 2] += weight * y * (2.0 * y - 1.0)


@njit
def row_load(radius: Floats) -> Floats:
    """Return the matrix [m] that takes the pressure on each ring to q(x) [N/m], at x equal to the radius of each."""
    matrix = np.zeros((radius.size, radius.size))
    for i in range(radius.size):
        x = radius[i]
        for element in range(i // 2, radius.size // 2):
            low, high = max(radius[2 * element], x), radius[2 * element + 2]
            begin, end = math.sqrt((low - x) * (low + x)), math.sqrt((high - x) * (high + x))
            for m in range(_NODES.size):
                t = begin + (end - begin) * _NODES[m]
                r = math.sqrt(x * x + t * t)
                _add_parabola(matrix[i], radius, element, r, 2.0 * (end - begin) * _WEIGHTS[m])
    return matrix


@njit
def _row_displacement(radius: Floats) -> Floats:
    """Return the matrix of ∫_0^(pi/2) q(r sin(theta)) d(theta) from q."""
    matrix = np.zeros((radius.size, radius.size))
    matrix[0, 0] = 0.5 * math.pi
    for i in range(1, radius.size):
        r = radius[i]
        begin = 0.0
        for element in range((i + 1) // 2):
            x = min(radius[2 * element + 2], r)
            end = math.atan2(x, math.sqrt((r - x) * (r + x)))
            for m in range(_NODES.size):
                theta = begin + (end - begin) * _NODES[m]
                _add_parabola(matrix[i], radius, element, r * math.sin(theta), (end - begin) * _WEIGHTS[m])
            begin = end
    return matrix


@njit
def _product(left: Floats, right: Floats) -> Floats:
    """Return the matrix product, each element summed in order: in libraries the order depends on the threads."""
    product = np.zeros((left.shape[0], right.shape[1]))
    for i in range(left.shape[0]):
        for k in range(left.shape[1]):
            factor = left[i, k]
            if factor != 0.0:
                for j in range(right.shape[1]):
                    product[i, j] += factor * right[k, j]
    return product

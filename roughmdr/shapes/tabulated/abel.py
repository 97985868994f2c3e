"""The MDR profile of a spline, integrated piece by piece (H 17, 25).

With r = x sin(phi) each piece of g = x ∫ f' dphi is a polynomial in sin(phi), which the nodes of Gauss integrate to
rounding error, without the cancellation of the antiderivatives far from the piece.
"""

import math

import numpy as np

from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.jit import njit


def _gauss(count: int) -> tuple[Floats, Floats]:
    nodes, weights = np.polynomial.legendre.leggauss(count)
    return 0.5 * (1.0 + nodes), 0.5 * weights


_SMALL_ANGLE = 0.02
_NODES_SMALL, _WEIGHTS_SMALL = _gauss(4)  # enough for a small angle
_NODES, _WEIGHTS = _gauss(14)  # enough for a right angle


@njit
def _root(knot: float, a: float, q: float, base: float) -> float:
    """Return sqrt(a^2 - knot^2) where a^2 = q^2 + base^2."""
    return math.sqrt(q * q + (base - knot) * (base + knot) if knot <= base else (a - knot) * (a + knot))


@njit
def integrals(q: Floats, base: Floats, knots: Floats, coefficients: Floats) -> Floats:
    """Return g, g' and ∫ x g' dx, in columns, at each x = sqrt(q^2 + base^2) > 0, where base is a knot or 0.

    The slope is f' = c0 + c1 s + c2 s^2 over s = r - knot, and the last piece has no end. Angles and s are formed
    without differences of nearly equal numbers; next to a knot, where g' begins like the root of the distance from it,
    x itself has too few digits.
    """
    out = np.zeros((q.size, 3))
    for i in range(q.size):
        a = math.sqrt(q[i] * q[i] + base[i] * base[i])
        for k in range(knots.size):
            knot = knots[k]
            if knot >= a:
                break
            root = _root(knot, a, q[i], base[i])
            angle = math.atan2(root, knot)
            if k + 1 < knots.size and knots[k + 1] < a:
                end = knots[k + 1]
                root_end = _root(end, a, q[i], base[i])
                sine = (end - knot) * (end + knot) * a * a / (end * root + knot * root_end)
                angle = math.atan2(sine, root * root_end + end * knot)
            nodes, weights = (_NODES_SMALL, _WEIGHTS_SMALL) if angle < _SMALL_ANGLE else (_NODES, _WEIGHTS)
            c0, c1, c2 = coefficients[k, 0], coefficients[k, 1], coefficients[k, 2]
            for j in range(nodes.size):
                half = 0.5 * angle * nodes[j]
                if angle < _SMALL_ANGLE:
                    square = half * half
                    sine = half * (1.0 - square / 6.0 * (1.0 - square / 20.0))
                    cosine = 1.0 - 0.5 * square * (1.0 - square / 12.0 * (1.0 - square / 30.0))
                else:
                    sine, cosine = math.sin(half), math.cos(half)
                s = 2.0 * sine * (root * cosine - knot * sine)
                r = knot + s
                slope = c0 + s * (c1 + s * c2)
                weight = angle * weights[j]
                out[i, 0] += weight * a * slope
                out[i, 1] += weight * (slope + r * (c1 + 2.0 * s * c2))
                out[i, 2] += weight * r * r * slope
    return out

"""The MDR profile of a spline, integrated piece by piece (H 17, 25).

With r = x sin(phi) each piece of g = x ∫ f' dphi is a polynomial in sin(phi), which the nodes of Gauss integrate to
rounding error, without the cancellation of the antiderivatives far from the piece.
"""

import math

import numpy as np

from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.gauss import unit_gauss
from roughmdr.numerics.jit import njit

_SMALL = 0.02
_FINE, _FINE_WEIGHTS = unit_gauss(4)  # enough for a small angle
_WIDE, _WIDE_WEIGHTS = unit_gauss(14)  # enough for a right angle


@njit
def _t_of_q(knot: float, a: float, place: float, base: float) -> float:
    """sqrt(a^2 - knot^2), a^2 = place^2 + base^2."""
    return math.sqrt(place * place + (base - knot) * (base + knot) if knot <= base else (a - knot) * (a + knot))


@njit
def integrals(place: Floats, base: Floats, knots: Floats, coefficients: Floats) -> Floats:
    """g, g' and ∫ x g' dx at each x = sqrt(place^2 + base^2) > 0, base a knot or 0, of f' = c0 + c1 s + c2 s^2 over
    s = r - knot, the last piece without end.

    Angles and s are formed without differences of numbers that are nearly equal; next to a knot, where g' begins like
    the root of the way from it, x itself has too few digits.
    """
    out = np.zeros((place.size, 3))
    for i in range(place.size):
        beside, begin = place[i], base[i]
        a = math.sqrt(beside * beside + begin * begin)
        for k in range(knots.size):
            knot = knots[k]
            if knot >= a:
                break
            q = _t_of_q(knot, a, beside, begin)
            angle = math.atan2(q, knot)
            if k + 1 < knots.size and knots[k + 1] < a:
                end = knots[k + 1]
                q_end = _t_of_q(end, a, beside, begin)
                sine = (end - knot) * (end + knot) * a * a / (end * q + knot * q_end)
                angle = math.atan2(sine, q * q_end + end * knot)
            nodes, weights = (_FINE, _FINE_WEIGHTS) if angle < _SMALL else (_WIDE, _WIDE_WEIGHTS)
            c0, c1, c2 = coefficients[k, 0], coefficients[k, 1], coefficients[k, 2]
            for j in range(nodes.size):
                half = 0.5 * angle * nodes[j]
                if angle < _SMALL:
                    square = half * half
                    sine = half * (1.0 - square / 6.0 * (1.0 - square / 20.0))
                    cosine = 1.0 - 0.5 * square * (1.0 - square / 12.0 * (1.0 - square / 30.0))
                else:
                    sine, cosine = math.sin(half), math.cos(half)
                s = 2.0 * sine * (q * cosine - knot * sine)
                r = knot + s
                slope = c0 + s * (c1 + s * c2)
                weight = angle * weights[j]
                out[i, 0] += weight * a * slope
                out[i, 1] += weight * (slope + r * (c1 + 2.0 * s * c2))
                out[i, 2] += weight * r * r * slope
    return out

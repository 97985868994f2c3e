"""The MDR profile of a spline, integrated piece by piece (H 17, 25).

With r = x sin(phi) each piece of g = x ∫ f' dphi is a polynomial in sin(phi), which the nodes of Gauss integrate to
rounding error, without the cancellation of the antiderivatives far from the piece.
"""

import math

import numpy as np

from roughmdr._jit import njit
from roughmdr.arguments import Floats


def _gauss(count: int) -> tuple[Floats, Floats]:
    nodes, weights = np.polynomial.legendre.leggauss(count)
    return 0.5 * (1.0 + nodes), 0.5 * weights


_SMALL = 0.05
_FINE, _FINE_WEIGHTS = _gauss(4)  # enough for a small angle
_WIDE, _WIDE_WEIGHTS = _gauss(14)  # enough for a right angle


@njit
def _turned(sine: float, cosine: float, angle: float) -> float:
    """The sine of an angle that is larger by a small one."""
    square = angle * angle
    turn = angle * (1.0 - square / 6.0 * (1.0 - square / 20.0 * (1.0 - square / 42.0)))
    return (
        sine * (1.0 - 0.5 * square * (1.0 - square / 12.0 * (1.0 - square / 30.0 * (1.0 - square / 56.0))))
        + cosine * turn
    )


@njit
def integrals(x: Floats, knots: Floats, coefficients: Floats) -> Floats:
    """g, g' and ∫ x g' dx at each x > 0, of f' = c0 + c1 s + c2 s^2 over s = r - knot, the last piece without end."""
    out = np.zeros((x.size, 3))
    for i in range(x.size):
        a = x[i]
        begin = 0.0
        for k in range(knots.size):
            if knots[k] >= a:
                break
            end = 0.5 * math.pi
            if k + 1 < knots.size and knots[k + 1] < a:
                end = math.atan2(knots[k + 1], math.sqrt((a - knots[k + 1]) * (a + knots[k + 1])))
            angle = end - begin
            nodes, weights = (_FINE, _FINE_WEIGHTS) if angle < _SMALL else (_WIDE, _WIDE_WEIGHTS)
            c0, c1, c2 = coefficients[k, 0], coefficients[k, 1], coefficients[k, 2]
            sine, cosine = math.sin(begin), math.cos(begin)
            for j in range(nodes.size):
                r = a * (
                    _turned(sine, cosine, angle * nodes[j]) if angle < _SMALL else math.sin(begin + angle * nodes[j])
                )
                s = r - knots[k]
                slope = c0 + s * (c1 + s * c2)
                weight = angle * weights[j]
                out[i, 0] += weight * a * slope
                out[i, 1] += weight * (slope + r * (c1 + 2.0 * s * c2))
                out[i, 2] += weight * r * r * slope
            begin = end
    return out

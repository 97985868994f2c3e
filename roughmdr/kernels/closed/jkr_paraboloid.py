"""One paraboloid with JKR adhesion: the power law with n = 2, where 3 X = v^2 (6 + 4 v + v^2) with v = tau - 1.

Notation of ``jkr_power``. ``state`` and what follows from it neither branch nor call, so that a loop over asperities
becomes vector code.
"""

import math
from functools import partial

import numpy as np

from roughmdr.numerics import double_double as dd
from roughmdr.numerics.double_double import Pair
from roughmdr.numerics.jit import njit

# v = s r with s = sqrt(X/2); r = y (C0 + C1 y + ... + C5 y^5), y = 1/sqrt(1 + B s), within 2.3e-6 for all s >= 0.
# Least-maximum fit to the root itself over 0 < y <= 1.
_B = 2.577472688647387
_C0, _C1, _C2 = 2.5126716141883847, -2.5782406660482913, 1.2749000231451322
_C3, _C4, _C5 = -0.04324516500758297, -0.24742443101061207, 0.08133881774388521
_SMALLEST = 1e-270
_KERNEL_ERROR = 1e-13  # relative error of the force, as tested


@njit
def _curvature_radius(width: float, rise: float) -> float:
    """R of rise (r/width)^2 = r^2/(2 R)."""
    return width * (width / (2.0 * rise))


@njit
def _reduced_work(effective_modulus: float, work: float, radius: float) -> Pair:
    """pi w/(E* R), the part without R first: a loop over asperities computes it once."""
    length = dd.divide(dd.multiply(dd.PI, (work, 0.0)), (effective_modulus, 0.0))
    return dd.divide(length, (radius, 0.0))


@partial(njit, inline=True)
def scales(
    effective_modulus: float, work: float, width: float, rise: float, n: float
) -> tuple[Pair, float, float, float]:
    """|delta_c| = 3/4 (pi^2 w^2 R/E*^2)^(1/3) [m], a_c = (pi w R^2/(8 E*))^(1/3) [m], pi w R [N], 2 E* a_c [N/m].

    All NaN where pi w/(E* R) lies so far from 1 that its cube root cannot be corrected in pairs.
    """
    curvature_radius = _curvature_radius(width, rise)
    reduced = _reduced_work(effective_modulus, work, curvature_radius)
    root = float(np.cbrt(reduced[0] if _SMALLEST < reduced[0] < 1.0 / _SMALLEST else math.nan))
    cube = dd.multiply(dd.two_product(root, root), (root, 0.0))
    rest = dd.add(reduced, (-cube[0], -cube[1]))
    root_exact = dd.two_sum(root, (rest[0] + rest[1]) / (3.0 * root * root))
    depth = dd.multiply(dd.multiply(root_exact, root_exact), dd.two_product(0.75, curvature_radius))
    a_c = 0.5 * curvature_radius * root_exact[0]
    return depth, a_c, math.pi * work * curvature_radius, 2.0 * effective_modulus * a_c


@njit
def relative_errors(n: float) -> tuple[float, float]:
    """The error of the force; the state comes from the distance to the fold."""
    return _KERNEL_ERROR, 0.0


@njit
def force_scales(effective_modulus: float, work: float, width: float, rise: float, n: float) -> tuple[Pair, float]:
    """|P_c| = 3/2 pi w R [N] under dead load, and a_P = 9^(1/3) a_c [m]."""
    curvature_radius = _curvature_radius(width, rise)
    force = dd.multiply(dd.PI, dd.multiply(dd.two_product(1.5, work), (curvature_radius, 0.0)))
    reduced = _reduced_work(effective_modulus, work, curvature_radius)[0]
    return force, 0.5 * curvature_radius * float(np.cbrt(9.0 * reduced))


@njit
def state(x: float, n: float) -> float:
    """v at the distance x >= 0 to the fold: the fit, then one Halley step on r^2 (6 + 4 v + v^2) = 6, v = s r."""
    s = math.sqrt(0.5 * x)
    y = 1.0 / math.sqrt(1.0 + _B * s)
    r = y * (_C0 + y * (_C1 + y * (_C2 + y * (_C3 + y * (_C4 + y * _C5)))))
    v = s * r
    residual = r * r * (6.0 + v * (4.0 + v)) - 6.0
    slope = 4.0 * r * (3.0 + v * (3.0 + v))
    curve = 12.0 * (1.0 + v) * (1.0 + v)
    r -= 2.0 * residual * slope / (2.0 * slope * slope - residual * curve)
    return s * r


@njit
def state_of_radius(radius: float, size: float, n: float) -> float:
    """v at a contact radius > 0, ``size`` = a_c, stable (v > 0) or not."""
    ratio = radius / size
    return (ratio - 1.0) / (math.sqrt(ratio) + 1.0)


@njit
def radius_of_force(x: float, n: float) -> float:
    """a/a_P at x = 1 - P/P_c >= 0, on the branch that is stable under dead load: (1 + sqrt x)^(2/3)."""
    return float(np.cbrt((1.0 + math.sqrt(x)) ** 2))


@njit
def state_of_force(x: float, n: float) -> float:
    """v at x = 1 - P/P_c >= 0, on the branch that is stable under dead load: tau^3 = 3 (1 + sqrt x)."""
    return float(np.cbrt(3.0 * (1.0 + math.sqrt(x)))) - 1.0


@njit
def reduced_control(v: float, n: float) -> float:
    """X(v)."""
    return v * v * (6.0 + v * (4.0 + v)) / 3.0


@njit
def radius(v: float, n: float) -> float:
    """a/a_c."""
    return (1.0 + v) * (1.0 + v)


@njit
def force(v: float, n: float) -> float:
    """P over pi w R."""
    cube = (1.0 + v) * (1.0 + v) * (1.0 + v)
    return cube * (cube / 6.0 - 1.0)


@njit
def stiffness(v: float, n: float) -> float:
    """k over 2 E* a_c."""
    excess = v * (3.0 + v * (3.0 + v))
    return (1.0 + v) * (1.0 + v) * (excess - 2.0) / excess


@njit
def energy(v: float, n: float) -> float:
    """U over pi w R |delta_c|."""
    square = (1.0 + v) * (1.0 + v)
    excess = v * (3.0 + v * (3.0 + v))
    return square * square * (6.0 - excess * (8.0 - excess)) / 45.0

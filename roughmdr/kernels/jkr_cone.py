"""One cone with JKR adhesion: the power law with n = 1, where X = v^2 with v = tau - 1 (notation of ``jkr_power``)."""

import math

from roughmdr import _extended as extended
from roughmdr._extended import Pair
from roughmdr._jit import njit
from roughmdr.kernels.jkr_power import branch


@njit
def natural(modulus: float, work: float, width: float, rise: float, n: float) -> tuple[Pair, float, float, float]:
    """|delta_c| = w/(S E*) [m], a_c = 2 w/(pi S^2 E*) [m], 2 E* a_c dl(a_c) [N] and 2 E* a_c [N/m]."""
    slope = extended.divide((rise, 0.0), (width, 0.0))
    depth = extended.divide((work, 0.0), extended.multiply(slope, (modulus, 0.0)))
    a_c = 2.0 * depth[0] / (math.pi * slope[0])
    return depth, a_c, 4.0 * modulus * a_c * depth[0], 2.0 * modulus * a_c


@njit
def natural_force(modulus: float, work: float, width: float, rise: float, n: float) -> tuple[Pair, float]:
    """|P_c| = 54 w^2/(pi S^3 E*) [N] under dead load, and a_P = 9 a_c [m]."""
    slope = extended.divide((rise, 0.0), (width, 0.0))
    depth = extended.divide((work, 0.0), extended.multiply(slope, (modulus, 0.0)))
    a_c = extended.divide(extended.multiply((2.0, 0.0), depth), extended.multiply(extended.PI, slope))
    force = extended.multiply(extended.multiply(extended.two_product(27.0, modulus), a_c), depth)
    return force, 9.0 * a_c[0]


@njit
def state(x: float, n: float) -> float:
    """v at the distance x >= 0 to the fold."""
    return math.sqrt(x)


@njit
def state_of_radius(ratio: float, n: float) -> float:
    """v at a given a/a_c > 0, stable (v > 0) or not."""
    return (ratio - 1.0) / (math.sqrt(ratio) + 1.0)


@njit
def radius_of_force(x: float, n: float) -> float:
    """a/a_P at x = 1 - P/P_c >= 0, on the branch that is stable under dead load."""
    return math.exp(2.0 / 3.0 * branch(x, 1.0 / 3.0))


@njit
def distance(v: float, n: float) -> float:
    """X(v)."""
    return v * v


@njit
def radius(v: float, n: float) -> float:
    """a/a_c."""
    return (1.0 + v) * (1.0 + v)


@njit
def force(v: float, n: float) -> float:
    """P over 2 E* a_c dl(a_c)."""
    tau = 1.0 + v
    return tau * tau * tau * (0.25 * v - 0.75)


@njit
def stiffness(v: float, n: float) -> float:
    """k over 2 E* a_c."""
    tau = 1.0 + v
    return tau * tau * (v - 2.0) / v

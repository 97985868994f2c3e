"""One cone with JKR adhesion: the power law with n = 1, where X = v^2 with v = tau - 1 (notation of ``jkr_power``)."""

import math

from roughmdr.kernels.closed.jkr_paraboloid import radius, relative_errors, state_of_radius
from roughmdr.kernels.closed.jkr_power import stable_log_tau
from roughmdr.numerics import double_double as dd
from roughmdr.numerics.double_double import Pair
from roughmdr.numerics.jit import njit

__all__ = [
    "energy",
    "force",
    "force_scales",
    "radius",
    "radius_of_force",
    "reduced_control",
    "relative_errors",
    "scales",
    "state",
    "state_of_force",
    "state_of_radius",
    "stiffness",
]


@njit
def _fold(effective_modulus: float, work: float, width: float, rise: float) -> tuple[Pair, Pair]:
    """|delta_c| = w/(S E*) and a_c = 2 w/(pi S^2 E*) [m]."""
    slope = dd.divide((rise, 0.0), (width, 0.0))
    depth = dd.divide((work, 0.0), dd.multiply(slope, (effective_modulus, 0.0)))
    return depth, dd.divide(dd.multiply((2.0, 0.0), depth), dd.multiply(dd.PI, slope))


@njit
def scales(
    effective_modulus: float, work: float, width: float, rise: float, n: float
) -> tuple[Pair, float, float, float]:
    """|delta_c| [m], a_c [m], 2 E* a_c dl(a_c) [N] and 2 E* a_c [N/m]; dl(a_c) = 2 |delta_c|."""
    depth, a_c = _fold(effective_modulus, work, width, rise)
    return depth, a_c[0], 4.0 * effective_modulus * a_c[0] * depth[0], 2.0 * effective_modulus * a_c[0]


@njit
def force_scales(effective_modulus: float, work: float, width: float, rise: float, n: float) -> tuple[Pair, float]:
    """|P_c| = 54 w^2/(pi S^3 E*) [N] under dead load, and a_P = 9 a_c [m]."""
    depth, a_c = _fold(effective_modulus, work, width, rise)
    return dd.multiply(dd.multiply(dd.two_product(27.0, effective_modulus), a_c), depth), 9.0 * a_c[0]


@njit
def state(x: float, n: float) -> float:
    """v at the distance x >= 0 to the fold."""
    return math.sqrt(x)


@njit
def radius_of_force(x: float, n: float) -> float:
    """a/a_P at x = 1 - P/P_c >= 0, on the branch that is stable under dead load."""
    return math.exp(2.0 / 3.0 * stable_log_tau(x, 1.0 / 3.0))


@njit
def state_of_force(x: float, n: float) -> float:
    """v at x = 1 - P/P_c >= 0, on the branch that is stable under dead load, where tau = 3 at x = 0."""
    return 3.0 * math.exp(stable_log_tau(x, 1.0 / 3.0) / 3.0) - 1.0


@njit
def reduced_control(v: float, n: float) -> float:
    """X(v)."""
    return v * v


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


@njit
def energy(v: float, n: float) -> float:
    """U over 2 E* a_c dl(a_c) |delta_c|."""
    square = (1.0 + v) * (1.0 + v)
    return square * square * (1.0 - v * (4.0 - v)) / 12.0

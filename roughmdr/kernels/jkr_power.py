"""One power-law asperity with JKR adhesion, any exponent n > 1/2 (H 32-33, 40-41, 44).

All is measured from the fold under fixed grips, where the contact lets go: there
a_c g'(a_c) = dl(a_c)/2. With tau = sqrt(a/a_c), e = 2 n - 1 and the distance to the fold X = 1 - delta/delta_c,

    X = tau (tau^e - 1)/e - (tau - 1),   delta_c = -e/(2 n) dl(a_c),
    P = 2 E* a_c dl(a_c) tau^3 [tau^e/(2 n + 2) - 1],   k = 2 E* a (tau^e - 3)/(tau^e - 1),
    U = 2 E* a_c dl(a_c) |delta_c| n tau^4 [n - q (4 n - tau^e + 1)]/((2 n + 2) (2 n + 1)),   q = (tau^e - 1)/e.

The state is l = ln tau, so that neither tau^e near 1 nor a huge tau loses digits. Under dead load the same equation
holds with u = (tau/tau_P)^3, tau_P^e = 3, in place of tau, e/3 in place of e, and X = 1 - P/P_c.
"""

import math

from roughmdr import _extended as extended
from roughmdr._extended import Pair
from roughmdr._jit import njit
from roughmdr.shapes.kappa import log_kappa

_LOG_LARGEST = 690.0  # e^690 = 1e299: a little inside the range of a float


@njit
def _log_fold(modulus: float, work: float, width: float, rise: float, n: float) -> tuple[Pair, Pair]:
    """ln a_c and ln dl(a_c): (a_c/width)^e = 2 pi w width/(E* (2 n kappa rise)^2)."""
    e = extended.two_sum(2.0 * n, -1.0)
    ratio = extended.add(extended.log((work, 0.0)), extended.multiply((-1.0, 0.0), extended.log((modulus, 0.0))))
    ratio = extended.add(ratio, extended.add(extended.LOG_2, extended.LOG_PI))
    log_width = extended.log((width, 0.0))
    slope = extended.add(log_kappa(n), extended.add(extended.log((rise, 0.0)), extended.log((2.0 * n, 0.0))))
    power = extended.add(extended.add(ratio, log_width), extended.multiply((-2.0, 0.0), slope))
    log_radius = extended.add(log_width, extended.divide(power, e))
    return log_radius, extended.multiply((0.5, 0.0), extended.add(ratio, log_radius))


@njit
def natural(modulus: float, work: float, width: float, rise: float, n: float) -> tuple[Pair, float, float, float]:
    """|delta_c| [m], a_c [m], 2 E* a_c dl(a_c) [N] and 2 E* a_c [N/m]; all 0 where no float can hold them."""
    log_radius, log_stretch = _log_fold(modulus, work, width, rise, n)
    e = extended.two_sum(2.0 * n, -1.0)
    depth = extended.add(log_stretch, extended.log(extended.divide(e, (2.0 * n, 0.0))))
    if not (abs(depth[0]) < _LOG_LARGEST and abs(log_radius[0]) < _LOG_LARGEST):
        return (0.0, 0.0), 0.0, 0.0, 0.0
    a_c = extended.exp(log_radius)[0]
    return extended.exp(depth), a_c, 2.0 * modulus * a_c * extended.exp(log_stretch)[0], 2.0 * modulus * a_c


@njit
def _distance(l: float, e: float) -> tuple[float, float, float]:
    """X, dX/dl and d2X/dl2 at l; X is exact to a few roundings of l tau."""
    tau, excess = math.exp(l), math.expm1(e * l)
    slope = tau * (1.0 + e) * excess / e
    return tau * excess / e - math.expm1(l), slope, slope + tau * (1.0 + e) * (excess + 1.0)


@njit
def branch(x: float, e: float) -> float:
    """The l >= 0 with X(l) = x >= 0: the stable branch.

    The start has the right limits, l ~ sqrt(2 x/(1 + e)) and l ~ ln(x)/(1 + e); Halley's method, on X near the fold and
    on ln X away from it, is at rounding error after one to three steps for e from 2e-4 to 400 and x up to 1e300.
    """
    if x <= 0.0:
        return 0.0
    p = 1.0 + e
    l = 2.0 / p * math.asinh(0.5 * p * math.sqrt(2.0 * x / p))
    for _ in range(8):
        value, slope, curve = _distance(l, e)
        if x > 1.0:
            residual = math.log(value / x)
            curve = curve / value - (slope / value) ** 2
            slope = slope / value
        else:
            residual = value - x
        step = 2.0 * residual * slope / (2.0 * slope * slope - residual * curve)
        l -= step
        if abs(step) < 1e-6 * l:
            break
    return l


@njit
def state(x: float, n: float) -> float:
    """l at the distance x >= 0 to the fold."""
    return branch(x, 2.0 * n - 1.0)


@njit
def state_of_radius(radius: float, size: float, n: float) -> float:
    """l at a contact radius > 0, ``size`` = a_c, stable (l > 0) or not."""
    return 0.5 * math.log(radius / size)


@njit
def radius_of_force(x: float, n: float) -> float:
    """a/a_P at x = 1 - P/P_c >= 0, on the branch that is stable under dead load."""
    return math.exp(2.0 / 3.0 * branch(x, (2.0 * n - 1.0) / 3.0))


@njit
def state_of_force(x: float, n: float) -> float:
    """l at x = 1 - P/P_c >= 0, on the branch that is stable under dead load, where l = (ln 3)/e at x = 0.

    Near n = 1/2 that is a large number, so that ``radius_of_force`` is the better way to a.
    """
    e = 2.0 * n - 1.0
    return extended.LOG_3[0] / e + branch(x, e / 3.0) / 3.0


@njit
def distance(l: float, n: float) -> float:
    """X(l)."""
    return _distance(l, 2.0 * n - 1.0)[0]


@njit
def radius(l: float, n: float) -> float:
    """a/a_c."""
    return math.exp(2.0 * l)


@njit
def force(l: float, n: float) -> float:
    """P over 2 E* a_c dl(a_c)."""
    return math.exp(3.0 * l) * (math.exp((2.0 * n - 1.0) * l) / (2.0 * n + 2.0) - 1.0)


@njit
def stiffness(l: float, n: float) -> float:
    """k over 2 E* a_c; -inf from the right at the fold l = 0, which the caller keeps away from."""
    excess = math.expm1((2.0 * n - 1.0) * l)
    return math.exp(2.0 * l) * (excess - 2.0) / excess


@njit
def energy(l: float, n: float) -> float:
    """U, elastic and surface, over 2 E* a_c dl(a_c) |delta_c|."""
    e = 2.0 * n - 1.0
    excess = math.expm1(e * l)
    return n * math.exp(4.0 * l) * (n - excess / e * (4.0 * n - excess)) / ((2.0 * n + 2.0) * (2.0 * n + 1.0))


@njit
def natural_force(modulus: float, work: float, width: float, rise: float, n: float) -> tuple[Pair, float]:
    """|P_c| [N] under dead load, P_c = -2 E* a_c dl(a_c) tau_P^3 e/(2 n + 2), and a_P [m]; 0 if not representable."""
    log_radius, log_stretch = _log_fold(modulus, work, width, rise, n)
    e = extended.two_sum(2.0 * n, -1.0)
    log_tau = extended.divide(extended.LOG_3, e)
    log_force = extended.add(extended.add(log_radius, log_stretch), extended.log((2.0 * modulus, 0.0)))
    log_force = extended.add(log_force, extended.multiply((3.0, 0.0), log_tau))
    log_force = extended.add(log_force, extended.log(extended.divide(e, extended.two_sum(2.0 * n, 2.0))))
    log_radius = extended.add(log_radius, extended.multiply((2.0, 0.0), log_tau))
    if not (abs(log_force[0]) < _LOG_LARGEST and abs(log_radius[0]) < _LOG_LARGEST):
        return (0.0, 0.0), 0.0
    return extended.exp(log_force), extended.exp(log_radius)[0]

"""One power-law asperity with JKR adhesion, any exponent n > 1/2 (H 32-33, 40-41, 44).

The reference is the fold under fixed grips, where the contact detaches: there
a_c g'(a_c) = dl(a_c)/2. With tau = sqrt(a/a_c), e = 2 n - 1 and the distance to the fold X = 1 - delta/delta_c,

    X = tau (tau^e - 1)/e - (tau - 1),   delta_c = -e/(2 n) dl(a_c),
    P = 2 E* a_c dl(a_c) tau^3 [tau^e/(2 n + 2) - 1],   k = 2 E* a (tau^e - 3)/(tau^e - 1),
    U = 2 E* a_c dl(a_c) |delta_c| n tau^4 [n - q (4 n - tau^e + 1)]/((2 n + 2) (2 n + 1)),   q = (tau^e - 1)/e.

The state is l = ln tau, so that neither tau^e near 1 nor a huge tau loses digits. Under dead load the same equation
holds with u = (tau/tau_P)^3, tau_P^e = 3, in place of tau, e/3 in place of e, and X = 1 - P/P_c.
"""

import math
from functools import partial

from roughmdr.numerics import double_double as dd
from roughmdr.numerics.double_double import Pair
from roughmdr.numerics.jit import compiled, njit
from roughmdr.numerics.vector_math import expm1, log, log1p
from roughmdr.shapes.kappa import precise_kappa

_LOG_LARGEST = 690.0  # e^690 = 1e299: a little inside the range of a float
_KERNEL_ERROR = 1e-13  # error of the force over the sum of its terms, as tested
refinements = 2
_expm1, _log, _log1p = (compiled(part, small=True) for part in (expm1, log, log1p))
_vector = partial(njit, small=True)


@njit
def _length(effective_modulus: float, work: float) -> tuple[Pair, int]:
    """2 pi w/E* [m], and the power of two that goes with it, for range."""
    (w, w_power), (stiff, stiff_power) = math.frexp(work), math.frexp(effective_modulus)
    return dd.divide(dd.multiply(dd.PI, (w, 0.0)), (stiff, 0.0)), 1 + w_power - stiff_power


@njit
def _log_growth(effective_modulus: float, work: float, width: float, rise: float, n: float) -> Pair:
    """ln(a_c/width): (a_c/width)^e = 2 pi w width/(E* (2 n kappa rise)^2), powers of two apart."""
    length, length_power = _length(effective_modulus, work)
    (size, size_power), (high, high_power), (half, n_power) = math.frexp(width), math.frexp(rise), math.frexp(n)
    steepness = dd.multiply(precise_kappa(n), dd.two_product(half, high))
    ratio = dd.divide(dd.multiply(length, (size, 0.0)), dd.multiply(steepness, steepness))
    power = length_power + size_power - 2 * (1 + high_power + n_power)
    log_ratio = dd.add(dd.log(ratio), dd.multiply((float(power), 0.0), dd.LOG_2))
    return dd.divide(log_ratio, dd.two_sum(2.0 * n, -1.0))


@njit
def scales(
    effective_modulus: float, work: float, width: float, rise: float, n: float
) -> tuple[Pair, float, float, float]:
    """|delta_c| [m], a_c [m], 2 E* a_c dl(a_c) [N] and 2 E* a_c [N/m]; all 0 where no float can hold them."""
    growth = _log_growth(effective_modulus, work, width, rise, n)
    if not (abs(growth[0]) < _LOG_LARGEST and abs(growth[0] + math.log(width)) < _LOG_LARGEST):
        return (0.0, 0.0), 0.0, 0.0, 0.0
    size, size_power = math.frexp(width)
    a_c = dd.multiply((size, 0.0), dd.exp(growth))
    a_c = math.ldexp(a_c[0], size_power), math.ldexp(a_c[1], size_power)
    length, power = _length(effective_modulus, work)
    if power % 2 != 0:
        length, power = (2.0 * length[0], 2.0 * length[1]), power - 1
    root = dd.sqrt(dd.multiply(length, a_c))
    stretch = math.ldexp(root[0], power // 2), math.ldexp(root[1], power // 2)
    e = dd.two_sum(2.0 * n, -1.0)
    depth = dd.multiply(stretch, dd.divide(e, (2.0 * n, 0.0)))
    return depth, a_c[0], 2.0 * effective_modulus * a_c[0] * stretch[0], 2.0 * effective_modulus * a_c[0]


@_vector
def relative_errors(n: float) -> tuple[float, float]:
    """The error of the force; the state comes from the distance to the fold."""
    return _KERNEL_ERROR, 0.0


@_vector
def adhesion_terms(a: float, n: float) -> tuple[float, float]:
    """dl over dl(a_c), and a dl over a_c dl(a_c)."""
    stretch = math.sqrt(a)
    return stretch, a * stretch


@_vector
def _distance(l: float, e: float, per_e: float) -> tuple[float, float, float]:
    """X, dX/dl and (d2X/dl2)/(dX/dl) at l; X is exact to a few roundings of l tau."""
    above, excess = _expm1(l), _expm1(e * l)
    tau, q = 1.0 + above, excess * per_e
    return tau * q - above, tau * (1.0 + e) * q, 1.0 + (excess + 1.0) / q


@_vector
def _halley(value: float, slope: float, bend: float, x: float, ratio: float) -> float:
    """The step to X = x by Halley's method: on X, or on ln X where ``ratio`` = ln(X/x) is not 0."""
    residual = ratio * value if x > 1.0 else value - x
    return 2.0 * residual / ((2.0 + ratio) * slope - residual * bend)


@_vector
def _approach(l: float, x: float, e: float) -> float:
    """Return l one step nearer to X(l) = x, by Halley's method with 2 (X - x)/(X + x) for ln(X/x)."""
    value, slope, bend = _distance(l, e, 1.0 / e)
    return l - _halley(value, slope, bend, x, 2.0 * (value - x) / (value + x) if x > 1.0 else 0.0)


@_vector
def _first_step(x: float, e: float) -> float:
    """Return l after a first step from the right limits, l ~ sqrt(2 x/(1 + e)) and l ~ ln(x)/(1 + e)."""
    p = 1.0 + e
    square = 0.5 * p * x
    l = 2.0 / p * _log1p(math.sqrt(square) + square / (1.0 + math.sqrt(1.0 + square)))  # asinh of the root
    value, slope, bend = _distance(l, e, 1.0 / e)
    return float(l - _halley(value, slope, bend, x, _log(value / x) if x > 1.0 else 0.0))


@_vector
def stable_log_tau(x: float, e: float) -> float:
    """The l >= 0 with X(l) = x >= 0: the stable branch.

    Halley's method, on X near the fold and on ln X away from it, is at rounding error after three steps for e from 2e-4
    to 400 and x up to 1e300.
    """
    return _approach(_approach(_first_step(x, e), x, e), x, e) if x > 0.0 else 0.0


@_vector
def initial_guess(x: float, n: float) -> float:
    """l after the first of these steps."""
    return _first_step(x, 2.0 * n - 1.0)


@_vector
def refined(l: float, x: float, n: float) -> float:
    """l after another step."""
    return _approach(l, x, 2.0 * n - 1.0) if x > 0.0 else 0.0


@_vector
def state(x: float, n: float) -> float:
    """l at the distance x >= 0 to the fold."""
    return stable_log_tau(x, 2.0 * n - 1.0)


@njit
def state_of_radius(radius: float, size: float, n: float) -> float:
    """l at a contact radius > 0, ``size`` = a_c, stable (l > 0) or not."""
    return 0.5 * math.log(radius / size)


@njit
def radius_of_force(x: float, n: float) -> float:
    """a/a_P at x = 1 - P/P_c >= 0, on the branch that is stable under dead load."""
    return math.exp(2.0 / 3.0 * stable_log_tau(x, (2.0 * n - 1.0) / 3.0))


@njit
def state_of_force(x: float, n: float) -> float:
    """l at x = 1 - P/P_c >= 0, on the branch that is stable under dead load, where l = (ln 3)/e at x = 0.

    Near n = 1/2 that is a large number, so that ``radius_of_force`` gives a with more digits.
    """
    e = 2.0 * n - 1.0
    return dd.LOG_3[0] / e + stable_log_tau(x, e / 3.0) / 3.0


@njit
def reduced_control(l: float, n: float) -> float:
    """X(l)."""
    e = 2.0 * n - 1.0
    return _distance(l, e, 1.0 / e)[0]


@_vector
def radius_force_stiffness(l: float, n: float) -> tuple[float, float, float]:
    """a/a_c, P over 2 E* a_c dl(a_c), and k over 2 E* a_c.

    k goes to -inf from the right at the fold l = 0, which the caller keeps away from.
    """
    tau, excess = 1.0 + _expm1(l), _expm1((2.0 * n - 1.0) * l)
    square = tau * tau
    return square, square * tau * ((excess + 1.0) / (2.0 * n + 2.0) - 1.0), square * (excess - 2.0) / excess


@njit
def radius(l: float, n: float) -> float:
    """a/a_c, at the fold as well."""
    tau = 1.0 + _expm1(l)
    return float(tau * tau)


@njit
def force(l: float, n: float) -> float:
    """P over 2 E* a_c dl(a_c)."""
    _, push, _ = radius_force_stiffness(l, n)
    return push


@njit
def stiffness(l: float, n: float) -> float:
    """k over 2 E* a_c."""
    _, _, k = radius_force_stiffness(l, n)
    return k


@njit
def energy(l: float, n: float) -> float:
    """U, elastic and surface, over 2 E* a_c dl(a_c) |delta_c|."""
    e = 2.0 * n - 1.0
    excess = math.expm1(e * l)
    return n * math.exp(4.0 * l) * (n - excess / e * (4.0 * n - excess)) / ((2.0 * n + 2.0) * (2.0 * n + 1.0))


@njit
def force_scales(effective_modulus: float, work: float, width: float, rise: float, n: float) -> tuple[Pair, float]:
    """|P_c| [N] under dead load, P_c = -2 E* a_c dl(a_c) tau_P^3 e/(2 n + 2), and a_P [m]; 0 if not representable.

    All in logarithms: near n = 1/2 these can be ordinary floats where a_c is not.
    """
    e = dd.two_sum(2.0 * n, -1.0)
    length, power = _length(effective_modulus, work)
    log_length = dd.add(dd.log(length), dd.multiply((float(power), 0.0), dd.LOG_2))
    log_radius = dd.add(dd.log((width, 0.0)), _log_growth(effective_modulus, work, width, rise, n))
    log_stretch = dd.multiply((0.5, 0.0), dd.add(log_length, log_radius))
    log_tau = dd.divide(dd.LOG_3, e)
    log_force = dd.add(dd.add(log_radius, log_stretch), dd.log((2.0 * effective_modulus, 0.0)))
    log_force = dd.add(log_force, dd.multiply((3.0, 0.0), log_tau))
    log_force = dd.add(log_force, dd.log(dd.divide(e, dd.two_sum(2.0 * n, 2.0))))
    log_radius = dd.add(log_radius, dd.multiply((2.0, 0.0), log_tau))
    if not (abs(log_force[0]) < _LOG_LARGEST and abs(log_radius[0]) < _LOG_LARGEST):
        return (0.0, 0.0), 0.0
    return dd.exp(log_force), dd.exp(log_radius)[0]

"""The integrals of a profile over a ring, a < x < c, that adhesion with a range needs, where they have a closed form:

    I = ∫ g(x)/sqrt(c^2 - x^2) dx,   K = ∫ x g'(x)/sqrt(c^2 - x^2) dx,

in units of width and rise, from t at a, a, m = sqrt(c^2 - a^2), theta = atan(m/a) = acos(a/c) and the params.

Beyond the breakpoint at x = 1, with q = sqrt(x^2 - 1) at the lower limit low = max(a, 1), M^2 = c^2 - low^2,
Q^2 = c^2 - 1 and phi = atan(M/q), profiles are sums of x, x^2, x q and x atan q, and

    ∫ x^2/sqrt(c^2 - x^2) dx = (c^2 theta + a m)/2,   ∫ x q/sqrt(c^2 - x^2) dx = (Q^2 phi + M q)/2,
    ∫ x atan(q)/sqrt(c^2 - x^2) dx = M atan q + W,   W = ∫ sqrt(c^2 - x^2)/(x q) dx = c atan(M/(q c)) - phi.

Sums are arranged so that no term is much larger than I plus g(a) theta, or than K.
"""

import math

from roughmdr.numerics.vector_math import atan, q_minus_atan
from roughmdr.shapes.profile import Params

_LARGE = 2.0  # c, from which on a square of c is too large a term of what grows as c
_SHALLOW = 0.5  # Q, up to which x q and x atan q cancel
# Gauss's rule of ten nodes for the interval from 0 to 1: what is left of it is below rounding.
_NODES = (
    0.013046735741414140, 0.067468316655507745, 0.160295215850487797, 0.283302302935376405, 0.425562830509184395,
    0.574437169490815605, 0.716697697064623595, 0.839704784149512203, 0.932531683344492255, 0.986953264258585860,
)  # fmt: skip
_WEIGHTS = (
    0.033335672154344069, 0.074725674575290296, 0.109543181257991022, 0.134633359654998178, 0.147762112357376435,
    0.147762112357376435, 0.134633359654998178, 0.109543181257991022, 0.074725674575290296, 0.033335672154344069,
)  # fmt: skip
_ROUNDING = 2.0**-53
_FRACTIONS = 400  # more than the continued fraction of any exponent needs


def _angle(across: float, along: float) -> float:
    """Return atan(across/along) for sides of at least 0, not both 0."""
    return atan(across / along) if along > 0.0 else 0.5 * math.pi


def _beyond_one(q: float, a: float, m: float) -> tuple[float, float, float, float]:
    """Return M, c, c - 1 and Q^2, for q at a, or 0 where a is at most 1; 0 for the last two where c is below 1."""
    c = math.sqrt(a * a + m * m)
    if q > 0.0:
        square = q * q + m * m
        return m, c, square / (c + 1.0), square
    square = max(m * m - (1.0 - a) * (1.0 + a), 0.0)
    return math.sqrt(square), c, square / (c + 1.0), square


def _angle_part(q: float, wide: float, c: float, above: float) -> tuple[float, float]:
    """Return W and c atan(M/(q c)), M = ``wide`` and c - 1 = ``above``."""
    angle = _angle(wide, q * c)
    return above * angle - _angle(wide * q * above, c * q * q + wide * wide), c * angle


def cone(a: float, at: float, m: float, theta: float, params: Params) -> tuple[float, float]:
    """Return I and K of g = pi/2 x."""
    return 0.5 * math.pi * m, 0.5 * math.pi * m


def power_law(t: float, a: float, m: float, theta: float, params: Params) -> tuple[float, float]:
    """Return I and K = n I of g = kappa x^n, by the continued fraction of the incomplete beta function.

    ∫ (x/c)^n/sqrt(c^2 - x^2) dx is that of cos^n from 0 to theta; up to pi/2 it is pi/(2 kappa). [1]_, 8.17.22.

    .. [1] NIST Digital Library of Mathematical Functions.
    """
    n, factor = params[0], params[1]
    c = math.sqrt(a * a + m * m)
    inner, outer = a / c, m / c
    product = inner * outer * factor * a**n
    if outer * outer * (n + 6.0) < 3.0:
        whole = product * _beta_fraction(0.5, 0.5 * (n + 1.0), outer * outer)
    else:
        whole = 0.5 * math.pi * c**n - product / (n + 1.0) * _beta_fraction(0.5 * (n + 1.0), 0.5, inner * inner)
    return whole, n * whole


def _beta_fraction(p: float, q: float, x: float) -> float:
    """Return p B_x(p, q)/(x^p (1 - x)^q), for x below (p + 1)/(p + q + 2) or a little more."""
    above, below, above_before, below_before = 1.0, 1.0, 0.0, 1.0
    before = 1.0
    for i in range(_FRACTIONS):
        at = p + 2.0 * i
        down = -(p + i) * (p + q + i) * x / (at * (at + 1.0))
        above, above_before = above + down * above_before, above
        below, below_before = below + down * below_before, below
        up = (i + 1.0) * (q - i - 1.0) * x / ((at + 1.0) * (at + 2.0))
        above, above_before = above + up * above_before, above
        below, below_before = below + up * below_before, below
        if i % 4 == 3:
            found = above / below
            if abs(found - before) <= 2.0 * _ROUNDING * found:
                return found
            before = found
            scale = 1.0 / below
            above, above_before, below_before, below = found, above_before * scale, below_before * scale, 1.0
    return above / below


def sphere(t: float, a: float, m: float, theta: float, params: Params) -> tuple[float, float]:
    """Return I and K of g = x artanh x: by parts, with e = sqrt(1 - c^2); K is infinite where c is 1."""
    square = a * a + m * m
    side = 1.0 / math.cosh(min(t, 300.0))
    rest = (side - m) * (side + m)
    if not rest > 0.0:
        return m * t + theta, math.inf
    e = math.sqrt(rest)
    less = square / (1.0 + e)
    angle = _angle(m, a * e)
    beyond = less * angle - _angle(m * a * less, e * a * a + m * m)
    return m * t + beyond, m * t + square / e * angle


def truncated_cone(q: float, a: float, m: float, theta: float, params: Params) -> tuple[float, float]:
    """Return I and K of g = x atan q, x g' = x atan q + x/q."""
    wide, c, above, _ = _beyond_one(q, a, m)
    if not above > 0.0:
        return 0.0, 0.0
    part, angle = _angle_part(q, wide, c, above)
    slope = wide * atan(q)
    return slope + part, slope + angle


def truncated_paraboloid(q: float, a: float, m: float, theta: float, params: Params) -> tuple[float, float]:
    """Return I and K of g = x q, x g' = x (1 + 2 q^2)/q."""
    wide, _, above, square = _beyond_one(q, a, m)
    if not above > 0.0:
        return 0.0, 0.0
    phi = _angle(wide, q)
    both = square * phi + wide * q
    return 0.5 * both, both + phi


def rounded_punch(q: float, a: float, m: float, theta: float, params: Params) -> tuple[float, float]:
    """Return I and K of g = x (q - atan q), x g' = x (2 q - atan q)."""
    wide, c, above, square = _beyond_one(q, a, m)
    if not above > 0.0:
        return 0.0, 0.0
    phi = _angle(wide, q)
    part, _ = _angle_part(q, wide, c, above)
    both, other = square * phi + wide * q, wide * atan(q) + part
    if q == 0.0:
        return 0.25 * math.pi * above * above, both - other
    root = math.sqrt(square)
    if root > _SHALLOW:
        return 0.5 * both - other, both - other
    whole = 0.0
    for i in range(len(_NODES)):
        at = root * math.cos(phi * _NODES[i])
        whole += _WEIGHTS[i] * q_minus_atan(at) * at
    return phi * whole, both - other


def rounded_cone(t: float, a: float, m: float, theta: float, params: Params) -> tuple[float, float]:
    """Return I and K of g = x^2, and beyond 1 of x^2 - x q + x atan q, x g' = 2 x^2 - 2 x q + x atan q."""
    q = math.sqrt((a - 1.0) * (a + 1.0)) if a > 1.0 else 0.0
    _, c, above, _ = _beyond_one(q, a, m)
    if q > 0.0:
        phi = _angle(m, q)
        turn = _angle(m, (a + q) * (a * q + m * m))  # phi - theta
        blend = m / (a + q) + phi - c * c * turn
        part, _ = _angle_part(q, m, c, above)
        slope = m * atan(q) + part
        return 0.5 * blend + slope, blend + slope
    if c > _LARGE:
        rest, line = a * m - c * c * _angle(a, m), 0.5 * math.pi * c
        return 0.5 * rest + line - 0.25 * math.pi, rest + line
    whole = c * c * theta + a * m
    return 0.5 * whole - 0.25 * math.pi * above * above, whole - 0.5 * math.pi * c * above


def capped_paraboloid(t: float, a: float, m: float, theta: float, params: Params) -> tuple[float, float]:
    """Return I and K of g = k x^2 + (1 - k) x q with the flatness k = params[0] of the cap, q = 0 up to 1."""
    k = params[0]
    q = k * (t - 1.0) if t > 1.0 else 0.0
    wide, c, above, square = _beyond_one(q, a, m)
    cap = k * (c * c * theta + a * m)
    if not above > 0.0:
        return 0.5 * cap, cap
    phi = _angle(wide, q)
    both = square * phi + wide * q
    return 0.5 * (cap + (1.0 - k) * both), cap + (1.0 - k) * (both + phi)

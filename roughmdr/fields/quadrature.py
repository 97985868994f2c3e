"""Integrals over the MDR profile with a weight, panel by panel: what the fields of a contact are made of.

g is smooth in v = sqrt(x^2 - base^2) from one edge of the profile to the next. What the weight is singular in, at x = r
or close to it, goes by one of four substitutions, and so does a base or a tip that is much smaller than the contact.
Beside them, singular places lie pi/2 away from the way in u, and Gauss's nodes meet them well. A panel on which the
last of Legendre's coefficients are not small is halved.
"""

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from roughmdr.numerics.arguments import Floats

# Names that ``specialise`` fills with the functions of a profile.
_curve: Callable[..., tuple[float, float, float, float]]
_place: Callable[..., float]

SINH, COSH, EXP, SIN = 0, 1, 2, 3
"""The ways of v: scale sinh u, scale cosh u, e^u, scale sin u."""

PRESSURE, DISPLACEMENT, STEEP, DEEP, STEEP_TURN, DEEP_TURN = 0, 1, 2, 3, 4, 5
"""The weights of dg: 1/sqrt(x^2 - r^2); asin(x/r); with d^2 = x^2 + z^2 x^3/d^4, x z^2/d^4, x^3 z/d^6, x z^3/d^6."""

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(20)
_TAIL = np.array([(k + 0.5) * _WEIGHTS * np.polynomial.legendre.Legendre.basis(k)(_NODES) for k in (18, 19)])
_LONGEST = 2.0  # panel
_ROUGH = 1e-10  # of the integral: a last coefficient of that size is its square in the integral
_NOTHING = 1e-18  # of the integral
_MOST = 20000  # panels
_TIP = 1e-12  # of the integral: what the power law may be wrong by that stands for the last part of the tip
_LEAST = -700.0  # e^-700 is a float


def slope(v: float, base: float, begin: float, rate: float, params: Floats) -> tuple[float, float]:
    """x and dg/dv at v, where t is ``begin`` + ``rate`` v; or, where ``rate`` is 0, the place of x."""
    x = math.hypot(v, base)
    if rate > 0.0:
        return x, rate * _curve(begin + rate * v, params)[3]
    _, da, _, dg = _curve(_place(x, 1.0, params), params)
    return x, (v / x) * dg / da


def weighted(
    u: float, way: int, kind: int, scale: float, base: float, far: float, begin: float, rate: float, params: Floats
) -> float:
    """The integrand over u; ``far`` is r or z."""
    if way == SINH:
        v, dv = scale * math.sinh(u), scale * math.cosh(u)
    elif way == COSH:
        v, dv = scale * math.cosh(u), scale * math.sinh(u)
    elif way == EXP:
        v = math.exp(u)
        dv = v
    else:
        v, dv = scale * math.sin(u), scale * math.cos(u)
    x, dg = slope(v, base, begin, rate, params)
    if kind == PRESSURE:
        return dg  # dv/sqrt(x^2 - r^2) is du
    if kind == DISPLACEMENT:
        return dg * dv * (math.atan2(x, dv) if way == SIN else math.asin(x / far))
    d = math.hypot(x, far)
    cosine, sine = x / d, far / d
    if kind == STEEP:
        return dg * dv * cosine * cosine * cosine / d
    if kind == DEEP:
        return dg * dv * cosine * sine * sine / d
    if kind == STEEP_TURN:
        return dg * dv * cosine * cosine * cosine * sine / d / d
    return dg * dv * cosine * sine * sine * sine / d / d


def tip(u: float, params: Floats) -> float:
    """∫ g'/x dx from 0 to e^u, were g a power law: g g'/(x g' - g)."""
    _, da, g, dg = _curve(_place(math.exp(u), 1.0, params), params)
    rise = math.exp(u) * dg / da
    return rise / (rise - g) * (g / math.exp(u)) if rise > g else 0.0


def march(
    low: float,
    high: float,
    size: float,
    way: int,
    kind: int,
    scale: float,
    base: float,
    far: float,
    begin: float,
    rate: float,
    params: Floats,
) -> tuple[float, float]:
    """The integral from low to high (way EXP: from v = 0), begun from above, and ``size`` with its size added.

    ``size`` is that of all the integral so far. NaN where the panels are too many.
    """
    total, at, step = 0.0, high, _LONGEST
    for _ in range(_MOST):
        step = min(step, at - low)
        panel, bulk, even, odd = 0.0, 0.0, 0.0, 0.0
        for i in range(_NODES.size):
            u = at - 0.5 * step * (1.0 - _NODES[i])
            value = weighted(u, way, kind, scale, base, far, begin, rate, params)
            panel += _WEIGHTS[i] * value
            bulk += _WEIGHTS[i] * abs(value)
            even += _TAIL[0, i] * value
            odd += _TAIL[1, i] * value
        panel, bulk = 0.5 * step * panel, 0.5 * step * bulk
        if not step * (abs(even) + abs(odd)) <= _ROUGH * (size + bulk):
            step *= 0.5
            continue
        total, size = total + panel, size + bulk
        if way == EXP and kind == PRESSURE and base == 0.0:
            rest = tip(at - step, params)
            if abs(tip(at, params) - panel - rest) <= _TIP * size:
                return total + rest, size
        elif way == EXP and bulk <= _NOTHING * size and (kind <= DISPLACEMENT or at < math.log(far)):
            return total, size
        if step >= at - low:
            return total, size
        if at - step < _LEAST:
            return math.nan, size
        at, step = at - step, min(2.0 * step, _LONGEST)
    return math.nan, size


PARTS: tuple[Callable[..., Any], ...] = (slope, weighted, tip, march)

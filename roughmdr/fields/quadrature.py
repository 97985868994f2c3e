"""Integrals over the MDR profile with a weight, panel by panel: the fields of a contact are made of them.

g is smooth in v = sqrt(x^2 - base^2) from one breakpoint of the profile to the next. Where the weight is singular, at
x = r or close to it, one of four substitutions removes the singularity, and so where a base or a tip is much smaller
than the contact. The nearest other singularities lie pi/2 away from the path in u, where Gauss's rule converges fast. A
panel on which the last Legendre coefficients are not small is halved.
"""

import math
from collections.abc import Callable
from types import ModuleType
from typing import NamedTuple

import numpy as np

from roughmdr.numerics.arguments import Floats

SINH, COSH, EXP, SIN = range(4)
"""Substitutions for v: scale sinh u, scale cosh u, e^u, scale sin u."""

PRESSURE, DISPLACEMENT, STEEP, DEEP, STEEP_TURN, DEEP_TURN = range(6)
"""Weights of dg: 1/sqrt(x^2 - r^2); asin(x/r); with d^2 = x^2 + z^2 x^3/d^4, x z^2/d^4, x^3 z/d^6, x z^3/d^6."""


class Integrand(NamedTuple):
    """The integrand on one piece of the profile."""

    weight: int
    far: float
    """r or z over width, of which the weight is a function."""
    substitution: int
    scale: float
    base: float
    """The profile is smooth in v = sqrt(x^2 - base^2)."""
    begin: float
    rate: float
    """t is begin + rate v; where the rate is 0 it is found from x."""


class FieldKernels(ModuleType):
    """The functions of a profile, as ``shapes.profile.Profile`` has them, and those that its fields are made of."""

    flat: bool
    mdr_profile: Callable[..., tuple[float, float, float, float]]
    t_of_radius: Callable[..., float]
    breakpoint_count: Callable[[Floats], int]
    breakpoint: Callable[[int, Floats], tuple[float, float]]

    slope_at: Callable[..., tuple[float, float]]
    weighted_slope: Callable[..., float]
    tip_integral: Callable[..., float]
    integrate: Callable[..., tuple[float, float]]
    leg: Callable[..., float]
    rate_from: Callable[..., float]
    substitute: Callable[..., tuple[int, float, float, float]]
    field: Callable[..., float]


law = FieldKernels("law")
"""Stands for the kernels of a shape in those that ``specialise`` is given."""

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(20)
_TAIL = np.array([(k + 0.5) * _WEIGHTS * np.polynomial.legendre.Legendre.basis(k)(_NODES) for k in (18, 19)])
_LONGEST_PANEL = 2.0
_ROUGH = 1e-10  # of the integral: last coefficients of this size change it by their square
_NEGLIGIBLE = 1e-18  # of the integral
_MAX_PANELS = 20000
_TIP = 1e-12  # of the integral: error of the power law that stands for the last part of the tip
_LOWEST = -700.0  # e^-700 is a float


def slope_at(v: float, integrand: Integrand, params: Floats) -> tuple[float, float]:
    """Return x and dg/dv at v."""
    x = math.hypot(v, integrand.base)
    if integrand.rate > 0.0:
        return x, integrand.rate * law.mdr_profile(integrand.begin + integrand.rate * v, params)[3]
    _, da, _, dg = law.mdr_profile(law.t_of_radius(x, 1.0, params), params)
    return x, (v / x) * dg / da


def weighted_slope(u: float, integrand: Integrand, params: Floats) -> float:
    """Return the integrand over u."""
    weight, far, substitution, scale = integrand.weight, integrand.far, integrand.substitution, integrand.scale
    if substitution == SINH:
        v, dv = scale * math.sinh(u), scale * math.cosh(u)
    elif substitution == COSH:
        v, dv = scale * math.cosh(u), scale * math.sinh(u)
    elif substitution == EXP:
        v = math.exp(u)
        dv = v
    else:
        v, dv = scale * math.sin(u), scale * math.cos(u)
    x, dg = law.slope_at(v, integrand, params)
    if weight == PRESSURE:
        return dg  # dv/sqrt(x^2 - r^2) is du
    if weight == DISPLACEMENT:
        return dg * dv * (math.atan2(x, dv) if substitution == SIN else math.asin(x / far))
    d = math.hypot(x, far)
    cosine, sine = x / d, far / d
    if weight == STEEP:
        return dg * dv * cosine * cosine * cosine / d
    if weight == DEEP:
        return dg * dv * cosine * sine * sine / d
    if weight == STEEP_TURN:
        return dg * dv * cosine * cosine * cosine * sine / d / d
    return dg * dv * cosine * sine * sine * sine / d / d


def tip_integral(u: float, params: Floats) -> float:
    """Return ∫ g'/x dx from 0 to e^u for g as a power law: g g'/(x g' - g)."""
    _, da, g, dg = law.mdr_profile(law.t_of_radius(math.exp(u), 1.0, params), params)
    rise = math.exp(u) * dg / da
    return rise / (rise - g) * (g / math.exp(u)) if rise > g else 0.0


def integrate(low: float, high: float, size: float, integrand: Integrand, params: Floats) -> tuple[float, float]:
    """Return the integral from low to high (EXP: from v = 0), and ``size`` with the integral of its magnitude added.

    ``size`` is that of the whole integral so far. Panels go from high to low. NaN where they are too many.
    """
    weight, substitution = integrand.weight, integrand.substitution
    total, at, step = 0.0, high, _LONGEST_PANEL
    for _ in range(_MAX_PANELS):
        step = min(step, at - low)
        panel, magnitude, even, odd = 0.0, 0.0, 0.0, 0.0
        for i in range(_NODES.size):
            u = at - 0.5 * step * (1.0 - _NODES[i])
            value = law.weighted_slope(u, integrand, params)
            panel += _WEIGHTS[i] * value
            magnitude += _WEIGHTS[i] * abs(value)
            even += _TAIL[0, i] * value
            odd += _TAIL[1, i] * value
        panel, magnitude = 0.5 * step * panel, 0.5 * step * magnitude
        if not step * (abs(even) + abs(odd)) <= _ROUGH * (size + magnitude):
            step *= 0.5
            continue
        total, size = total + panel, size + magnitude
        if substitution == EXP and weight == PRESSURE and integrand.base == 0.0:
            rest = law.tip_integral(at - step, params)
            if abs(law.tip_integral(at, params) - panel - rest) <= _TIP * size:
                return total + rest, size
        elif (
            substitution == EXP
            and magnitude <= _NEGLIGIBLE * size
            and (weight <= DISPLACEMENT or at < math.log(integrand.far))
        ):
            return total, size
        if step >= at - low:
            return total, size
        if at - step < _LOWEST:
            return math.nan, size
        at, step = at - step, min(2.0 * step, _LONGEST_PANEL)
    return math.nan, size

"""The fields of one contact, as the sum of all flat punches under it, of radius x and depth dg (H 42).

Profiles are in units of the shape's width and rise; radii and depths come in metres, so that their differences are
exact. g is smooth in v = sqrt(x^2 - base^2) from one breakpoint of the profile to the next. Where the weight of dg is
singular, at x = r or close to it, one of four substitutions removes the singularity, and so where a base or a tip is
much smaller than the contact. The nearest other singularities lie pi/2 away from the path in u, where Gauss's rule
converges fast. A panel on which the last Legendre coefficients are not small is halved.
"""

import math
from collections.abc import Callable
from types import ModuleType
from typing import NamedTuple

import numpy as np

from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.gauss import gauss, last_coefficients
from roughmdr.numerics.jit import compiled, once, specialise
from roughmdr.shapes import Shape
from roughmdr.shapes.power_profiles import profile_of

SINH, COSH, EXP, SIN = range(4)
"""Substitutions for v: scale sinh u, scale cosh u, e^u, scale sin u."""

PRESSURE, DISPLACEMENT, STEEP, DEEP, STEEP_TURN, DEEP_TURN = range(6)
"""Weights of dg: 1/sqrt(x^2 - r^2); asin(x/r); with d^2 = x^2 + z^2 x^3/d^4, x z^2/d^4, x^3 z/d^6, x z^3/d^6."""


class Integrand(NamedTuple):
    """The integrand on one piece of the profile."""

    weight: int
    far: float  # r or z over width, of which the weight is a function
    substitution: int
    scale: float
    base: float  # the profile is smooth in v = sqrt(x^2 - base^2)
    begin: float
    rate: float  # t is begin + rate v; where the rate is 0 it is found from x


class Piece(NamedTuple):
    """A part of the contact between two breakpoints of the profile, from ``low`` to ``high`` [m]."""

    low: float
    high: float
    base: float  # the profile is smooth in v = sqrt(x^2 - base^2), over width, from v_low to v_high
    v_low: float
    v_high: float


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


kernel = FieldKernels("kernel")
"""Stands for the kernels of a shape in the functions that ``specialise`` is given."""

_NODES, _WEIGHTS = gauss(20)
_TAIL = last_coefficients(20)
_LONGEST_PANEL = 2.0
_ROUGH = 1e-10  # last coefficients of a fine panel, over the integral: its error is about their square
_NEGLIGIBLE = 1e-18  # magnitude of a panel, over the integral, that is lost in rounding
_MAX_PANELS = 20000
_TIP = 1e-12  # error, over the integral, of the power law that replaces the profile next to the tip
_LOWEST = -700.0  # e^-700 is a float
_LINEAR = 1e-13
_COARSE = 1e-10  # largest relative change of t by the rounding of a radius
_EPSILON = float(np.finfo(np.float64).eps)


def slope_at(v: float, integrand: Integrand, params: Floats) -> tuple[float, float]:
    """Return x and dg/dv at v."""
    x = math.hypot(v, integrand.base)
    if integrand.rate > 0.0:
        return x, integrand.rate * kernel.mdr_profile(integrand.begin + integrand.rate * v, params)[3]
    _, da, _, dg = kernel.mdr_profile(kernel.t_of_radius(x, 1.0, params), params)
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
    x, dg = kernel.slope_at(v, integrand, params)
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
    _, da, g, dg = kernel.mdr_profile(kernel.t_of_radius(math.exp(u), 1.0, params), params)
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
            value = kernel.weighted_slope(u, integrand, params)
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
            rest = kernel.tip_integral(at - step, params)
            if abs(kernel.tip_integral(at, params) - panel - rest) <= _TIP * size:
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


def leg(x: float, y: float, width: float) -> float:
    """Return sqrt(x^2 - y^2) over width, for x >= y."""
    return math.sqrt((x - y) / width) * math.sqrt((x + y) / width)


def rate_from(begin: float, base: float, end: float, params: Floats) -> float:
    """Return dt/dv where t grows evenly with v = sqrt(x^2 - base^2) from ``begin`` on, else 0."""
    if begin != base or base == 0.0:
        return 0.0
    far = min(end, 1.5 * begin)
    near = 0.5 * (begin + far)
    start = kernel.t_of_radius(begin, 1.0, params)
    long = (kernel.t_of_radius(far, 1.0, params) - start) / kernel.leg(far, base, 1.0)
    short = (kernel.t_of_radius(near, 1.0, params) - start) / kernel.leg(near, base, 1.0)
    return long if abs(long - short) <= _LINEAR * long else 0.0


def substitute(weight: int, inner: bool, point: float, piece: Piece, width: float) -> tuple[int, float, float, float]:
    """Return the substitution on the inner or outer part of a piece, its bounds in u, and its scale.

    The upper bound is -inf where that part is empty.
    """
    v_low, v_high, base, foot = piece.v_low, piece.v_high, piece.base, piece.base * width
    if weight == PRESSURE and point != foot:
        if point < foot:
            substitution, scale = SINH, kernel.leg(foot, point, width)
            bottom, top = math.asinh(v_low / scale), math.asinh(v_high / scale)
        else:
            substitution, scale = COSH, kernel.leg(point, foot, width)
            bottom = math.asinh(kernel.leg(piece.low, point, width) / scale) if piece.low > point else 0.0
            top = math.asinh(kernel.leg(piece.high, point, width) / scale)
        return substitution, bottom, -math.inf if inner else top, scale
    reach = kernel.leg(point, foot, width) if weight == DISPLACEMENT else math.inf
    middle = max(v_low, min(0.5 * reach, v_high))  # beyond it x may be close to r
    if not inner:
        bottom = math.asin(middle / reach)
        top = math.atan2(v_high, kernel.leg(point, piece.high, width)) if middle < v_high else -math.inf
        return SIN, bottom, top, reach
    if not middle > v_low:
        return EXP, 0.0, -math.inf, 1.0
    if weight != PRESSURE and base > 0.0:
        return SINH, math.asinh(v_low / base), math.asinh(middle / base), base
    return EXP, math.log(v_low) if v_low > 0.0 else -math.inf, math.log(middle), 1.0


def field(point: float, weight: int, a: float, t: float, width: float, params: Floats) -> float:
    """Return the integral of a weight with dg up to the contact radius a, which is at t, for the radius r or depth z.

    NaN where floats cannot hold radii as finely as it needs them.
    """
    total, size, high, end, outermost = 0.0, 0.0, a, math.inf, True
    for index in range(kernel.breakpoint_count(params) - 1, -1 if kernel.flat else -2, -1):
        edge, base = (0.0, 0.0) if index < 0 else kernel.breakpoint(index, params)
        low = edge * width
        if weight == PRESSURE and high <= point:
            break
        if low <= a:
            rate = kernel.rate_from(edge, base, end, params)
            begin = kernel.t_of_radius(edge, 1.0, params) if edge > 0.0 else 0.0
            if outermost and rate == 0.0 and _EPSILON * a > _COARSE * kernel.mdr_profile(t, params)[1] * t * width:
                return math.nan
            v_high = (t - begin) / rate if outermost and rate > 0.0 else kernel.leg(high, base * width, width)
            piece = Piece(low, high, base, kernel.leg(low, base * width, width), v_high)
            if v_high > piece.v_low:
                for inner in (False, True):
                    substitution, bottom, top, scale = kernel.substitute(weight, inner, point, piece, width)
                    if top > bottom:
                        integrand = Integrand(weight, point / width, substitution, scale, base, begin, rate)
                        part, size = kernel.integrate(bottom, top, size, integrand, params)
                        total += part
            high, outermost = low, False
        end = edge
    return total


@once
def field_kernel(shape: type[Shape]) -> Callable[..., float]:
    """Return ``field`` compiled for a shape that is not a flat punch."""
    profile, kernels = profile_of(shape), FieldKernels(shape.name)
    kernels.flat = profile.flat
    for name in ("mdr_profile", "t_of_radius", "breakpoint_count", "breakpoint"):
        setattr(kernels, name, compiled(getattr(profile, name)))
    for part in (slope_at, weighted_slope, tip_integral, integrate, leg, rate_from, substitute, field):
        setattr(kernels, part.__name__, specialise(part, kernels))
    return kernels.field

"""The fields of one contact, as the sum of all flat punches under it, of radius x and depth dg (H 42).

In units of the shape's width and rise; radii and depths come in metres, so that their differences are exact.
"""

import math
from collections.abc import Callable
from functools import cache
from typing import NamedTuple

import numpy as np

from roughmdr.fields.quadrature import (
    COSH,
    DISPLACEMENT,
    EXP,
    PRESSURE,
    SIN,
    SINH,
    FieldKernels,
    Integrand,
    integrate,
    law,
    slope_at,
    tip_integral,
    weighted_slope,
)
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.jit import compiled, specialise
from roughmdr.shapes import Shape
from roughmdr.shapes.power_profiles import profile_of

_LINEAR = 1e-13
_COARSE = 1e-10  # of t: what the rounding of a radius may change it by
_EPSILON = float(np.finfo(np.float64).eps)


class Piece(NamedTuple):
    """A part of the contact between two breakpoints of the profile."""

    low: float
    """[m], and so ``high``."""
    high: float
    base: float
    """The profile is smooth in v = sqrt(x^2 - base^2), over width."""
    v_low: float
    v_high: float


def leg(x: float, y: float, width: float) -> float:
    """Return sqrt(x^2 - y^2) over width, for x >= y."""
    return math.sqrt((x - y) / width) * math.sqrt((x + y) / width)


def rate_from(begin: float, base: float, end: float, params: Floats) -> float:
    """Return dt/dv where t grows evenly with v = sqrt(x^2 - base^2) from ``begin`` on, else 0."""
    if begin != base or base == 0.0:
        return 0.0
    far = min(end, 1.5 * begin)
    near = 0.5 * (begin + far)
    start = law.t_of_radius(begin, 1.0, params)
    long = (law.t_of_radius(far, 1.0, params) - start) / law.leg(far, base, 1.0)
    short = (law.t_of_radius(near, 1.0, params) - start) / law.leg(near, base, 1.0)
    return long if abs(long - short) <= _LINEAR * long else 0.0


def substitute(weight: int, inner: bool, point: float, piece: Piece, width: float) -> tuple[int, float, float, float]:
    """Return the substitution on the inner or outer part of a piece, its bounds in u, and its scale.

    The upper bound is -inf where that part is empty.
    """
    v_low, v_high, base, foot = piece.v_low, piece.v_high, piece.base, piece.base * width
    if weight == PRESSURE and point != foot:
        if point < foot:
            substitution, scale = SINH, law.leg(foot, point, width)
            bottom, top = math.asinh(v_low / scale), math.asinh(v_high / scale)
        else:
            substitution, scale = COSH, law.leg(point, foot, width)
            bottom = math.asinh(law.leg(piece.low, point, width) / scale) if piece.low > point else 0.0
            top = math.asinh(law.leg(piece.high, point, width) / scale)
        return substitution, bottom, -math.inf if inner else top, scale
    reach = law.leg(point, foot, width) if weight == DISPLACEMENT else math.inf
    middle = max(v_low, min(0.5 * reach, v_high))  # beyond it x comes near to r
    if not inner:
        bottom = math.asin(middle / reach)
        top = math.atan2(v_high, law.leg(point, piece.high, width)) if middle < v_high else -math.inf
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
    for index in range(law.breakpoint_count(params) - 1, -1 if law.flat else -2, -1):
        edge, base = (0.0, 0.0) if index < 0 else law.breakpoint(index, params)
        low = edge * width
        if weight == PRESSURE and high <= point:
            break
        if low <= a:
            rate = law.rate_from(edge, base, end, params)
            begin = law.t_of_radius(edge, 1.0, params) if edge > 0.0 else 0.0
            if outermost and rate == 0.0 and _EPSILON * a > _COARSE * law.mdr_profile(t, params)[1] * t * width:
                return math.nan
            v_high = (t - begin) / rate if outermost and rate > 0.0 else law.leg(high, base * width, width)
            piece = Piece(low, high, base, law.leg(low, base * width, width), v_high)
            if v_high > piece.v_low:
                for inner in (False, True):
                    substitution, bottom, top, scale = law.substitute(weight, inner, point, piece, width)
                    if top > bottom:
                        integrand = Integrand(weight, point / width, substitution, scale, base, begin, rate)
                        part, size = law.integrate(bottom, top, size, integrand, params)
                        total += part
            high, outermost = low, False
        end = edge
    return total


@cache
def build(shape: type[Shape]) -> Callable[..., float]:
    """Return ``field`` for a shape that is not a flat punch."""
    profile, kernels = profile_of(shape), FieldKernels(shape.name)
    kernels.flat = profile.flat
    for name in ("mdr_profile", "t_of_radius", "breakpoint_count", "breakpoint"):
        setattr(kernels, name, compiled(getattr(profile, name)))
    parts: tuple[Callable[..., object], ...] = (slope_at, weighted_slope, tip_integral, integrate, leg, rate_from)
    for part in (*parts, substitute, field):
        setattr(kernels, part.__name__, specialise(part, kernels))
    return kernels.field

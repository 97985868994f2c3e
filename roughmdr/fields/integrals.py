"""The fields of one curved contact: what all flat punches under it, of radius x and depth dg, add up to (H 42).

In units of the shape's width and rise; radii and depths come in metres, so that their differences are exact.
"""

import math
from collections.abc import Callable
from functools import cache
from types import FunctionType
from typing import Any, cast

import numpy as np

from roughmdr.fields import quadrature
from roughmdr.fields.quadrature import COSH, DISPLACEMENT, EXP, PRESSURE, SIN, SINH
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.jit import compiled, specialise
from roughmdr.shapes import Shape
from roughmdr.shapes.power_profiles import profile_of

# Names that ``specialise`` fills.
_FLAT: bool
_curve: Callable[..., tuple[float, float, float, float]]
_place: Callable[..., float]
_edge_count: Callable[..., int]
_edge: Callable[..., tuple[float, float]]
march: Callable[..., tuple[float, float]]

_LINEAR = 1e-13
_COARSE = 1e-10  # of t: what the rounding of a radius may change it by
_EPSILON = float(np.finfo(np.float64).eps)


def leg(x: float, y: float, width: float) -> float:
    """sqrt(x^2 - y^2) over width, for x >= y."""
    return math.sqrt((x - y) / width) * math.sqrt((x + y) / width)


def rate_from(begin: float, base: float, end: float, params: Floats) -> float:
    """dt/dv where t grows evenly with v = sqrt(x^2 - base^2) from ``begin`` on, else 0."""
    if begin != base or base == 0.0:
        return 0.0
    far = min(end, 1.5 * begin)
    near = 0.5 * (begin + far)
    start = _place(begin, 1.0, params)
    long = (_place(far, 1.0, params) - start) / leg(far, base, 1.0)
    short = (_place(near, 1.0, params) - start) / leg(near, base, 1.0)
    return long if abs(long - short) <= _LINEAR * long else 0.0


def span(
    kind: int,
    inner: bool,
    point: float,
    low: float,
    high: float,
    v_low: float,
    v_high: float,
    base: float,
    width: float,
) -> tuple[int, float, float, float]:
    """The way of v on a piece, from which u to which, and its scale; all of it in two parts, inner and outer."""
    foot = base * width
    if kind == PRESSURE and point != foot:
        if point < foot:
            way, scale = SINH, leg(foot, point, width)
            bottom, top = math.asinh(v_low / scale), math.asinh(v_high / scale)
        else:
            way, scale = COSH, leg(point, foot, width)
            bottom = math.asinh(leg(low, point, width) / scale) if low > point else 0.0
            top = math.asinh(leg(high, point, width) / scale)
        return way, bottom, -math.inf if inner else top, scale
    reach = leg(point, foot, width) if kind == DISPLACEMENT else math.inf
    middle = max(v_low, min(0.5 * reach, v_high))  # beyond it x comes near to r
    if not inner:
        bottom = math.asin(middle / reach)
        return SIN, bottom, math.atan2(v_high, leg(point, high, width)) if middle < v_high else -math.inf, reach
    if not middle > v_low:
        return EXP, 0.0, -math.inf, 1.0
    if kind != PRESSURE and base > 0.0:
        return SINH, math.asinh(v_low / base), math.asinh(middle / base), base
    return EXP, math.log(v_low) if v_low > 0.0 else -math.inf, math.log(middle), 1.0


def field(point: float, kind: int, a: float, t: float, width: float, params: Floats) -> float:
    """The integral of the weight ``kind`` with dg to the contact radius a, which is at t, for the radius r or depth z.

    NaN where floats cannot hold radii as finely as it needs them.
    """
    total, size, high, end, outermost = 0.0, 0.0, a, math.inf, True
    for index in range(_edge_count(params) - 1, -1 if _FLAT else -2, -1):
        edge, base = (0.0, 0.0) if index < 0 else _edge(index, params)
        low = edge * width
        if kind == PRESSURE and high <= point:
            break
        if low <= a:
            rate, begin = rate_from(edge, base, end, params), _place(edge, 1.0, params) if edge > 0.0 else 0.0
            if outermost and rate == 0.0 and _EPSILON * a > _COARSE * _curve(t, params)[1] * t * width:
                return math.nan
            v_high = (t - begin) / rate if outermost and rate > 0.0 else leg(high, base * width, width)
            v_low = leg(low, base * width, width)
            if v_high > v_low:
                for inner in (False, True):
                    way, bottom, top, scale = span(kind, inner, point, low, high, v_low, v_high, base, width)
                    if top > bottom:
                        far = point / width
                        part, size = march(bottom, top, size, way, kind, scale, base, far, begin, rate, params)
                        total += part
            high, outermost = low, False
        end = edge
    return total


@cache
def build(shape: type[Shape]) -> Callable[..., float]:
    """``field`` of a shape that is not a flat punch."""
    profile = profile_of(shape)
    kernels: dict[str, Any] = {
        "_FLAT": profile.flat,
        "_curve": compiled(profile.mdr_profile),
        "_place": compiled(profile.t_of_radius),
        "_edge_count": compiled(profile.breakpoint_count),
        "_edge": compiled(profile.breakpoint),
    }
    parts: tuple[Callable[..., Any], ...] = (*quadrature.PARTS, leg, rate_from, span, field)
    for part in parts:
        kernels[part.__name__] = specialise(cast(FunctionType, part), shape.name, kernels)
    return cast(Callable[..., float], kernels["field"])

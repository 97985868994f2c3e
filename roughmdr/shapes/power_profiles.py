"""The ``Profile`` of each shape, for kernels that need nothing else of it; here those of the power laws (H 12, 26)."""

import math
from typing import Any

from roughmdr.shapes import Shape, zone_integrals
from roughmdr.shapes.base import ProfileShape
from roughmdr.shapes.kappa import kappa
from roughmdr.shapes.power import Cone, Paraboloid, PowerLaw
from roughmdr.shapes.profile import Params, Profile


def _paraboloid_mdr_profile(a: float, params: Params) -> tuple[float, float, float, float]:
    return a, 1.0, 2.0 * a * a, 4.0 * a


def _paraboloid_reduced_load(a: float, params: Params) -> float:
    return 4.0 / 3.0 * (a * a * a)


def _paraboloid_f_and_slope(r: float, params: Params) -> tuple[float, float]:
    return r * r, 2.0 * r


def _paraboloid_elastic_integral(a: float, params: Params) -> float:
    square = a * a
    return 32.0 / 15.0 * (square * square * a)


def _cone_mdr_profile(a: float, params: Params) -> tuple[float, float, float, float]:
    return a, 1.0, 0.5 * math.pi * a, 0.5 * math.pi


def _cone_reduced_load(a: float, params: Params) -> float:
    return 0.25 * math.pi * (a * a)


def _cone_f_and_slope(r: float, params: Params) -> tuple[float, float]:
    return r, 1.0


def _cone_elastic_integral(a: float, params: Params) -> float:
    return math.pi * math.pi / 12.0 * (a * a * a)


def _power_mdr_profile(a: float, params: Params) -> tuple[float, float, float, float]:
    """Return the profile from params = (n, kappa(n))."""
    g = params[1] * a ** params[0]
    return a, 1.0, g, params[0] * g / a


def _power_reduced_load(a: float, params: Params) -> float:
    return params[0] / (params[0] + 1.0) * params[1] * a ** params[0] * a


def _power_f_and_slope(r: float, params: Params) -> tuple[float, float]:
    n = params[0]
    if r > 0.0:
        f = r**n
        return f, n * f / r
    return 0.0, math.inf if n < 1.0 else (1.0 if n == 1.0 else 0.0)


def _power_elastic_integral(a: float, params: Params) -> float:
    n, g = params[0], params[1] * a ** params[0]
    return 2.0 * n * n / (n + 1.0) / (2.0 * n + 1.0) * (g * g * a)


def _power_roundings(params: Params) -> float:
    """Return the roundings of any power, and n times that of t."""
    return 14.0 + params[0]


def _power_precompute(params: Any) -> None:
    params[1] = kappa(params[0])


_POWERS: dict[type[Shape], Profile] = {
    Paraboloid: Profile(
        _paraboloid_mdr_profile,
        _paraboloid_reduced_load,
        _paraboloid_f_and_slope,
        elastic_integral=_paraboloid_elastic_integral,
    ),
    Cone: Profile(
        _cone_mdr_profile,
        _cone_reduced_load,
        _cone_f_and_slope,
        elastic_integral=_cone_elastic_integral,
        zone_integrals=zone_integrals.cone,
    ),
    PowerLaw: Profile(
        _power_mdr_profile,
        _power_reduced_load,
        _power_f_and_slope,
        elastic_integral=_power_elastic_integral,
        zone_integrals=zone_integrals.power_law,
        roundings=_power_roundings,
        precompute=_power_precompute,
    ),
}


def profile_of(shape: type[Shape]) -> Profile:
    """Return the profile of a shape that is not a flat punch."""
    return shape.profile if issubclass(shape, ProfileShape) else _POWERS[shape]

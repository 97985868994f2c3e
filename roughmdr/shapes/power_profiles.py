"""The profile of every shape, for kernels that need to know nothing else of it; here the power laws' (H 12, 26)."""

import math
from typing import Any

from roughmdr.shapes import Shape
from roughmdr.shapes.base import ProfileShape
from roughmdr.shapes.kappa import kappa
from roughmdr.shapes.power import Cone, Paraboloid, PowerLaw
from roughmdr.shapes.profile import Form, Profile


def _place(radius: float, width: float, form: Form) -> float:
    return radius / width


def _paraboloid_curve(a: float, form: Form) -> tuple[float, float, float, float]:
    return a, 1.0, 2.0 * a * a, 4.0 * a


def _paraboloid_push(a: float, form: Form) -> float:
    return 4.0 / 3.0 * (a * a * a)


def _paraboloid_swept(a: float, form: Form) -> float:
    return 2.0 / 3.0 * (a * a * a)


def _paraboloid_height(r: float, form: Form) -> tuple[float, float]:
    return r * r, 2.0 * r


def _paraboloid_strain(a: float, form: Form) -> float:
    square = a * a
    return 32.0 / 15.0 * (square * square * a)


def _cone_curve(a: float, form: Form) -> tuple[float, float, float, float]:
    return a, 1.0, 0.5 * math.pi * a, 0.5 * math.pi


def _cone_push(a: float, form: Form) -> float:
    return 0.25 * math.pi * (a * a)


def _cone_height(r: float, form: Form) -> tuple[float, float]:
    return r, 1.0


def _cone_strain(a: float, form: Form) -> float:
    return math.pi * math.pi / 12.0 * (a * a * a)


def _power_curve(a: float, form: Form) -> tuple[float, float, float, float]:
    """The form is the exponent n, and kappa(n)."""
    g = form[1] * a ** form[0]
    return a, 1.0, g, form[0] * g / a


def _power_push(a: float, form: Form) -> float:
    return form[0] / (form[0] + 1.0) * form[1] * a ** form[0] * a


def _power_swept(a: float, form: Form) -> float:
    return form[1] * a ** form[0] * a / (form[0] + 1.0)


def _power_height(r: float, form: Form) -> tuple[float, float]:
    n = form[0]
    if r > 0.0:
        f = r**n
        return f, n * f / r
    return 0.0, math.inf if n < 1.0 else (1.0 if n == 1.0 else 0.0)


def _power_strain(a: float, form: Form) -> float:
    n, g = form[0], form[1] * a ** form[0]
    return 2.0 * n * n / (n + 1.0) / (2.0 * n + 1.0) * (g * g * a)


def _power_roundings(form: Form) -> float:
    """Those of any profile, and of t in its power."""
    return 14.0 + form[0]


def _power_ready(form: Any) -> None:
    form[1] = kappa(form[0])


_POWERS: dict[type[Shape], Profile] = {
    Paraboloid: Profile(
        _paraboloid_curve, _paraboloid_push, _paraboloid_swept, _place, _paraboloid_height, strain=_paraboloid_strain
    ),
    Cone: Profile(_cone_curve, _cone_push, _cone_push, _place, _cone_height, strain=_cone_strain),
    PowerLaw: Profile(
        _power_curve,
        _power_push,
        _power_swept,
        _place,
        _power_height,
        strain=_power_strain,
        roundings=_power_roundings,
        ready=_power_ready,
    ),
}


def profile_of(shape: type[Shape]) -> Profile:
    """The profile of a shape that is not a flat punch."""
    return shape.profile if issubclass(shape, ProfileShape) else _POWERS[shape]

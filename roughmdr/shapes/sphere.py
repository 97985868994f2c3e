"""The sphere itself, not the paraboloid that stands for it in the theories of Hertz and JKR."""

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.vector_math import expm1, t_minus_tanh, tanh
from roughmdr.shapes.base import ProfileShape, radii
from roughmdr.shapes.profile import Params, Profile


def _mdr_profile(t: float, params: Params) -> tuple[float, float, float, float]:
    """a = tanh t, g = a artanh a."""
    growth = expm1(2.0 * min(t, 300.0))
    a = growth / (growth + 2.0)
    narrowing = 4.0 * (growth + 1.0) / (growth + 2.0) / (growth + 2.0)  # 1 - a^2
    return a, narrowing, a * t, a + t * narrowing


def _reduced_load(t: float, params: Params) -> float:
    """[(1 + a^2) artanh a - a]/2."""
    a = tanh(t)
    return 0.5 * (t_minus_tanh(t, a) + a * a * t)


def _mdr_integral(t: float, params: Params) -> float:
    """[(a^2 - 1) artanh a + a]/2."""
    a = tanh(t)
    return 0.5 * (a * a * t - t_minus_tanh(t, a))


def _roundings(params: Params) -> float:
    """Those of any profile, and of t - tanh t where that is not yet a series."""
    return 40.0


def _f_and_slope(r: float, params: Params) -> tuple[float, float]:
    side = math.sqrt(max((1.0 - r) * (1.0 + r), 0.0))
    return r * r / (1.0 + side), r / side if side > 0.0 else math.inf


def _t_of_radius(radius: float, width: float, params: Params) -> float:
    return 0.5 * math.log1p(2.0 * radius / (width - radius)) if radius < width else math.inf


@dataclass(frozen=True)
class Sphere(ProfileShape):
    """f = R - sqrt(R^2 - r^2), r <= R [m]; its contact radius stays below R. ShapeError unless R > 0."""

    radius: float

    name: ClassVar[str] = "sphere"
    units: ClassVar[dict[str, str]] = {"radius": "m"}
    spellings: ClassVar[tuple[tuple[str, ...], ...]] = (("radius",),)
    profile: ClassVar[Profile] = Profile(
        _mdr_profile, _reduced_load, _mdr_integral, _t_of_radius, _f_and_slope, end=1.0, roundings=_roundings
    )

    def f(self, r: ArrayLike) -> Floats:
        r = radii("r", r, most=self.radius)
        return np.asarray(r * (r / (self.radius + np.sqrt((self.radius - r) * (self.radius + r)))))

    @classmethod
    def slopes(cls, parameters: dict[str, Floats], r: Floats) -> Floats:
        radius = parameters["radius"]
        with np.errstate(divide="ignore"):  # at the equator it is vertical
            return np.asarray(r / np.sqrt((radius - r).clip(min=0.0) * (radius + r)))

    @classmethod
    def ends(cls, parameters: dict[str, Floats]) -> Floats:
        return parameters["radius"]

    @classmethod
    def nondimensionalise(cls, parameters: dict[str, Floats]) -> tuple[Floats, Floats, Floats]:
        """R, R and nothing."""
        radius = parameters["radius"]
        return radius, radius, np.zeros_like(radius)

"""The sphere itself, not the paraboloid that stands for it in the theories of Hertz and JKR."""

import math
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.vector_math import expm1, t_minus_tanh, tanh
from roughmdr.shapes import zone_integrals
from roughmdr.shapes.base import ProfileShape, check_radii
from roughmdr.shapes.profile import Params, Profile


def _mdr_profile(t: float, params: Params) -> tuple[float, float, float, float]:
    """g = a artanh a with a = tanh t."""
    growth = expm1(2.0 * min(t, 300.0))
    a = growth / (growth + 2.0)
    slope = 4.0 * (growth + 1.0) / (growth + 2.0) / (growth + 2.0)  # 1 - a^2
    return a, slope, a * t, a + t * slope


def _reduced_load(t: float, params: Params) -> float:
    """[(1 + a^2) artanh a - a]/2."""
    a = tanh(t)
    return 0.5 * (t_minus_tanh(t, a) + a * a * t)


def _roundings(params: Params) -> float:
    """Allow for t - tanh t where that is not yet a series."""
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

    name = "sphere"
    papers: ClassVar[dict[str, str]] = {"Hertz1882": "contact"}
    similar = True
    units: ClassVar[dict[str, str]] = {"radius": "m"}
    body_radius = ("radius",)
    profile = Profile(
        _mdr_profile,
        _reduced_load,
        _f_and_slope,
        _t_of_radius,
        end=1.0,
        roundings=_roundings,
        zone_integrals=zone_integrals.sphere,
    )

    # Next to the equator r/R has too few digits for f and f'.
    def f(self, r: ArrayLike) -> Floats:
        r = check_radii("r", r, self.limit)
        return np.asarray(r * (r / (self.radius + np.sqrt((self.radius - r) * (self.radius + r)))))

    @classmethod
    def slopes(cls, columns: tuple[Any, Any, Any], r: Floats) -> Floats:
        radius = columns[0]
        with np.errstate(divide="ignore"):  # at the equator it is vertical
            return np.asarray(r / np.sqrt((radius - r).clip(min=0.0) * (radius + r)))

    @classmethod
    def nondimensionalise(cls, parameters: dict[str, Floats]) -> tuple[Floats, Floats, Floats]:
        """Width and rise R."""
        radius = parameters["radius"]
        return radius, radius, np.zeros_like(radius)

"""Profiles with a flat tip that ends in a corner: the truncated cone and the truncated paraboloid."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.vector_math import atan, q_minus_atan, sqrt
from roughmdr.shapes.base import ProfileShape, radii
from roughmdr.shapes.profile import Params, Profile, breakpoint_at_one, one_breakpoint, swung

# Where sqrt(a) g'(a), infinite at the corner, ends to fall: q^3 atan q + q^2 = 2; 6 q^4 + 3 q^2 = 2 in 12 q^2 + 3.
_CONE_DIP = 1.0424561234141570
_PARABOLOID_DIP = 0.61575390344349083


def _one(params: Params) -> int:
    return 1


def _t_of_radius(radius: float, width: float, params: Params) -> float:
    return swung(radius, width)


def _t_of_q(q: float, params: Params) -> float:
    return q


def _cone_mdr_profile(q: float, params: Params) -> tuple[float, float, float, float]:
    """g = a acos(1/a) = a atan q, a = sqrt(1 + q^2)."""
    a, angle = sqrt(1.0 + q * q), atan(q)
    return a, q / a, a * angle, (q * angle + 1.0) / a


def _cone_reduced_load(q: float, params: Params) -> float:
    return 0.5 * ((1.0 + q * q) * atan(q) + q)


def _cone_mdr_integral(q: float, params: Params) -> float:
    return 0.5 * (q * q * atan(q) - q_minus_atan(q))


def _cone_f_and_slope(r: float, params: Params) -> tuple[float, float]:
    return (r - 1.0, 1.0) if r > 1.0 else (0.0, 0.0)


def _cone_softening_interval(index: int, params: Params) -> tuple[float, float]:
    return 0.0, _CONE_DIP


@dataclass(frozen=True)
class TruncatedCone(ProfileShape):
    """A flat of radius b [m], then f = S (r - b) with slope S [1]. ShapeError unless both are > 0."""

    slope: float
    flat_radius: float

    name: ClassVar[str] = "truncated_cone"
    units: ClassVar[dict[str, str]] = {"slope": "1", "flat_radius": "m"}
    spellings: ClassVar[tuple[tuple[str, ...], ...]] = (("slope", "flat_radius"),)
    profile: ClassVar[Profile] = Profile(
        _cone_mdr_profile,
        _cone_reduced_load,
        _cone_mdr_integral,
        _t_of_radius,
        _cone_f_and_slope,
        _one,
        _cone_softening_interval,
        corner=True,
        flat=True,
        breakpoint_count=one_breakpoint,
        breakpoint=breakpoint_at_one,
        t_of_q=_t_of_q,
    )

    def f(self, r: ArrayLike) -> Floats:
        return np.asarray(self.slope * (radii("r", r) - self.flat_radius).clip(min=0.0))

    @classmethod
    def slopes(cls, parameters: dict[str, Floats], r: Floats) -> Floats:
        return np.where(r > parameters["flat_radius"], parameters["slope"], 0.0)

    @classmethod
    def nondimensionalise(cls, parameters: dict[str, Floats]) -> tuple[Floats, Floats, Floats]:
        """b, S b and nothing."""
        flat = parameters["flat_radius"]
        return flat, parameters["slope"] * flat, np.zeros_like(flat)


def _paraboloid_mdr_profile(q: float, params: Params) -> tuple[float, float, float, float]:
    """g = a q."""
    a = sqrt(1.0 + q * q)
    return a, q / a, a * q, (1.0 + 2.0 * q * q) / a


def _paraboloid_reduced_load(q: float, params: Params) -> float:
    return q + 2.0 * q * q * q / 3.0


def _paraboloid_mdr_integral(q: float, params: Params) -> float:
    return q * q * q / 3.0


def _paraboloid_f_and_slope(r: float, params: Params) -> tuple[float, float]:
    return (0.5 * (r - 1.0) * (r + 1.0), r) if r > 1.0 else (0.0, 0.0)


def _paraboloid_softening_interval(index: int, params: Params) -> tuple[float, float]:
    return 0.0, _PARABOLOID_DIP


@dataclass(frozen=True)
class TruncatedParaboloid(ProfileShape):
    """A flat of radius b [m], then f = (r^2 - b^2)/(2 R), R [m]. ShapeError unless both are > 0."""

    radius: float
    flat_radius: float

    name: ClassVar[str] = "truncated_paraboloid"
    units: ClassVar[dict[str, str]] = {"radius": "m", "flat_radius": "m"}
    spellings: ClassVar[tuple[tuple[str, ...], ...]] = (("radius", "flat_radius"),)
    profile: ClassVar[Profile] = Profile(
        _paraboloid_mdr_profile,
        _paraboloid_reduced_load,
        _paraboloid_mdr_integral,
        _t_of_radius,
        _paraboloid_f_and_slope,
        _one,
        _paraboloid_softening_interval,
        corner=True,
        flat=True,
        breakpoint_count=one_breakpoint,
        breakpoint=breakpoint_at_one,
        t_of_q=_t_of_q,
    )

    def f(self, r: ArrayLike) -> Floats:
        r, b = radii("r", r), self.flat_radius
        return np.asarray((r - b).clip(min=0.0) * ((r + b) / (2.0 * self.radius)))

    @classmethod
    def slopes(cls, parameters: dict[str, Floats], r: Floats) -> Floats:
        return np.where(r > parameters["flat_radius"], r / parameters["radius"], 0.0)

    @classmethod
    def ends(cls, parameters: dict[str, Floats]) -> Floats:
        return parameters["radius"]

    @classmethod
    def nondimensionalise(cls, parameters: dict[str, Floats]) -> tuple[Floats, Floats, Floats]:
        """b, b^2/R and nothing."""
        flat = parameters["flat_radius"]
        return flat, flat * (flat / parameters["radius"]), np.zeros_like(flat)

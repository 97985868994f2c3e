"""Profiles with a rounded tip or edge: the rounded cone and the rounded punch."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.vector_math import atan, atan_minus_cubic, q_minus_atan, sqrt
from roughmdr.shapes.base import ProfileShape, radii
from roughmdr.shapes.profile import Params, Profile, breakpoint_at_one, one_breakpoint, swung

_CONE_DIP = 1.1053618248293666  # where sqrt(a) [2/(a + q) + atan q] is least


def _cone_mdr_profile(a: float, params: Params) -> tuple[float, float, float, float]:
    """g = a^2; beyond the blend g = a (a - q) + a atan q, q = sqrt(a^2 - 1)."""
    if a <= 1.0:
        return a, 1.0, a * a, 2.0 * a
    q = sqrt((a - 1.0) * (a + 1.0))
    angle = atan(q)
    return a, 1.0, a / (a + q) + a * angle, 2.0 / (a + q) + angle


def _cone_reduced_load(a: float, params: Params) -> float:
    if a <= 1.0:
        return 2.0 * a * a * a / 3.0
    q = sqrt((a - 1.0) * (a + 1.0))
    return 0.5 * (a * a * atan(q) + q) + (2.0 * a + q) / (a + q) / (a + q) / 3.0


def _cone_mdr_integral(a: float, params: Params) -> float:
    if a <= 1.0:
        return a * a * a / 3.0
    q = sqrt((a - 1.0) * (a + 1.0))
    return (a * a + a * q + q * q) / (a + q) / 3.0 + 0.5 * (q * q * atan(q) - q_minus_atan(q))


def _cone_f_and_slope(r: float, params: Params) -> tuple[float, float]:
    return (0.5 * r * r, r) if r < 1.0 else (r - 0.5, 1.0)


def _cone_t_of_radius(radius: float, width: float, params: Params) -> float:
    return radius / width


def _one(params: Params) -> int:
    return 1


def _cone_softening_interval(index: int, params: Params) -> tuple[float, float]:
    return 1.0, _CONE_DIP


def _at_the_blend(low: float, high: float, params: Params) -> bool:
    return low < 1.0 < high


@dataclass(frozen=True)
class RoundedCone(ProfileShape):
    """f = S r^2/(2 b) to the blend radius b [m], then a cone of slope S [1]. ShapeError unless both are > 0."""

    slope: float
    blend_radius: float

    name: ClassVar[str] = "rounded_cone"
    units: ClassVar[dict[str, str]] = {"slope": "1", "blend_radius": "m"}
    spellings: ClassVar[tuple[tuple[str, ...], ...]] = (("slope", "blend_radius"),)
    profile: ClassVar[Profile] = Profile(
        _cone_mdr_profile,
        _cone_reduced_load,
        _cone_mdr_integral,
        _cone_t_of_radius,
        _cone_f_and_slope,
        _one,
        _cone_softening_interval,
        _at_the_blend,
        breakpoint_count=one_breakpoint,
        breakpoint=breakpoint_at_one,
    )

    def f(self, r: ArrayLike) -> Floats:
        r, b = radii("r", r), self.blend_radius
        return np.asarray(self.slope * np.where(r < b, r * (r / (2.0 * b)), r - 0.5 * b))

    @classmethod
    def slopes(cls, parameters: dict[str, Floats], r: Floats) -> Floats:
        return np.asarray(parameters["slope"] * np.minimum(r / parameters["blend_radius"], 1.0))

    @classmethod
    def nondimensionalise(cls, parameters: dict[str, Floats]) -> tuple[Floats, Floats, Floats]:
        """b, S b and nothing."""
        blend = parameters["blend_radius"]
        return blend, parameters["slope"] * blend, np.zeros_like(blend)


def _punch_mdr_profile(q: float, params: Params) -> tuple[float, float, float, float]:
    """g = a (q - atan q), a = sqrt(1 + q^2)."""
    a, excess = sqrt(1.0 + q * q), q_minus_atan(q)
    return a, q / a, a * excess, q * (excess + q) / a


def _punch_reduced_load(q: float, params: Params) -> float:
    return q * q * q / 6.0 + 0.5 * (1.0 + q * q) * q_minus_atan(q)


def _punch_mdr_integral(q: float, params: Params) -> float:
    return 0.5 * (q * q * q_minus_atan(q) - atan_minus_cubic(q))


def _punch_roundings(params: Params) -> float:
    """Those of any profile, and of q - atan q where that is not yet a series."""
    return 80.0


def _punch_t_of_q(q: float, params: Params) -> float:
    return q


def _punch_f_and_slope(r: float, params: Params) -> tuple[float, float]:
    return (0.5 * (r - 1.0) * (r - 1.0), r - 1.0) if r > 1.0 else (0.0, 0.0)


def _punch_t_of_radius(radius: float, width: float, params: Params) -> float:
    return swung(radius, width)


@dataclass(frozen=True)
class RoundedPunch(ProfileShape):
    """A flat of radius b [m], then f = (r - b)^2/(2 R), R [m] the radius of its edge. ShapeError unless both > 0."""

    flat_radius: float
    edge_radius: float

    name: ClassVar[str] = "rounded_punch"
    units: ClassVar[dict[str, str]] = {"flat_radius": "m", "edge_radius": "m"}
    spellings: ClassVar[tuple[tuple[str, ...], ...]] = (("flat_radius", "edge_radius"),)
    profile: ClassVar[Profile] = Profile(
        _punch_mdr_profile,
        _punch_reduced_load,
        _punch_mdr_integral,
        _punch_t_of_radius,
        _punch_f_and_slope,
        flat=True,
        breakpoint_count=one_breakpoint,
        breakpoint=breakpoint_at_one,
        t_of_q=_punch_t_of_q,
        roundings=_punch_roundings,
    )

    def f(self, r: ArrayLike) -> Floats:
        beyond = (radii("r", r) - self.flat_radius).clip(min=0.0)
        return np.asarray(beyond * (beyond / (2.0 * self.edge_radius)))

    @classmethod
    def slopes(cls, parameters: dict[str, Floats], r: Floats) -> Floats:
        return np.asarray((r - parameters["flat_radius"]).clip(min=0.0) / parameters["edge_radius"])

    @classmethod
    def ends(cls, parameters: dict[str, Floats]) -> Floats:
        return np.asarray(parameters["flat_radius"] + parameters["edge_radius"])

    @classmethod
    def nondimensionalise(cls, parameters: dict[str, Floats]) -> tuple[Floats, Floats, Floats]:
        """b, b^2/R and nothing."""
        flat = parameters["flat_radius"]
        return flat, flat * (flat / parameters["edge_radius"]), np.zeros_like(flat)

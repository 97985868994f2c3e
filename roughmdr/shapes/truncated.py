"""Profiles with a flat tip that ends in a corner: the truncated cone and the truncated paraboloid; t is q."""

from dataclasses import dataclass
from functools import partial
from typing import ClassVar

import numpy as np

from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.vector_math import atan, q_minus_atan, sqrt
from roughmdr.shapes.base import ProfileShape
from roughmdr.shapes.profile import Params, Profile, one, q_of_radius, t_is_q

# Where sqrt(a) g'(a), infinite at the corner, ends to fall: q^3 atan q + q^2 = 2; 6 q^4 + 3 q^2 = 2 in 12 q^2 + 3.
_CONE_SOFTENING_END = 1.0424561234141570
_PARABOLOID_SOFTENING_END = 0.61575390344349083

_TruncatedProfile = partial(
    Profile, t_of_radius=q_of_radius, t_of_q=t_is_q, softening_count=one, corner=True, flat=True, breakpoint_count=one
)


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
    return 0.0, _CONE_SOFTENING_END


@dataclass(frozen=True)
class TruncatedCone(ProfileShape):
    """A flat of radius b [m], then f = S (r - b) with slope S [1]. ShapeError unless both are > 0."""

    slope: float
    flat_radius: float

    name = "truncated_cone"
    units: ClassVar[dict[str, str]] = {"slope": "1", "flat_radius": "m"}
    profile = _TruncatedProfile(
        _cone_mdr_profile,
        _cone_reduced_load,
        _cone_f_and_slope,
        softening_interval=_cone_softening_interval,
        mdr_integral=_cone_mdr_integral,
    )

    @classmethod
    def nondimensionalise(cls, parameters: dict[str, Floats]) -> tuple[Floats, Floats, Floats]:
        """Width b and rise S b."""
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
    return 0.0, _PARABOLOID_SOFTENING_END


@dataclass(frozen=True)
class TruncatedParaboloid(ProfileShape):
    """A flat of radius b [m], then f = (r^2 - b^2)/(2 R), R [m]. ShapeError unless both are > 0."""

    radius: float
    flat_radius: float

    name = "truncated_paraboloid"
    units: ClassVar[dict[str, str]] = {"radius": "m", "flat_radius": "m"}
    body_radius = ("radius",)
    profile = _TruncatedProfile(
        _paraboloid_mdr_profile,
        _paraboloid_reduced_load,
        _paraboloid_f_and_slope,
        softening_interval=_paraboloid_softening_interval,
        mdr_integral=_paraboloid_mdr_integral,
    )

    @classmethod
    def nondimensionalise(cls, parameters: dict[str, Floats]) -> tuple[Floats, Floats, Floats]:
        """Width b and rise b^2/R."""
        flat = parameters["flat_radius"]
        return flat, flat * (flat / parameters["radius"]), np.zeros_like(flat)

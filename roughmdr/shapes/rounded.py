"""Profiles with a rounded tip or edge: the rounded cone and the rounded punch."""

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.vector_math import atan, atan_minus_cubic, q_minus_atan, sqrt
from roughmdr.shapes.base import ProfileShape, check_radii
from roughmdr.shapes.profile import Params, Profile, kink_at_one, one, q_of_radius, t_is_q

_CONE_SOFTENING_END = 1.1053618248293666  # where sqrt(a) [2/(a + q) + atan q] is least


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


def _cone_f_and_slope(r: float, params: Params) -> tuple[float, float]:
    return (0.5 * r * r, r) if r < 1.0 else (r - 0.5, 1.0)


def _cone_softening_interval(index: int, params: Params) -> tuple[float, float]:
    return 1.0, _CONE_SOFTENING_END


@dataclass(frozen=True)
class RoundedCone(ProfileShape):
    """f = S r^2/(2 b) to the blend radius b [m], then a cone of slope S [1]. ShapeError unless both are > 0."""

    slope: float
    blend_radius: float

    name = "rounded_cone"
    units: ClassVar[dict[str, str]] = {"slope": "1", "blend_radius": "m"}
    profile = Profile(
        _cone_mdr_profile,
        _cone_reduced_load,
        _cone_f_and_slope,
        softening_count=one,
        softening_interval=_cone_softening_interval,
        kink=kink_at_one,
        breakpoint_count=one,
    )

    @classmethod
    def nondimensionalise(cls, parameters: dict[str, Floats]) -> tuple[Floats, Floats, Floats]:
        """Width b and rise S b."""
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
    """Allow for q - atan q where that is not yet a series."""
    return 80.0


def _punch_f_and_slope(r: float, params: Params) -> tuple[float, float]:
    return (0.5 * (r - 1.0) * (r - 1.0), r - 1.0) if r > 1.0 else (0.0, 0.0)


@dataclass(frozen=True)
class RoundedPunch(ProfileShape):
    """A flat of radius b [m], then f = (r - b)^2/(2 R), R [m] the radius of its edge. ShapeError unless both > 0."""

    flat_radius: float
    edge_radius: float

    name = "rounded_punch"
    units: ClassVar[dict[str, str]] = {"flat_radius": "m", "edge_radius": "m"}
    body_radius = ("flat_radius", "edge_radius")
    profile = Profile(
        _punch_mdr_profile,
        _punch_reduced_load,
        _punch_f_and_slope,
        q_of_radius,
        mdr_integral=_punch_mdr_integral,
        flat=True,
        breakpoint_count=one,
        t_of_q=t_is_q,
        roundings=_punch_roundings,
    )

    # Next to the flat r/b has too few digits for f and f'.
    def f(self, r: ArrayLike) -> Floats:
        beyond = (check_radii("r", r) - self.flat_radius).clip(min=0.0)
        return np.asarray(beyond * (beyond / (2.0 * self.edge_radius)))

    @classmethod
    def slopes(cls, columns: tuple[Any, Any, Any], r: Floats) -> Floats:
        width, rise, _ = columns
        return np.asarray((r - width).clip(min=0.0) * (rise / width / width))

    @classmethod
    def nondimensionalise(cls, parameters: dict[str, Floats]) -> tuple[Floats, Floats, Floats]:
        """Width b and rise b^2/R."""
        flat = parameters["flat_radius"]
        return flat, flat * (flat / parameters["edge_radius"]), np.zeros_like(flat)

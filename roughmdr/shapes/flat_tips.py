"""Profiles with a flat tip: the flat-ended punch, the truncated cone and paraboloid, and the rounded punch; t is q."""

from dataclasses import dataclass
from functools import partial
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.vector_math import atan, atan_minus_cubic, q_minus_atan, sqrt
from roughmdr.shapes import zone_integrals
from roughmdr.shapes.base import ProfileShape, Shape, check_radii
from roughmdr.shapes.profile import Params, Profile, one, q_of_radius, t_is_q

# Where sqrt(a) g'(a), infinite at the corner, stops falling: q^3 atan q + q^2 = 2 for the cone, 6 q^4 + 3 q^2 = 2 for
# the paraboloid.
_CONE_SOFTENING_END = 1.0424561234141570
_PARABOLOID_SOFTENING_END = 0.61575390344349083

_FlatTip = partial(Profile, t_of_radius=q_of_radius, t_of_q=t_is_q, flat=True, breakpoint_count=one)
_Truncated = partial(_FlatTip, softening_count=one, corner=True)


@dataclass(frozen=True)
class FlatPunch(Shape):
    """f = 0 to the radius b [m], where the punch ends, and a contact that is not tilted. ShapeError unless b > 0."""

    radius: float

    name = "flat_punch"
    papers: ClassVar[dict[str, str]] = {"Kendall1971": "adhesion"}
    units: ClassVar[dict[str, str]] = {"radius": "m"}
    pinned = True
    flat = True

    @property
    def limit(self) -> float:
        return self.radius

    def f(self, r: ArrayLike) -> Floats:
        return np.zeros_like(check_radii("r", r, self.limit))

    def g(self, x: ArrayLike) -> Floats:
        return np.zeros_like(check_radii("x", x, self.limit))

    def G(self, a: ArrayLike) -> Floats:
        return np.zeros_like(check_radii("a", a, self.limit))

    @classmethod
    def slopes(cls, columns: tuple[Any, Any, Any], r: Floats) -> Floats:
        return np.zeros_like(r)

    @classmethod
    def nondimensionalise(cls, parameters: dict[str, Floats]) -> tuple[Floats, Floats, Floats]:
        """Width and rise b."""
        radius = parameters["radius"]
        return radius, radius, np.zeros_like(radius)


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
    papers: ClassVar[dict[str, str]] = {"Kendall1971": "adhesion"}
    similar = True
    units: ClassVar[dict[str, str]] = {"slope": "1", "flat_radius": "m"}
    profile = _Truncated(
        _cone_mdr_profile,
        _cone_reduced_load,
        _cone_f_and_slope,
        softening_interval=_cone_softening_interval,
        mdr_integral=_cone_mdr_integral,
        zone_integrals=zone_integrals.truncated_cone,
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
    papers: ClassVar[dict[str, str]] = {"Kendall1971": "adhesion"}
    similar = True
    units: ClassVar[dict[str, str]] = {"radius": "m", "flat_radius": "m"}
    body_radius = ("radius",)
    profile = _Truncated(
        _paraboloid_mdr_profile,
        _paraboloid_reduced_load,
        _paraboloid_f_and_slope,
        softening_interval=_paraboloid_softening_interval,
        mdr_integral=_paraboloid_mdr_integral,
        zone_integrals=zone_integrals.truncated_paraboloid,
    )

    @classmethod
    def nondimensionalise(cls, parameters: dict[str, Floats]) -> tuple[Floats, Floats, Floats]:
        """Width b and rise b^2/R."""
        flat = parameters["flat_radius"]
        return flat, flat * (flat / parameters["radius"]), np.zeros_like(flat)


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
    similar = True
    units: ClassVar[dict[str, str]] = {"flat_radius": "m", "edge_radius": "m"}
    body_radius = ("flat_radius", "edge_radius")
    profile = _FlatTip(
        _punch_mdr_profile,
        _punch_reduced_load,
        _punch_f_and_slope,
        mdr_integral=_punch_mdr_integral,
        zone_integrals=zone_integrals.rounded_punch,
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

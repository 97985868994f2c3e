"""Profiles with a tip blunter than the flank: the rounded cone and the capped paraboloid."""

import math
from dataclasses import dataclass
from functools import partial
from typing import ClassVar

import numpy as np

from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.vector_math import atan, sqrt
from roughmdr.shapes import zone_integrals
from roughmdr.shapes.base import ProfileShape
from roughmdr.shapes.profile import Params, Profile, kink_at_one, one, q_of_radius

_CONE_SOFTENING_END = 1.1053618248293666  # where sqrt(a) [2/(a + q) + atan q] is least

_FLAT_SOFTENING_END = (math.sqrt(57.0) - 3.0) / 12.0  # q^2 where sqrt(a) g' is least for c = 0: 6 q^4 + 3 q^2 = 2

_BluntTip = partial(Profile, softening_count=one, kink=kink_at_one, breakpoint_count=one)


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
    similar = True
    units: ClassVar[dict[str, str]] = {"slope": "1", "blend_radius": "m"}
    profile = _BluntTip(
        _cone_mdr_profile,
        _cone_reduced_load,
        _cone_f_and_slope,
        softening_interval=_cone_softening_interval,
        zone_integrals=zone_integrals.rounded_cone,
    )

    @classmethod
    def nondimensionalise(cls, parameters: dict[str, Floats]) -> tuple[Floats, Floats, Floats]:
        """Width b and rise S b."""
        blend = parameters["blend_radius"]
        return blend, parameters["slope"] * blend, np.zeros_like(blend)


def _paraboloid_mdr_profile(t: float, params: Params) -> tuple[float, float, float, float]:
    """g = c a^2 + (1 - c) a q with the flatness c = R2/R1 of the cap and q = sqrt(a^2 - 1), 0 below the blend.

    t is a on the cap and 1 + q/c beyond, so that it resolves the blend where the cap is nearly flat.
    """
    c, on_cap = params[0], t <= 1.0
    q = 0.0 if on_cap else c * (t - 1.0)
    a = t if on_cap else sqrt(1.0 + q * q)
    growth = 1.0 if on_cap else c * q / a
    steepening = 2.0 * c * t if on_cap else c * (2.0 * c * q + (1.0 - c) * (1.0 + 2.0 * q * q) / a)
    return a, growth, a * (c * a + (1.0 - c) * q), steepening


def _paraboloid_reduced_load(t: float, params: Params) -> float:
    c, on_cap = params[0], t <= 1.0
    q = 0.0 if on_cap else c * (t - 1.0)
    a = t if on_cap else sqrt(1.0 + q * q)
    return 2.0 * c * a * a * a / 3.0 + (1.0 - c) * (q + 2.0 * q * q * q / 3.0)


def _paraboloid_mdr_integral(t: float, params: Params) -> float:
    c = params[0]
    if t <= 1.0:
        return c * t * t * t / 3.0
    q = c * (t - 1.0)
    square = 1.0 + q * q
    return (c * square * sqrt(square) + (1.0 - c) * q * q * q) / 3.0


def _paraboloid_f_and_slope(r: float, params: Params) -> tuple[float, float]:
    c = params[0]
    return (0.5 * c * r * r, c * r) if r <= 1.0 else (0.5 * c + 0.5 * (r - 1.0) * (r + 1.0), r)


def _t_of_radius(radius: float, width: float, params: Params) -> float:
    if radius <= width:
        return radius / width
    return 1.0 + q_of_radius(radius, width, params) / params[0]


def _t_of_q(q: float, params: Params) -> float:
    return 1.0 + q / params[0]


def _paraboloid_softening_interval(index: int, params: Params) -> tuple[float, float]:
    """sqrt(a) g' falls from infinity at the blend to where 3 c a q^3 + (1 - c) (6 a^4 - 9 a^2 + 1)/2 = 0.

    With w = q^2 that is convex, so that Newton's method comes from the root for c = 0 without going beyond.
    """
    c, w = params[0], _FLAT_SOFTENING_END
    for _ in range(60):
        a, q = sqrt(1.0 + w), sqrt(w)
        value = 3.0 * c * a * w * q + 0.5 * (1.0 - c) * ((6.0 * w + 3.0) * w - 2.0)
        slope = 1.5 * c * q * (w / a + 3.0 * a) + 0.5 * (1.0 - c) * (12.0 * w + 3.0)
        if not value > 1e-16 * slope * w:
            break
        w -= value / slope
    return 1.0, 1.0 + sqrt(w) / c


@dataclass(frozen=True)
class CappedParaboloid(ProfileShape):
    """f' = r/R1 to the blend radius b, then r/R2: radius R2, cap_radius R1 >= R2, all [m].

    ShapeError unless all are > 0, and for R1 < R2: there the contact would not be a disc.
    """

    radius: float
    cap_radius: float
    blend_radius: float

    name = "capped_paraboloid"
    units: ClassVar[dict[str, str]] = {"radius": "m", "cap_radius": "m", "blend_radius": "m"}
    body_radius = ("radius",)
    not_below = (("cap_radius", "radius", "with a cap sharper than the flank the contact would not be a disc"),)
    profile = _BluntTip(
        _paraboloid_mdr_profile,
        _paraboloid_reduced_load,
        _paraboloid_f_and_slope,
        _t_of_radius,
        softening_interval=_paraboloid_softening_interval,
        mdr_integral=_paraboloid_mdr_integral,
        zone_integrals=zone_integrals.capped_paraboloid,
        corner=True,
        t_of_q=_t_of_q,
    )

    @classmethod
    def nondimensionalise(cls, parameters: dict[str, Floats]) -> tuple[Floats, Floats, Floats]:
        """Width b, rise b^2/R2 and flatness of the cap R2/R1."""
        blend, radius = parameters["blend_radius"], parameters["radius"]
        return blend, blend * (blend / radius), radius / parameters["cap_radius"]

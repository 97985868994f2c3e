"""The half-space under one contact: its state, where its pressure is infinite, and the integrals of its fields."""

import math
from typing import Any, NamedTuple

import numpy as np

from roughmdr.asperity import validity
from roughmdr.asperity.contact import Contact
from roughmdr.asperity.fields.integrals import DEEP, DEEP_TURN, DISPLACEMENT, PRESSURE, STEEP, STEEP_TURN, field_kernel
from roughmdr.asperity.fields.zone import Zone
from roughmdr.asperity.tabor import resolved
from roughmdr.errors import OutOfRange
from roughmdr.kernels.adhesion import Adhesion, release_stretch
from roughmdr.kernels.elementwise import apply
from roughmdr.numerics.arguments import Floats
from roughmdr.schema.arguments import check_scalar, exactly_one
from roughmdr.shapes import Shape
from roughmdr.shapes.power_profiles import profile_of
from roughmdr.shapes.profile import Profile

_ROUNDING = 1e-12  # slope of the tip or jump of slope, over the slope at the edge, below which it is a rounding error
_DEPTH_MIN, _DEPTH_MAX, _STEPS_PER_DECADE = 1e-6, 10.0, 8  # depths, over a radius, at which the largest shear is sought
_POWER = {PRESSURE: 1, DISPLACEMENT: 0, STEEP: 1, DEEP: 1, STEEP_TURN: 2, DEEP_TURN: 2}
"""Power of a length by which each weight is divided."""


class HalfSpace(NamedTuple):
    """The half-space under one contact."""

    shape: Shape
    profile: Profile | None  # None for a flat punch
    indentation: float
    radius: float
    stretch: float  # delta - g(a) [m]: indentation of the flat punch of the size of the contact, which is superposed
    t: float
    width: float
    rise: float
    params: Any  # params of the shape, with room for precomputed numbers
    zone: Zone | None = None  # around the contact, where adhesion has a range

    @classmethod
    def of(cls, shape: Shape, modulus: float, asked: Adhesion, **controls: float | str | None) -> "HalfSpace":
        """Return the state under the one of two controls that is given; errors as ``indent``."""
        control, raw = exactly_one("a field", **controls)
        value = check_scalar(control, raw, "m")
        adhesion, values = resolved(shape, modulus, asked), np.array([value])
        contact = Contact.of(shape, modulus, adhesion)
        with np.errstate(all="ignore"):
            if control == "contact_radius":
                radius, depth, in_contact = values, contact.at_radius(values)["indentation"], values > 0.0
                t = apply(contact.kernels.state_of_radius, radius, contact.radius, contact.params)
            else:
                found, depth = contact.at_indentation(values), values
                radius = found["contact_radius"]
                in_contact = found.get("cohesive_radius", radius) > 0.0
                distance = np.where(in_contact, contact.reduced(values, contact.depth), 1.0)
                t = apply(contact.kernels.state, distance, contact.params)
            a, delta = float(radius[0]), float(depth[0])
            zone = Zone.of(contact, float(t[0])) if adhesion.cohesive and (a > 0.0 or in_contact[0]) else None
        if not (math.isfinite(a) and math.isfinite(delta)):
            raise OutOfRange(f"the contact at {control} = {value:g} m is not representable")
        width, rise, params = shape.nondimensional()
        params = np.concatenate([np.atleast_1d(np.asarray(params, dtype=np.float64)), [0.0]])
        profile = None if shape.pinned else profile_of(type(shape))
        if profile is not None:
            profile.precompute(params)
        stretch = delta if shape.pinned else -release_stretch(a, modulus, adhesion.work)
        state = float(t[0]) if shape.uses_profile else a / width
        if zone is not None and zone.extent > 0.0:
            return cls(shape, profile, delta, a, zone.stretch, zone.t, width, rise, params, zone)
        return cls(shape, profile, delta, a, stretch, state, width, rise, params)

    @property
    def reach(self) -> float:
        """The radius [m] within which there is a pressure."""
        return self.radius if self.zone is None else self.zone.outer

    def slope(self, r: float) -> float:
        """Return the slope f' at r over width, in units of rise over width."""
        return 0.0 if self.profile is None else float(self.profile.f_and_slope(r, self.params)[1])

    @property
    def sharp(self) -> bool:
        """Whether the pressure is infinite at r = 0."""
        return self.radius > 0.0 and self.slope(0.0) > _ROUNDING * self.slope(self.radius / self.width)

    def singular(self) -> dict[float, str]:
        """Return the radii [m] where the pressure is infinite, with the reason of each."""
        infinite: dict[float, str] = {}
        if self.radius == 0.0:
            return infinite
        if self.sharp:
            infinite[0.0] = "the sharp tip of the profile"
        if (profile := self.profile) is not None and profile.corner:
            for index in range(profile.breakpoint_count(self.params)):
                edge = profile.breakpoint(index, self.params)[0]
                before, after = self.slope(math.nextafter(edge, 0.0)), self.slope(math.nextafter(edge, math.inf))
                if after - before > _ROUNDING * after and self.t > profile.t_of_radius(edge, 1.0, self.params):
                    infinite[edge * self.width] = "a corner of the profile"
        if self.stretch != 0.0 and self.zone is None:
            infinite[self.radius] = "the edge of the contact"
        return infinite

    def refuse_singular(self, name: str, at: Floats, only: float | None = None) -> None:
        """Raise OutOfRange where one of ``at`` is a radius at which the pressure is infinite."""
        for radius, location in self.singular().items():
            if (at == radius).any() and only in (None, radius):
                raise OutOfRange(
                    f"{name} is {radius:g} m, {location}, where the pressure is infinite; it must differ from that"
                )

    def total(self, kind: int, at: Floats) -> Floats:
        """Return the integral of a weight with d(g - delta) to the edge of the contact, the jump there included."""
        body = np.zeros_like(at)
        if self.profile is not None and self.radius > 0.0:
            body = apply(field_kernel(type(self.shape)), at, kind, self.radius, self.t, self.width, self.params)
        if np.isnan(body).any():
            raise OutOfRange(
                f"the field at {at[np.isnan(body)][0]:g} m of a contact with the radius {self.radius:g} m needs "
                f"more digits than a float has: {self.shape}"
            )
        total = self.rise * body / self.width ** _POWER[kind]
        if self.zone is not None and kind == PRESSURE:
            return np.asarray(total + self.zone.pressure_share(at))
        total = total + self.stretch * self._edge(kind, at)
        if self.zone is not None and kind == DISPLACEMENT:
            total = total + self.zone.displacement_share(at)
        return np.asarray(total)

    def _edge(self, kind: int, at: Floats) -> Floats:
        """Return the weight at the edge of the contact."""
        a = self.radius
        if kind == PRESSURE:
            return np.asarray(1.0 / (np.sqrt(a - at) * np.sqrt(a + at)))
        if kind == DISPLACEMENT:
            return np.asarray(np.arctan2(a, np.sqrt(at - a) * np.sqrt(at + a)))
        d = np.hypot(a, at)
        cosine, sine = a / d, at / d
        weights = {STEEP: cosine**3, DEEP: cosine * sine**2, STEEP_TURN: cosine**3 * sine, DEEP_TURN: cosine * sine**3}
        return np.asarray(weights[kind] / d ** _POWER[kind])

    def below(self, kind: int, depth: Floats) -> Floats:
        """Return ``total`` of the weights on the axis, on the surface from p(0); 0 without contact."""
        totals = np.zeros_like(depth)
        if self.radius > 0.0:
            deep = depth > 0.0
            totals[deep] = self.total(kind, depth[deep])
            if kind == STEEP:
                totals[~deep] = self.total(PRESSURE, depth[~deep])
        return totals

    def largest_shear(self, steep: float, deep: float) -> tuple[float, float]:
        """Return the depth [m] where |steep A + deep B| is largest, A and B the totals of STEEP and DEEP; and that."""
        if self.radius == 0.0:
            return 0.0, 0.0
        smallest = self.radius
        if self.profile is not None and self.profile.breakpoint_count(self.params):
            smallest = min(smallest, self.profile.breakpoint(0, self.params)[0] * self.width)
        decades = math.log10(_DEPTH_MAX / _DEPTH_MIN) + math.log10(self.radius / smallest)
        depths = np.geomspace(_DEPTH_MIN * smallest, _DEPTH_MAX * self.radius, int(_STEPS_PER_DECADE * decades))
        depths = np.append(0.0, depths)

        def shear(depth: Floats) -> Floats:
            return np.abs(steep * self.below(STEEP, depth) + deep * self.below(DEEP, depth))

        def slope(depth: float) -> float:
            at = np.array([depth])
            return float(((deep - 2.0 * steep) * self.total(STEEP_TURN, at) - deep * self.total(DEEP_TURN, at))[0])

        largest = int(np.argmax(shear(depths)))
        depth = float(depths[largest])
        if 1 < largest < depths.size - 1 and slope(depths[largest - 1]) * slope(depths[largest + 1]) < 0.0:
            from scipy.optimize import brentq

            depth = float(brentq(slope, depths[largest - 1], depths[largest + 1], xtol=1e-15 * depth, rtol=1e-14))
        return depth, float(shear(np.array([depth]))[0])

    @property
    def warnings(self) -> list[str]:
        """Warnings of a contact for which the theory is doubtful."""
        radius = np.array([self.radius])
        return validity.ValidityLimits.of(radius, self.shape.df(radius), np.array(self.shape.end)).warnings

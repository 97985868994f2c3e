"""The half-space under one contact: the state, where its pressure is infinite, and the sums that its fields are of."""

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from roughmdr.asperity import validity
from roughmdr.asperity.contact import Contact
from roughmdr.errors import OutOfRange, RoughmdrError
from roughmdr.fields import integrals
from roughmdr.fields.quadrature import DEEP, DEEP_TURN, DISPLACEMENT, PRESSURE, STEEP, STEEP_TURN
from roughmdr.kernels.adhesion import Adhesion, release_stretch
from roughmdr.kernels.elementwise import apply
from roughmdr.numerics.arguments import Floats, check_values
from roughmdr.shapes import Shape
from roughmdr.shapes.power_profiles import profile_of

_ROUNDING = 1e-12  # of the slope at the edge: a slope of the tip, or a jump, that is rounding
_SHALLOW, _DEEP, _STEPS_A_DECADE = 1e-6, 10.0, 8  # where the largest shear is looked for, over a radius
_POWER = {PRESSURE: 1, DISPLACEMENT: 0, STEEP: 1, DEEP: 1, STEEP_TURN: 2, DEEP_TURN: 2}
"""How often a weight is divided by a length."""


def one_number(name: str, raw: ArrayLike) -> float:
    """``raw`` as a float; OutOfRange unless it is one finite number."""
    value = check_values(name, raw)
    if value.ndim:
        raise OutOfRange(
            f"{name} has {value.ndim} dimensions; it must be one number, since a field is that of one contact"
        )
    return float(value)


class HalfSpace(NamedTuple):
    """The half-space under one contact."""

    shape: Shape
    effective_modulus: float
    indentation: float
    radius: float
    stretch: float
    """delta - g(a) [m]: what the flat punch of the size of the contact adds."""
    t: float
    width: float
    rise: float
    params: Any
    """The numbers of the shape."""

    @classmethod
    def of(
        cls,
        shape: Shape,
        effective_modulus: float,
        work: float,
        contact_radius: float | None,
        indentation: float | None,
    ) -> "HalfSpace":
        """The state under the one control that is given; RoughmdrError, OutOfRange and ShapeError as in ``indent``."""
        controls = {"contact_radius": contact_radius, "indentation": indentation}
        given = {name: value for name, value in controls.items() if value is not None}
        if len(given) != 1:
            names = " and ".join(given) or "none"
            raise RoughmdrError(f"got {names}; a field takes exactly one of contact_radius, indentation")
        ((control, raw),) = given.items()
        value = one_number(control, raw)
        adhesion, wanted = Adhesion.checked("jkr", work, None), np.array([value])
        contact = Contact.of(shape, effective_modulus, adhesion)
        law = contact.law
        with np.errstate(all="ignore"):
            if control == "contact_radius":
                radius, depth = wanted, contact.at_radius(wanted)["indentation"]
                t = apply(law.state_of_radius, radius, contact.radius, contact.params)
            else:
                radius, depth = contact.at_indentation(wanted)["contact_radius"], wanted
                distance = np.where(radius > 0.0, contact.reduced(wanted, contact.depth), 1.0)
                t = apply(law.state, distance, contact.params)
            a, delta = float(radius[0]), float(depth[0])
        if not (math.isfinite(a) and math.isfinite(delta)):
            raise OutOfRange(f"the contact at {control} = {value:g} m is not representable")
        width, rise, params = shape.nondimensional()
        params = np.concatenate([np.atleast_1d(np.asarray(params, dtype=np.float64)), [0.0]])
        if shape.pinned:
            stretch = delta
        else:
            profile_of(type(shape)).precompute(params)
            stretch = -release_stretch(a, contact.effective_modulus, adhesion.work)
        state = float(t[0]) if shape.uses_profile else a / width
        return cls(shape, contact.effective_modulus, delta, a, stretch, state, width, rise, params)

    @property
    def sharp(self) -> bool:
        """Whether the pressure is infinite at r = 0."""
        if self.radius == 0.0 or self.shape.pinned:
            return False
        height = profile_of(type(self.shape)).f_and_slope
        return bool(height(0.0, self.params)[1] > _ROUNDING * height(self.radius / self.width, self.params)[1])

    def singular(self) -> dict[float, str]:
        """The radii [m] where the pressure is infinite, and what lies there."""
        found: dict[float, str] = {}
        if self.radius == 0.0:
            return found
        if self.sharp:
            found[0.0] = "the sharp tip of the profile"
        if not self.shape.pinned and (profile := profile_of(type(self.shape))).corner:
            for index in range(profile.breakpoint_count(self.params)):
                edge = profile.breakpoint(index, self.params)[0]
                before, after = (
                    profile.f_and_slope(math.nextafter(edge, to), self.params)[1] for to in (0.0, math.inf)
                )
                if after - before > _ROUNDING * after and self.t > profile.t_of_radius(edge, 1.0, self.params):
                    found[edge * self.width] = "a corner of the profile"
        if self.stretch != 0.0:
            found[self.radius] = "the edge of the contact"
        return found

    def refuse_singular(self, name: str, at: Floats, only: float | None = None) -> None:
        """OutOfRange where one of ``at`` is a radius at which the pressure is infinite."""
        for radius, place in self.singular().items():
            if (at == radius).any() and only in (None, radius):
                raise OutOfRange(
                    f"{name} is {radius:g} m, {place}, where the pressure is infinite; it must lie beside it"
                )

    def total(self, kind: int, at: Floats) -> Floats:
        """The integral of a weight with d(g - delta) to the edge of the contact, its own stretch included."""
        body = np.zeros_like(at)
        if not self.shape.pinned:
            kernel = integrals.build(type(self.shape))
            body = apply(kernel, at, kind, self.radius, self.t, self.width, self.params)
            if np.isnan(body).any():
                raise OutOfRange(
                    f"the field at {at[np.isnan(body)][0]:g} m of a contact with the radius {self.radius:g} m asks for "
                    f"more digits than a float has: {self.shape}"
                )
        return np.asarray(self.rise * body / self.width ** _POWER[kind] + self.stretch * self._edge(kind, at))

    def _edge(self, kind: int, at: Floats) -> Floats:
        """The weight at the edge of the contact."""
        a = self.radius
        if kind == PRESSURE:
            return np.asarray(1.0 / (np.sqrt(a - at) * np.sqrt(a + at)))
        if kind == DISPLACEMENT:
            return np.asarray(np.arctan2(a, np.sqrt(at - a) * np.sqrt(at + a)))
        d = np.hypot(a, at)
        cosine, sine = a / d, at / d
        along = {STEEP: cosine**3, DEEP: cosine * sine**2, STEEP_TURN: cosine**3 * sine, DEEP_TURN: cosine * sine**3}
        return np.asarray(along[kind] / d ** _POWER[kind])

    def below(self, kind: int, depth: Floats) -> Floats:
        """``total`` of the weights on the axis, 0 without contact, and on the surface as p(0) has it."""
        found = np.zeros_like(depth)
        if self.radius > 0.0:
            deep = depth > 0.0
            found[deep] = self.total(kind, depth[deep])
            if kind == STEEP:
                found[~deep] = self.total(PRESSURE, depth[~deep])
        return found

    def largest_shear(self, steep: float, deep: float) -> tuple[float, float]:
        """The depth [m] where |steep A + deep B| is largest, A and B the sums of STEEP and DEEP; and that."""
        if self.radius == 0.0:
            return 0.0, 0.0
        smallest = self.radius
        if not self.shape.pinned and (profile := profile_of(type(self.shape))).breakpoint_count(self.params):
            smallest = min(smallest, profile.breakpoint(0, self.params)[0] * self.width)
        decades = math.log10(_DEEP / _SHALLOW) + math.log10(self.radius / smallest)
        depths = np.geomspace(_SHALLOW * smallest, _DEEP * self.radius, int(_STEPS_A_DECADE * decades))
        depths = np.concatenate([[0.0], depths])

        def shear(depth: Floats) -> Floats:
            return np.abs(steep * self.below(STEEP, depth) + deep * self.below(DEEP, depth))

        def slope(depth: float) -> float:
            at = np.array([depth])
            turn = (deep - 2.0 * steep) * self.total(STEEP_TURN, at) - deep * self.total(DEEP_TURN, at)
            return float(turn[0])

        top = int(np.argmax(shear(depths)))
        depth = float(depths[top])
        if 1 < top < depths.size - 1 and slope(depths[top - 1]) * slope(depths[top + 1]) < 0.0:
            from scipy.optimize import brentq

            depth = float(brentq(slope, depths[top - 1], depths[top + 1], xtol=1e-15 * depth, rtol=1e-14))
        return depth, float(shear(np.array([depth]))[0])

    @property
    def warnings(self) -> list[str]:
        """What is doubtful about the contact."""
        radius = np.array([self.radius])
        return validity.ValidityLimits.of(radius, self.shape.df(radius), np.array(self.shape.end)).warnings

"""One contact in numbers to draw: the body, the deformed surface, the row of springs, and the pressure."""

import math
import warnings
from typing import Any, NamedTuple

import numpy as np

from roughmdr.asperity.fields.evaluate import pressure, surface_displacement
from roughmdr.asperity.fields.half_space import HalfSpace
from roughmdr.errors import LimitWarning
from roughmdr.kernels.adhesion import Adhesion
from roughmdr.numerics.arguments import Floats
from roughmdr.shapes import Shape

WIDTH = 2.2  # half width of the drawing, over the radius of the pressure
_POINTS = 600  # points of a curve
_SPRINGS = 13  # springs within that radius
_INSIDE = 1.0 - 1e-12  # largest radius that is drawn, over the limit of a profile


class Pressure(NamedTuple):
    """The pressure from the axis outwards."""

    r: Floats
    """Distance from the axis [m], without radii where the pressure is infinite."""
    p: Floats
    """[Pa]."""
    infinite: dict[float, str]
    """The radii [m] where it is infinite, with the reason."""


class OneContact(NamedTuple):
    """An asperity in contact."""

    shape: Shape
    modulus: float
    """E* [Pa]."""
    adhesion: Adhesion
    control: dict[str, float]
    """The contact radius or the indentation [m] that gives its state."""
    state: HalfSpace

    @classmethod
    def of(
        cls, shape: Shape, modulus: float, adhesion: Adhesion, *, radius: float, force: float, indentation: float
    ) -> "OneContact":
        """Return the contact with this radius [m]; where that does not determine it, with this force [N] or, where the
        adhesion has a range, indentation [m].
        """
        if shape.pinned and not adhesion.cohesive:
            control = {"indentation": force / (2.0 * modulus * radius)}
        elif shape.pinned or radius == 0.0:
            control = {"indentation": indentation}
        else:
            control = {"contact_radius": max(radius, shape.nondimensional()[0]) if shape.flat else radius}
        return cls(shape, modulus, adhesion, control, HalfSpace.of(shape, modulus, adhesion, **control))

    @property
    def half_width(self) -> float:
        """The distance from the axis up to which the contact is drawn [m]."""
        return WIDTH * self.state.reach

    @property
    def stretch(self) -> float:
        """Height [m] of the edge of the contact above the undeformed surface: dl under JKR; < 0 if pressed."""
        return -self.state.stretch

    def body(self, r: Floats) -> Floats:
        """Return the height of the profile f [m] above the undeformed surface; NaN beyond its end."""
        return self._above(self.shape.f, r)

    def mdr_profile(self, x: Floats) -> Floats:
        """Return the height of the MDR profile g [m] above the undeformed surface; NaN beyond its end."""
        return self._above(self.shape.g, x)

    def _above(self, profile: Any, r: Floats) -> Floats:
        height, inside = np.full_like(r, math.nan), r <= self.shape.limit
        height[inside] = profile(np.minimum(r[inside], _INSIDE * self.shape.limit)) - self.state.indentation
        return height

    def surface(self) -> tuple[Floats, Floats]:
        """Return distances from the axis [m], finer about the edge of the contact, and the height of the surface."""
        a, half = self.state.radius, self.half_width
        near = self.state.reach * np.geomspace(1e-6, 0.3, _POINTS // 4)
        r = np.unique(np.concatenate([np.linspace(0.0, half, _POINTS), a - near[near < a], [a], a + near]))
        with warnings.catch_warnings(action="ignore", category=LimitWarning):
            return r, -surface_displacement(self.shape, r=r, **self._arguments()).to_numpy()

    def springs(self) -> tuple[Floats, Floats]:
        """Return the row of springs on both sides (H 18, 32): positions, and heights of their ends above the undeformed
        surface [m]; 0 for free ones. Within the cohesive zone they are lifted by the attraction.
        """
        reach, a = self.state.reach, self.state.radius
        spacing = reach / _SPRINGS
        x = np.asarray(spacing * (np.arange(int(WIDTH * _SPRINGS)) + 0.5), dtype=np.float64)
        end = np.where(x < a, np.nan_to_num(self.mdr_profile(x)), 0.0)
        if self.state.zone is not None:
            zone = (x >= a) & (x < reach)
            end[zone] = self.state.zone.pull * np.sqrt(reach * reach - x[zone] ** 2)
        return np.append(-x[::-1], x), np.append(end[::-1], end)

    def pressure(self) -> Pressure:
        """Return the pressure, on points that are denser towards the edge of the contact."""
        a, reach = self.state.radius, self.state.reach
        r = a * np.sin(0.5 * math.pi * (np.arange(_POINTS) + 0.5) / _POINTS)
        zone = np.linspace(a, reach, 50)[1:-1] if reach > a else np.empty(0)
        r = np.concatenate([r, zone, [math.nextafter(reach, math.inf), self.half_width]])
        with warnings.catch_warnings(action="ignore", category=LimitWarning):
            return Pressure(r, pressure(self.shape, r=r, **self._arguments()).to_numpy(), self.state.singular())

    def _arguments(self) -> dict[str, Any]:
        """Return the arguments of the public functions of fields."""
        adhesion: dict[str, Any] = {"work": self.adhesion.work}
        if self.adhesion.cohesive:
            adhesion |= {"adhesion": "dugdale", "strength": self.adhesion.strength}
        return {"effective_modulus": self.modulus, **adhesion, **self.control}

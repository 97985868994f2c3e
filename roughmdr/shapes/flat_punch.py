"""The flat-ended cylindrical punch."""

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from roughmdr.numerics.arguments import Floats
from roughmdr.shapes.base import Shape, check_radii


@dataclass(frozen=True)
class FlatPunch(Shape):
    """f = 0 to the radius b [m], where the punch ends: the contact radius is always b. ShapeError unless b > 0."""

    radius: float

    name = "flat_punch"
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

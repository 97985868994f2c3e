"""The flat-ended cylindrical punch."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from roughmdr.numerics.arguments import Floats
from roughmdr.shapes.base import Shape, radii


@dataclass(frozen=True)
class FlatPunch(Shape):
    """f = 0 to the radius b [m], where the punch ends: the contact radius is always b. ShapeError unless b > 0."""

    radius: float

    name: ClassVar[str] = "flat_punch"
    units: ClassVar[dict[str, str]] = {"radius": "m"}
    spellings: ClassVar[tuple[tuple[str, ...], ...]] = (("radius",),)
    pinned: ClassVar[bool] = True
    flat: ClassVar[bool] = True

    @property
    def limit(self) -> float:
        return self.radius

    def f(self, r: ArrayLike) -> Floats:
        return np.zeros_like(radii("r", r, most=self.radius))

    def g(self, x: ArrayLike) -> Floats:
        return np.zeros_like(radii("x", x, most=self.radius))

    def G(self, a: ArrayLike) -> Floats:
        return np.zeros_like(radii("a", a, most=self.radius))

    @classmethod
    def slopes(cls, parameters: dict[str, Floats], r: Floats) -> Floats:
        return np.zeros_like(r)

    @classmethod
    def nondimensionalise(cls, parameters: dict[str, Floats]) -> tuple[Floats, Floats, Floats]:
        """b, b and nothing."""
        radius = parameters["radius"]
        return radius, radius, np.zeros_like(radius)

"""The power laws f(r) = rise (r/width)^n: the cone (n = 1), the paraboloid (n = 2) and any exponent (H 12, 26)."""

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from roughmdr.numerics.arguments import Floats
from roughmdr.shapes.base import Shape, check_radii


class _Power(Shape):
    """f, g and G of the power laws, from width, rise and the exponent as params."""

    def f(self, r: ArrayLike) -> Floats:
        width, rise, exponent = self.nondimensional()
        return np.asarray(rise * (check_radii("r", r) / width) ** exponent)

    def g(self, x: ArrayLike) -> Floats:
        from roughmdr.shapes.kappa import kappa  # it alone needs the compiler

        return np.asarray(kappa(self.nondimensional()[2]) * self.f(check_radii("x", x)))

    def G(self, a: ArrayLike) -> Floats:
        radius = check_radii("a", a)
        return np.asarray(radius * self.g(radius) / (self.nondimensional()[2] + 1.0))

    @classmethod
    def slopes(cls, columns: tuple[Any, Any, Any], r: Floats) -> Floats:
        width, rise, exponent = columns
        with np.errstate(divide="ignore"):  # below n = 1 the tip is infinitely steep
            return np.asarray(exponent * rise / width * (r / width) ** (exponent - 1.0))


@dataclass(frozen=True)
class Paraboloid(_Power):
    """f = r^2/(2 R): the sphere of radius R [m] as Hertz and JKR take it. ShapeError unless R > 0."""

    radius: float

    name = "paraboloid"
    papers: ClassVar[dict[str, str]] = {"Hertz1882": "contact"}
    units: ClassVar[dict[str, str]] = {"radius": "m"}
    body_radius = ("radius",)

    @classmethod
    def nondimensionalise(cls, parameters: dict[str, Floats]) -> tuple[Floats, Floats, Floats]:
        """Width R and rise R/2."""
        radius = parameters["radius"]
        return radius, 0.5 * radius, np.full_like(radius, 2.0)

    @classmethod
    def slopes(cls, columns: tuple[Any, Any, Any], r: Floats) -> Floats:
        return np.asarray(r / columns[0])  # to the bit as that of power laws, and much sooner


@dataclass(frozen=True)
class Cone(_Power):
    """f = S r, with S [1] the tangent of the angle between flank and flat. ShapeError unless S > 0."""

    slope: float

    name = "cone"
    units: ClassVar[dict[str, str]] = {"slope": "1"}

    @classmethod
    def nondimensionalise(cls, parameters: dict[str, Floats]) -> tuple[Floats, Floats, Floats]:
        """Width 1 m and rise S."""
        slope = parameters["slope"]
        return np.ones_like(slope), slope, np.ones_like(slope)


@dataclass(frozen=True)
class PowerLaw(_Power):
    """f = c r^n (exponent n [1], coefficient c) or f = H (r/l)^n (exponent n, width l [m], rise H [m]).

    c is a plain number, for r and f in metres; its unit, m^(1-n), changes with n. The second set keeps its numbers in
    range for steep exponents. ShapeError unless all of one set are given, > 0.
    """

    exponent: float
    coefficient: float | None = None
    width: float | None = None
    rise: float | None = None

    name = "power_law"
    units: ClassVar[dict[str, str]] = {"exponent": "1", "coefficient": "1", "width": "m", "rise": "m"}
    parameter_sets = (("exponent", "coefficient"), ("exponent", "width", "rise"))

    @classmethod
    def least_exponent(cls, params: Floats) -> float:
        return float(np.min(params, initial=np.inf))

    @classmethod
    def nondimensionalise(cls, parameters: dict[str, Floats]) -> tuple[Floats, Floats, Floats]:
        """Width l and rise H; with a coefficient 1 m and c."""
        exponent = parameters["exponent"]
        if "coefficient" in parameters:
            return np.ones_like(exponent), parameters["coefficient"], exponent
        return parameters["width"], parameters["rise"], exponent

"""The power laws f(r) = rise (r/width)^n: the cone (n = 1), the paraboloid (n = 2) and any exponent (H 12, 26)."""

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from roughmdr import _extended as extended
from roughmdr._extended import Pair
from roughmdr._jit import njit
from roughmdr.shapes.base import Floats, Shape, radii

_EULER = (-1.0, 5.0, -61.0, 1385.0, -50521.0, 2702765.0, -199360981.0)  # E_2, E_4, ... E_14


@njit
def _log_gamma_step(z: float) -> Pair:
    """ln[Gamma(z + 1/2)/Gamma(z)] for z > 0.

    The asymptotic series in w = z - 1/4, ln(w)/2 - sum_k E_k/(2 k (4 w)^k), begun at z >= 24 where the first term left
    out is below 1e-23 (NIST DLMF 5.11.8 at 3/4 and 1/4, with B_{k+1}(1/4) = -(k+1) E_k/4^(k+1) of 24.4.31).
    """
    lift = (1.0, 0.0)
    top = (z, 0.0)
    while top[0] < 24.0:
        lift = extended.multiply(lift, extended.divide(top, extended.add(top, (0.5, 0.0))))
        top = extended.add(top, (1.0, 0.0))
    w = extended.add(top, (-0.25, 0.0))
    tail = 0.0
    for i in range(6, -1, -1):
        k = 2.0 * (i + 1.0)
        tail = (tail - _EULER[i] / (2.0 * k)) / (16.0 * w[0] * w[0])
    half_log = extended.multiply(extended.log(w), (0.5, 0.0))
    return extended.add(extended.add(half_log, (tail, 0.0)), extended.log(lift))


@njit
def log_kappa(exponent: float) -> Pair:
    """ln kappa, kappa(n) = sqrt(pi)/2 n Gamma(n/2)/Gamma((n + 1)/2), the factor from f to g (H 26)."""
    log_half_root_pi = extended.add(
        extended.multiply(extended.LOG_PI, (0.5, 0.0)), extended.multiply(extended.LOG_2, (-1.0, 0.0))
    )
    step = extended.multiply(_log_gamma_step(0.5 * exponent), (-1.0, 0.0))
    return extended.add(extended.add(log_half_root_pi, extended.log((exponent, 0.0))), step)


@njit
def kappa(exponent: float) -> float:
    """The factor from f to g: 1 at n -> 0, pi/2 for the cone, 2 for the paraboloid, about sqrt(pi n/2) beyond."""
    return math.exp(log_kappa(exponent)[0])


class _Power(Shape):
    """The power laws' f, g and G, from width, rise and exponent."""

    def _stretched(self) -> tuple[float, float, float]:
        columns = self.stretch({name: np.array([value]) for name, value in self.parameters.items()})
        width, rise, exponent = (float(column[0]) for column in columns)
        return width, rise, exponent

    def f(self, r: ArrayLike) -> Floats:
        width, rise, exponent = self._stretched()
        return np.asarray(rise * (radii("r", r) / width) ** exponent)

    def g(self, x: ArrayLike) -> Floats:
        return np.asarray(kappa(self._stretched()[2]) * self.f(radii("x", x)))

    def G(self, a: ArrayLike) -> Floats:
        radius = radii("a", a)
        return np.asarray(radius * self.g(radius) / (self._stretched()[2] + 1.0))


@dataclass(frozen=True)
class Paraboloid(_Power):
    """f = r^2/(2 R): the sphere of radius R [m] as Hertz and JKR take it. ShapeError unless R > 0."""

    radius: float

    name: ClassVar[str] = "paraboloid"
    units: ClassVar[dict[str, str]] = {"radius": "m"}
    spellings: ClassVar[tuple[tuple[str, ...], ...]] = (("radius",),)

    @classmethod
    def stretch(cls, parameters: dict[str, Floats]) -> tuple[Floats, Floats, Floats]:
        """R, R/2 and 2."""
        radius = parameters["radius"]
        return radius, 0.5 * radius, np.full_like(radius, 2.0)


@dataclass(frozen=True)
class Cone(_Power):
    """f = S r, with S [1] the tangent of the angle between flank and flat. ShapeError unless S > 0."""

    slope: float

    name: ClassVar[str] = "cone"
    units: ClassVar[dict[str, str]] = {"slope": "1"}
    spellings: ClassVar[tuple[tuple[str, ...], ...]] = (("slope",),)

    @classmethod
    def stretch(cls, parameters: dict[str, Floats]) -> tuple[Floats, Floats, Floats]:
        """One metre, S and 1."""
        slope = parameters["slope"]
        return np.ones_like(slope), slope, np.ones_like(slope)


@dataclass(frozen=True)
class PowerLaw(_Power):
    """f = c r^n (exponent n [1], coefficient c [m^(1-n)]) or f = H (r/l)^n (exponent, width l [m], rise H [m]).

    The second form keeps its numbers in range for steep exponents. ShapeError unless all of one form are given, > 0.
    """

    exponent: float
    coefficient: float | None = None
    width: float | None = None
    rise: float | None = None

    name: ClassVar[str] = "power_law"
    units: ClassVar[dict[str, str]] = {"exponent": "1", "coefficient": "m^(1-n)", "width": "m", "rise": "m"}
    spellings: ClassVar[tuple[tuple[str, ...], ...]] = (
        ("exponent", "coefficient"),
        ("exponent", "width", "rise"),
    )

    @classmethod
    def stretch(cls, parameters: dict[str, Floats]) -> tuple[Floats, Floats, Floats]:
        """l, H and n; with a coefficient, l is one metre."""
        exponent = parameters["exponent"]
        if "coefficient" in parameters:
            return np.ones_like(exponent), parameters["coefficient"], exponent
        return parameters["width"], parameters["rise"], exponent

"""The MDR profile g(x) that a row of springs is pressed by: of a shape, or of any profile f(r) given as a function."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar, Protocol

import numpy as np

from roughmdr.errors import OutOfRange, ShapeError
from roughmdr.numerics.arguments import Floats
from roughmdr.shapes import Shape
from roughmdr.springs.reduced import reduced

_FALL = 1e-12  # of the highest f, by which a function may fall: rounding
_DIP = 1e-9  # of the largest g, likewise


class MdrProfile(Protocol):
    """What a row of springs needs to know."""

    @property
    def limit(self) -> float:
        """The radius [m] where the body ends; inf where it never does."""

    @property
    def flat(self) -> float:
        """The radius [m] to which it is known to be flat."""

    @property
    def start(self) -> float:
        """A radius [m], any, within the profile."""

    @property
    def least_exponent(self) -> float:
        """The least n of a tip that is known to be r^n."""

    def row(self, spacing: float, count: int) -> Floats:
        """g [m] of ``count`` springs at (i + 1/2) spacing [m]; inf beyond the limit."""

    def at(self, x: Floats, springs: int) -> tuple[Floats, Floats]:
        """g [m] and G = ∫_0^x g dx [m2] at radii [m], as right as so many springs are; beyond the limit inf and 0."""


@dataclass(frozen=True)
class OfShape:
    """That of a shape, by its g and G."""

    shape: Shape

    @property
    def limit(self) -> float:
        """The radius of a punch or a sphere."""
        return self.shape.limit

    @property
    def flat(self) -> float:
        """The radius of the flat at the tip."""
        return self.shape.nondimensional()[0] if self.shape.flat else 0.0

    @property
    def start(self) -> float:
        """Where the profile ends or, where it never does, its width."""
        return self.shape.end if math.isfinite(self.shape.end) else self.shape.nondimensional()[0]

    @property
    def least_exponent(self) -> float:
        """That of power laws and their series."""
        return self.shape.least_exponent(np.array([self.shape.nondimensional()[2]]))

    def row(self, spacing: float, count: int) -> Floats:
        """g of the shape."""
        x = spacing * (np.arange(count) + 0.5)
        g, inside = np.full_like(x, np.inf), x < self.limit
        g[inside] = self.shape.g(x[inside])
        return g

    def at(self, x: Floats, springs: int) -> tuple[Floats, Floats]:
        """g and G of the shape."""
        g, G, inside = np.full_like(x, np.inf), np.zeros_like(x), x < self.limit
        g[inside], G[inside] = self.shape.g(x[inside]), self.shape.G(x[inside])
        return g, G


@dataclass(frozen=True)
class OfFunction:
    """That of f(r), which is looked at on the edges between springs alone: a parabola from each to the next."""

    f: Callable[[Floats], Floats]

    limit: ClassVar[float] = math.inf
    flat: ClassVar[float] = 0.0
    start: ClassVar[float] = 1e-12
    least_exponent: ClassVar[float] = math.inf

    def __post_init__(self) -> None:
        self.heights(np.zeros(1))

    def row(self, spacing: float, count: int) -> Floats:
        """g from f at the edges between the springs; OutOfRange where it falls."""
        g = reduced(self.heights(spacing * np.arange(count + 1.0)))
        if (np.diff(g) < -_DIP * g.max()).any():
            x = spacing * (np.argmin(np.diff(g)) + 1.5)
            raise OutOfRange(f"the profile is so concave near r = {x:.3g} m that the contact would not be a disc there")
        return g

    def at(self, x: Floats, springs: int) -> tuple[Floats, Floats]:
        """The same from a row for each radius, whose last spring stands there."""
        spacings = x / (springs - 0.5)
        g = np.array([reduced(self.heights(spacing * np.arange(springs + 1.0))) for spacing in spacings])
        return g[:, -1], spacings * (g.sum(axis=1) - 0.5 * g[:, -1])

    def heights(self, r: Floats) -> Floats:
        """f at rising radii from 0 on; ShapeError where it is no profile."""
        try:
            f = np.asarray(self.f(r), dtype=np.float64)
        except (TypeError, ValueError):
            raise ShapeError(f"the profile {self.f!r} does not take an array of radii, or returns no numbers") from None
        if f.shape != r.shape:
            raise ShapeError(f"the profile {self.f!r} returns the shape {f.shape} for radii of the shape {r.shape}")
        undefined = ~np.isfinite(f)
        if undefined.any():
            k = int(np.argmax(undefined))
            raise ShapeError(f"the profile is {f[k]} at r = {r[k]:g} m; it must be finite as far as contact may reach")
        if f[0] != 0.0:
            raise ShapeError(f"the profile is {f[0]:g} m at r = 0; it must be 0 there")
        falls = np.diff(f) < -_FALL * f.max(initial=0.0)
        if falls.any():
            k = int(np.argmax(falls))
            step = f"{f[k + 1]:g} m at r = {r[k + 1]:g} m after {f[k]:g} m at {r[k]:g} m"
            raise ShapeError(f"the profile falls to {step}; the tip must be its lowest point")
        return f

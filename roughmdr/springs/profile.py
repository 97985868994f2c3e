"""The MDR profile g(x) that is pressed into a row of springs: of a shape, or of any function f(r)."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from roughmdr.errors import OutOfRange, ShapeError
from roughmdr.numerics.arguments import Floats, Ints
from roughmdr.shapes import Shape

_FALL_ROUNDING = 1e-12  # fall of a function f, over the highest f, that counts as rounding
_DIP_ROUNDING = 1e-9  # fall of g, over the largest g, that counts as rounding
_BLOCK = 64  # edges in the smallest block
_POINTS = 20  # Chebyshev points of a block: at the distance of its width, (3 + sqrt(8))^-20 is below a rounding
_CHUNK = 1 << 19  # numbers in memory at once

_NODES = 0.5 - 0.5 * np.cos(np.pi * (np.arange(_POINTS) + 0.5) / _POINTS)


@dataclass(frozen=True)
class ShapeProfile:
    """The profile of a shape, by its g and G."""

    shape: Shape

    @property
    def limit(self) -> float:
        """The radius [m] where the body ends; inf where it never does."""
        return self.shape.limit

    @property
    def plateau(self) -> float:
        """The radius [m] to which it is known to be flat."""
        return self.shape.nondimensional()[0] if self.shape.flat else 0.0

    @property
    def start(self) -> float:
        """A radius [m], any, within the profile: where it ends or, where it never does, its width."""
        return self.shape.end if math.isfinite(self.shape.end) else self.shape.nondimensional()[0]

    @property
    def least_exponent(self) -> float:
        """The least n of a tip that is known to be r^n."""
        return self.shape.least_exponent(np.array([self.shape.nondimensional()[2]]))

    def row(self, spacing: float, count: int) -> Floats:
        """Return g [m] of ``count`` springs at (i + 1/2) spacing [m]; inf beyond the limit."""
        x = spacing * (np.arange(count) + 0.5)
        g, inside = np.full_like(x, np.inf), x < self.limit
        g[inside] = self.shape.g(x[inside])
        return g

    def at(self, x: Floats, springs: int) -> tuple[Floats, Floats]:
        """Return g [m] and G = ∫_0^x g dx [m2] at radii [m], as exact as so many springs; inf and 0 beyond."""
        g, G, inside = np.full_like(x, np.inf), np.zeros_like(x), x < self.limit
        g[inside], G[inside] = self.shape.g(x[inside]), self.shape.G(x[inside])
        return g, G


@dataclass(frozen=True)
class FunctionProfile:
    """The profile of f(r), which is evaluated on the edges between springs alone: a parabola from each to the next."""

    f: Callable[[Floats], Floats]

    limit: ClassVar[float] = math.inf
    plateau: ClassVar[float] = 0.0
    start: ClassVar[float] = 1e-12
    least_exponent: ClassVar[float] = math.inf

    def __post_init__(self) -> None:
        self.heights(np.zeros(1))

    def row(self, spacing: float, count: int) -> Floats:
        """Return g of the springs from f at the edges between them; OutOfRange where it falls."""
        g = mdr_transform(self.heights(spacing * np.arange(count + 1.0)))
        if (np.diff(g) < -_DIP_ROUNDING * g.max()).any():
            x = spacing * (np.argmin(np.diff(g)) + 1.5)
            raise OutOfRange(f"the profile is so concave near r = {x:.3g} m that the contact would not be a disc there")
        return g

    def at(self, x: Floats, springs: int) -> tuple[Floats, Floats]:
        """Return g and G at radii x, each from a row whose last spring stands there."""
        spacings = x / (springs - 0.5)
        g = np.array([mdr_transform(self.heights(spacing * np.arange(springs + 1.0))) for spacing in spacings])
        return g[:, -1], spacings * (g.sum(axis=1) - 0.5 * g[:, -1])

    def heights(self, r: Floats) -> Floats:
        """Return f at rising radii from 0 on; ShapeError where it is no profile."""
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
        falls = np.diff(f) < -_FALL_ROUNDING * f.max(initial=0.0)
        if falls.any():
            k = int(np.argmax(falls))
            step = f"{f[k + 1]:g} m at r = {r[k + 1]:g} m after {f[k]:g} m at {r[k]:g} m"
            raise ShapeError(f"the profile falls to {step}; the tip must be its lowest point")
        return f


def mdr_transform(heights: Floats) -> Floats:
    """Return g [m] at (i + 1/2) dx from f [m] at i dx, i = 0, 1, ...: one number less. Lengths are in units of dx.

    In g = x ∫_0^x f'(r)/sqrt(x^2 - r^2) dr, from each edge between springs to the next, f' is taken as a straight line
    whose mean is the slope of the chord of f. Lines are integrated exactly, by ∫ dr/sqrt(x^2 - r^2) = -acos(r/x) and
    ∫ r dr/sqrt(x^2 - r^2) = -sqrt(x^2 - r^2). Summed over the changes of slope and curvature at each edge r that is

        g = x sum (change of slope) acos(r/x) + x^2 sum (change of curvature) sqrt(1 - (r/x)^2).

    Both kernels are smooth in r away from x. So the edges of a block that lies apart from a spring are replaced by a
    few, at Chebyshev's points, and blocks grow with their distance: N log N evaluations instead of N^2
    (L. Greengard, V. Rokhlin, J. Comput. Phys. 73 (1987) 325, in one dimension).
    """
    slope, curvature = _lines(heights)
    steps = np.stack([np.diff(slope, prepend=0.0), np.diff(curvature, prepend=0.0)])
    count = slope.size
    blocks = np.pad(steps, ((0, 0), (_BLOCK, -count % _BLOCK))).reshape(2, -1, _BLOCK)
    near = np.concatenate([blocks[:, :-1], blocks[:, 1:]], axis=2)  # a block and the one before it
    block = np.arange(count) // _BLOCK
    g = np.zeros(count)
    _add(g, np.arange(count), block, near, _BLOCK * (block - 1), np.arange(2.0 * _BLOCK))
    size, moments = _BLOCK, blocks[:, 1:] @ _weights(np.arange(_BLOCK) / _BLOCK)
    while moments.shape[1] > 2:
        block = np.arange(count) // size
        for back in (2, 3):  # for odd numbers the third block before is not yet in a larger one
            far = np.flatnonzero((block >= back) & ((block % 2 == 1) | (back == 2)))
            source = block[far] - back
            _add(g, far, source, moments, size * source, size * _NODES)
        moments = np.pad(moments, ((0, 0), (0, moments.shape[1] % 2), (0, 0)))
        moments = moments[:, ::2] @ _weights(0.5 * _NODES) + moments[:, 1::2] @ _weights(0.5 + 0.5 * _NODES)
        size *= 2
    return g


def _lines(heights: Floats) -> tuple[Floats, Floats]:
    """Return f' on each piece, extrapolated to the axis, and its slope, from the chords beside it."""
    chord = np.diff(heights)
    limit = 2.0 * np.abs(chord)
    curvature = np.clip(np.gradient(chord), -limit, limit)
    return chord - curvature * (np.arange(chord.size) + 0.5), curvature


def _weights(positions: Floats) -> Floats:
    """Return the weights at Chebyshev's points that replace a source at each position in a block, from 0 to 1."""
    basis = np.polynomial.chebyshev.chebvander
    basis_at_nodes = basis(2.0 * _NODES - 1.0, _POINTS - 1)
    return np.asarray(basis(2.0 * positions - 1.0, _POINTS - 1) @ np.linalg.inv(basis_at_nodes))


def _add(g: Floats, springs: Ints, source: Ints, steps: Floats, begin: Ints, positions: Floats) -> None:
    """Add to g of some springs the steps of one source block each, at ``begin`` plus ``positions``."""
    chunk = _CHUNK // positions.size
    for first in range(0, springs.size, chunk):
        part = slice(first, first + chunk)
        x = springs[part] + 0.5
        ratio = np.clip((begin[part, None] + positions) / x[:, None], -1.0, 1.0)
        slope, curvature = steps[:, source[part]]
        g[springs[part]] += x * (np.arccos(ratio) * slope).sum(axis=1)
        g[springs[part]] += x * x * (np.sqrt((1.0 - ratio) * (1.0 + ratio)) * curvature).sum(axis=1)

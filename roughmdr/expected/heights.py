"""The density of heights as a table of polynomials, and the fraction of all heights below a height.

Next to a pole no polynomial holds the density: there the fractions of the heights tell how many stand on a piece, and
the piece is so narrow that it hardly matters where on it they do.
"""

import math
from typing import NamedTuple

import numpy as np

from roughmdr.ensemble.nodes import Heights, UpperTail
from roughmdr.errors import OutOfRange
from roughmdr.expected.integral import mass
from roughmdr.expected.table import ORDER, Table
from roughmdr.numerics.arguments import Floats

_TOLERANCE, _RATIO = 1e-13, 1e3  # how right it is on each piece, of all heights, and how much it may vary there
_MISSING = 1e-12  # of all heights: less is roundings, which must not count as the highest of a heavy tail
_NARROWEST = 2.0**-44  # of the scale of the heights, or of the height itself: narrower pieces are not halved
_ROUNDING = 2.0**-51  # of a height
_NOISY = 1e-2  # polynomials that are off by less than this part are those of a smooth density with roundings

# What ∫ T_n du from -1 to 1 comes to.
_INTEGRALS = np.array([2.0 / (1.0 - n * n) if n % 2 == 0 else 0.0 for n in range(ORDER)])


class HeightTable(NamedTuple):
    """The density over pieces from the lowest summit to the highest, as differences y [m] to ``origin``."""

    low: Floats
    """[piece]"""
    high: Floats
    """[piece]"""
    coefficients: Floats
    """Of the density [1/m]: [piece, 1, order]."""
    doubt: Floats
    """How far the density may be off [1/m]; the part of all heights that stands anywhere on the piece; the part that
    may stand on it or not: [piece, 3]."""
    below: Floats
    """The part of all heights below each edge: [piece + 1]; the last is 1 but for errors."""
    origin: float
    """[m]"""
    tail: UpperTail

    @classmethod
    def of(cls, heights: Heights) -> "HeightTable":
        """The table of heights; OutOfRange where no float holds their density."""

        def density(y: Floats) -> Floats:
            return heights.density(y)[None]

        def narrow(low: Floats, high: Floats) -> Floats:
            return _NARROWEST * np.maximum(heights.scale, np.maximum(np.abs(low), np.abs(high)))

        def weight(low: Floats, high: Floats, greatest: Floats) -> Floats:
            return np.minimum((high - low) * np.maximum(1.0 / heights.scale, greatest), 1.0)

        edges = np.array(heights.edges)
        table = Table.of(density, edges, np.array([_TOLERANCE]), narrow, weight, _RATIO, _ROUNDING)
        width, slack, coefficients = table.high - table.low, table.slack[:, 0], table.coefficients
        parts = 0.5 * width * (coefficients[:, 0] @ _INTEGRALS)
        loose, unknown = np.zeros_like(parts), np.zeros_like(parts)
        if heights.fractions is not None:
            counted = _counted(*heights.fractions(np.append(table.low, table.high[-1])))
            apart = np.abs(counted - parts)
            vague = ~(slack * width <= _TOLERANCE) | (apart > _NOISY)  # no node may stand where all heights do
            scaled = vague & (slack * width < _NOISY * parts) & (apart < _NOISY * parts)
            even = vague & ~scaled
            coefficients[scaled] *= (counted[scaled] / parts[scaled])[:, None, None]
            coefficients[even] = 0.0
            coefficients[even, 0, 0] = (counted / width)[even]
            loose[even], loose[scaled] = counted[even], np.minimum(counted, slack * width)[scaled]
            unknown[~vague] = apart[~vague]
            parts = np.where(vague, counted, parts)
            slack = np.where(vague, 0.0, slack)
            missing = abs(1.0 - float(parts.sum())) - float(unknown.sum())
            unknown[-1] += missing if missing > _MISSING else 0.0
        unknown[-1] += heights.tail.fraction
        doubt = np.column_stack([slack, loose, unknown])
        if not (np.isfinite(coefficients).all() and np.isfinite(doubt).all()):
            raise OutOfRange(
                f"no float holds the density of the heights, about {heights.origin:g} m and {heights.scale:g} m wide"
            )
        share = np.concatenate([[0.0], np.cumsum(parts)])
        return cls(table.low, table.high, coefficients, doubt, share, heights.origin, heights.tail)

    def between(self, begin: Floats, end: Floats) -> Floats:
        """The part of all heights from ``begin`` to ``end``, as differences to the origin [m]."""
        ends = np.array([begin, end])
        parts = np.array([mass(self.below, self.low, self.high, self.coefficients, y) for y in ends.ravel()])
        low, high = parts.reshape(ends.shape)
        return np.asarray(high - low)

    def undecided(self, y: Floats) -> Floats:
        """The part of all heights of which nothing tells whether they lie below y [m], as differences to the origin."""
        piece = np.minimum(np.searchsorted(self.high, y), self.high.size - 1)
        within = (self.low[piece] < y) & (y < self.high[piece])
        return np.where(within, self.doubt[piece, 1], 0.0)

    def highest(self, count: float) -> float:
        """A height [m] that about one of ``count`` summits reaches."""
        rest = self.below[-1] - self.below[1:]
        return self.origin + float(self.high[np.argmax(rest <= 1.0 / max(count, 1.0))])


def _counted(below: Floats, above: Floats) -> Floats:
    """The part of all heights on each piece, from the fractions below and above its edges, by the nearer tail.

    Heights below all pieces count as on the first. Where no fraction is known, all that is missing may stand.
    """
    below[0], above[0] = 0.0, 1.0
    if not (math.isfinite(below[-1]) and math.isfinite(above[-1])):  # as of kappa4 at its ends
        below[-1], above[-1] = 1.0, 0.0
    counted = np.where(below[1:] < above[1:], below[1:] - below[:-1], above[:-1] - above[1:])
    missing = max(1.0 - float(np.nansum(counted)), 0.0)
    return np.where(np.isfinite(counted), counted, missing).clip(min=0.0)

"""The density of heights as a table, and the fraction of all heights below a height.

Next to a pole no polynomial fits the density. There the distribution function gives the fraction of the heights on a
piece, and the piece is so narrow that their position on it hardly matters.
"""

import math
from typing import NamedTuple

import numpy as np

from roughmdr.ensemble.nodes import Heights, UpperTail
from roughmdr.errors import OutOfRange
from roughmdr.expected.table import ORDER, AdaptiveTable
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.chebyshev import evaluate_series, find_piece
from roughmdr.numerics.gauss import gauss
from roughmdr.numerics.jit import njit

_TOLERANCE, _MAX_RATIO = 1e-13, 1e3  # error of each piece, of all heights, and how much the density may vary there
_MISSING = 1e-12  # fraction of all heights that is rounding, and must not count as the top of a heavy tail
_MIN_WIDTH = 2.0**-44  # least width of a piece, over the scale of the heights or over the height itself
_ROUNDING = 2.0**-51  # relative rounding of a height
_SMOOTH = 1e-2  # relative error of a series up to which the density is taken to be smooth with roundings

_NODES, _WEIGHTS = gauss(16)
# ∫ T_n du from -1 to 1.
_INTEGRALS = np.array([2.0 / (1.0 - n * n) if n % 2 == 0 else 0.0 for n in range(ORDER)])


class HeightTable(NamedTuple):
    """The density over pieces from the lowest summit to the highest, as differences y [m] to ``origin``."""

    low: Floats
    """[piece]"""
    high: Floats
    """[piece]"""
    coefficients: Floats
    """Coefficients of the density [1/m]: [piece, 1, order]."""
    doubt: Floats
    """Error bound of the density [1/m]; fraction of all heights that lie on the piece, nobody knows where; fraction of
    which it is not known whether they lie on it: [piece, 3]."""
    below: Floats
    """Fraction of all heights below each edge: [piece + 1]; the last is 1 but for errors."""
    origin: float
    """[m]"""
    tail: UpperTail

    @classmethod
    def of(cls, heights: Heights) -> "HeightTable":
        """Tabulate heights; OutOfRange where no float holds their density."""
        if heights.edges[0] == heights.edges[-1]:
            none, one, zeros = np.zeros(1), np.array([0.0, 1.0]), np.zeros((1, 1, ORDER))
            return cls(none, none, zeros, np.zeros((1, 3)), one, heights.origin, heights.tail)

        def density(y: Floats) -> Floats:
            return heights.density(y)[None]

        def min_width(low: Floats, high: Floats) -> Floats:
            return _MIN_WIDTH * np.maximum(heights.scale, np.maximum(np.abs(low), np.abs(high)))

        def weight(low: Floats, high: Floats, largest: Floats) -> Floats:
            return np.minimum((high - low) * np.maximum(1.0 / heights.scale, largest), 1.0)

        edges, tolerance = np.array(heights.edges), np.array([_TOLERANCE])
        table = AdaptiveTable.of(density, edges, tolerance, min_width, weight, _MAX_RATIO, _ROUNDING)
        width, error, coefficients = table.high - table.low, table.error_bound[:, 0], table.coefficients
        fraction = 0.5 * width * (coefficients[:, 0] @ _INTEGRALS)
        anywhere, unknown = np.zeros_like(fraction), np.zeros_like(fraction)
        if heights.fractions is not None:
            counted = _counted(*heights.fractions(np.append(table.low, table.high[-1])))
            deviation = np.abs(counted - fraction)
            vague = ~(error * width <= _TOLERANCE) | (deviation > _SMOOTH)  # nodes may miss the heights
            scaled = vague & (error * width < _SMOOTH * fraction) & (deviation < _SMOOTH * fraction)
            even = vague & ~scaled
            coefficients[scaled] *= (counted[scaled] / fraction[scaled])[:, None, None]
            coefficients[even] = 0.0
            coefficients[even, 0, 0] = (counted / width)[even]
            anywhere[even], anywhere[scaled] = counted[even], np.minimum(counted, error * width)[scaled]
            unknown[~vague] = deviation[~vague]
            fraction = np.where(vague, counted, fraction)
            error = np.where(vague, 0.0, error)
            missing = abs(1.0 - float(fraction.sum())) - float(unknown.sum())
            unknown[-1] += missing if missing > _MISSING else 0.0
        unknown[-1] += heights.tail.fraction
        doubt = np.column_stack([error, anywhere, unknown])
        if not (np.isfinite(coefficients).all() and np.isfinite(doubt).all()):
            raise OutOfRange(
                f"no float holds the density of the heights, about {heights.origin:g} m and {heights.scale:g} m wide"
            )
        below = np.concatenate([[0.0], np.cumsum(fraction)])
        return cls(table.low, table.high, coefficients, doubt, below, heights.origin, heights.tail)

    @property
    def all_equal(self) -> bool:
        """Whether all heights are at the origin, where they have no density."""
        return bool(self.low[0] == self.high[-1])

    def between(self, begin: Floats, end: Floats) -> Floats:
        """Return the fraction of all heights from ``begin`` to ``end``, as differences to the origin [m]."""
        if self.all_equal:
            return np.where((begin <= 0.0) & (end > 0.0), 1.0, 0.0)
        ends = np.array([begin, end])
        low, high = _fractions_below(self, ends.ravel()).reshape(ends.shape)
        return np.asarray(high - low)

    def undecided(self, y: Floats) -> Floats:
        """Return the fraction of all heights that may lie above or below y [m], as differences to the origin."""
        piece = np.minimum(np.searchsorted(self.high, y), self.high.size - 1)
        within = (self.low[piece] < y) & (y < self.high[piece])
        return np.where(within, self.doubt[piece, 1], 0.0)

    def highest(self, count: float) -> float:
        """Return a height [m] that about one of ``count`` summits exceeds."""
        above = self.below[-1] - self.below[1:]
        return self.origin + float(self.high[np.argmax(above <= 1.0 / max(count, 1.0))])


def _counted(below: Floats, above: Floats) -> Floats:
    """Return the fraction of all heights on each piece, from the fractions below its edges or above, the smaller ones.

    Heights below all pieces count as on the first. A piece of unknown fraction gets all that the others leave.
    """
    below[0], above[0] = 0.0, 1.0
    if not (math.isfinite(below[-1]) and math.isfinite(above[-1])):  # as of kappa4 at its ends
        below[-1], above[-1] = 1.0, 0.0
    counted = np.where(below[1:] < above[1:], below[1:] - below[:-1], above[:-1] - above[1:])
    missing = max(1.0 - float(np.nansum(counted)), 0.0)
    return np.where(np.isfinite(counted), counted, missing).clip(min=0.0)


@njit
def _fractions_below(heights: HeightTable, y: Floats) -> Floats:
    """Return the fraction of all heights below each y [m]."""
    fractions = np.empty(y.size)
    u, density = np.empty((2, _NODES.size))
    before, earlier = np.empty(_NODES.size), np.empty(_NODES.size)  # apart, as in ``integral``: one form serves both
    for i in range(y.size):
        if y[i] <= heights.low[0]:
            fractions[i] = 0.0
        elif y[i] >= heights.high[-1]:
            fractions[i] = heights.below[-1]
        else:
            piece = find_piece(heights.high, y[i])
            low, high = heights.low[piece], heights.high[piece]
            half, middle = 0.5 * (y[i] - low), 0.5 * (y[i] + low)
            for m in range(u.size):
                u[m] = (2.0 * (middle + half * _NODES[m]) - low - high) / (high - low)
            evaluate_series(heights.coefficients[piece, 0], u, density, before, earlier)
            integral = 0.0
            for m in range(u.size):
                integral += _WEIGHTS[m] * density[m]
            fractions[i] = heights.below[piece] + half * integral
    return fractions

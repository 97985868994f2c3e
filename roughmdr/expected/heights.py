"""The density of heights as a table, and what part of them lies below a height."""

from typing import NamedTuple

import numpy as np

from roughmdr.arguments import Floats
from roughmdr.ensemble.nodes import Heights
from roughmdr.expected.integral import mass
from roughmdr.expected.table import ORDER, Table

_TOLERANCE, _RATIO = np.array([1e-13]), 1e3  # how right it is on each piece, and how much it may vary there
_LAST_BITS = 2.0**-44  # of the width of the distribution: narrower pieces are not halved
_INSIDE = 2.0**-51  # of the width: so near to an end heights can just be told from it, where there may be a pole
_FLOATS = 2.0  # neighbouring floats that are as near

# What ∫ T_n du from -1 to 1 comes to.
_INTEGRALS = np.array([2.0 / (1.0 - n * n) if n % 2 == 0 else 0.0 for n in range(ORDER)])


class HeightTable(NamedTuple):
    """The density over pieces from the lowest summit to the highest."""

    table: Table
    below: Floats
    """The part of all heights below each edge: [piece + 1]; the last is 1 but for errors."""
    poles: Floats
    """Heights next to which the density may have a pole, or a kink."""

    @classmethod
    def of(cls, heights: Heights) -> "HeightTable":
        """The table of heights."""
        edges = np.array([heights.low, heights.high])
        apart = _FLOATS * float(np.spacing(np.abs(edges).max()))
        narrowest, inside = max(_LAST_BITS * heights.scale, 4.0 * apart), max(_INSIDE * heights.scale, apart)

        def density(z: Floats) -> Floats:
            return heights.density(z.clip(edges[0] + inside, edges[1] - inside))[None]

        def narrow(low: Floats, high: Floats) -> Floats:
            return np.full_like(low, narrowest)

        def weight(low: Floats, high: Floats) -> Floats:
            return np.minimum((high - low) / heights.scale, 1.0)

        table = Table.of(density, edges, _TOLERANCE, narrow, weight, _RATIO)
        pieces = 0.5 * (table.high - table.low) * (table.coefficients[:, 0] @ _INTEGRALS)
        poles = table.high[table.high - table.low <= narrowest]
        return cls(table, np.concatenate([[0.0], np.cumsum(pieces)]), poles)

    @property
    def defect(self) -> float:
        """By how much all heights are not 1."""
        return abs(float(self.below[-1]) - 1.0)

    def between(self, begin: Floats, end: Floats) -> Floats:
        """The part of all heights from ``begin`` to ``end``."""
        table = self.table
        ends = np.array([begin, end])
        parts = np.array([mass(self.below, table.low, table.high, table.coefficients, z) for z in ends.ravel()])
        low, high = parts.reshape(ends.shape)
        return np.asarray(high - low)

    def highest(self, count: float) -> float:
        """A height that about one of ``count`` summits reaches."""
        rest = self.below[-1] - self.below[1:]
        return float(self.table.high[np.argmax(rest <= 1.0 / max(count, 1.0))])

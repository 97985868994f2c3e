"""The mean contact of asperities whose heights have one distribution, above first touch.

Summits above the flat are in contact whatever the path was. There the sum over shape parameters and the integral over
heights may change places: one curve, the mean over the nodes, is integrated instead of one for each node.
"""

import math
from typing import NamedTuple

import numpy as np

from roughmdr.asperity.contact import Contact
from roughmdr.ensemble.nodes import Heights
from roughmdr.expected.curve import Curve, over_s, quantities_at, rtol_of, scales_of, tabulate
from roughmdr.expected.heights import HeightTable
from roughmdr.expected.integral import integrate
from roughmdr.expected.intervals import Intervals
from roughmdr.numerics.arguments import Floats, Ints

_ONE_BRANCH = 1


class MeanContact(NamedTuple):
    """The mean curve of contacts of one branch, and the heights that they share."""

    depth: float
    """[m]; s^2 is the indentation over it, with adhesion plus 1."""
    scales: Floats
    """[row]"""
    curve: Curve
    heights: HeightTable

    @classmethod
    def of(
        cls,
        contacts: list[Contact],
        fractions: Floats,
        heights: tuple[Heights, HeightTable],
        closest: float,
        rows: tuple[int, ...],
    ) -> "MeanContact":
        """Return the sum of contacts times their fractions of all, up to the indentation of the highest summit by the
        flat at ``closest`` [m]; OutOfRange where the heights reach too far.
        """
        own, table = heights
        adhesive = bool(contacts[0].kernels.adhesive)
        depths = np.array([contact.depth[0] for contact in contacts])
        shallowest = contacts[int(np.argmin(depths))]  # above its fold no other contact has one
        depth = shallowest.depth[0]
        scales = scales_of(contacts[int(np.argmax(fractions))], rows)
        shares = fractions * np.array([scales_of(contact, rows) / scales for contact in contacts]).T
        groups: dict[bytes, list[int]] = {}
        for number, contact in enumerate(contacts):
            groups.setdefault(np.asarray(contact.params).tobytes(), []).append(number)

        def quantities(s: Floats) -> Floats:
            total = np.zeros((len(rows), s.size))
            indentation = (s - 1.0) * (s + 1.0) if adhesive else s * s
            for group in groups.values():
                x = float(adhesive) + np.outer(depth / depths[group], indentation)
                found = quantities_at(contacts[group[0]], x.ravel(), _ONE_BRANCH, rows).reshape(len(rows), *x.shape)
                total += (shares[:, group, None] * found).sum(axis=1)
            return over_s(total, s, rows)

        deepest = max(own.edges[-1] - (closest - own.origin), own.scale) / depth
        ends = (float(adhesive), math.sqrt(deepest + float(adhesive)))
        series = tabulate(quantities, ends, rtol_of(rows), own.scale / depth, shallowest)
        curve = Curve(np.array([0, series.low.size]), np.array([float(adhesive)]), series)
        return cls(depth, scales, curve, table)

    def add_to(self, total: Floats, separation: Floats, steps: Ints, stiffness_row: int) -> int:
        """Add the sums over the summits above the flat to total[row, step] at some steps, the last row the error bound
        of the first; return how often tables were multiplied.
        """
        distinct, number = np.unique(separation[steps], return_inverse=True)
        relative, ones = distinct - self.heights.origin, np.ones(distinct.size, dtype=np.int64)
        above = Intervals(np.arange(distinct.size), ones, ones, relative, np.full(distinct.size, math.inf))
        found = np.zeros((total.shape[0], distinct.size))
        products = integrate(above, relative, self.depth, self.curve, self.heights, stiffness_row, found)
        scales = np.append(self.scales[: total.shape[0] - 1], self.scales[0])
        total[:, steps] += (scales[:, None] * found)[:, number]
        return int(products)

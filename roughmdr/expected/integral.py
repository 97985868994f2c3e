"""Integrals of the quantities of a contact over the density of its heights, step by step: products of two tables."""

import math
from typing import NamedTuple

import numpy as np

from roughmdr.asperity.contact import Contact
from roughmdr.ensemble.nodes import Heights
from roughmdr.expected.curve import Curve, over_s, quantities_at, rtol_of, scales_of, tabulate
from roughmdr.expected.heights import HeightTable
from roughmdr.expected.intervals import Intervals
from roughmdr.numerics.arguments import Floats, Ints
from roughmdr.numerics.chebyshev import evaluate_series, find_piece
from roughmdr.numerics.gauss import gauss, last_coefficients
from roughmdr.numerics.jit import njit

_NODES, _WEIGHTS = gauss(16)
_LAST = last_coefficients(16)  # coefficients of a product that tell how far its integral may be off
_NARROW = 2.0**-5  # width of an interval, over the distance to the onset of contact, that counts as narrow
_BETWEEN_NODES = 1.1  # range of values on a piece over that at its nodes, which lie within its ends
_ONE_BRANCH = 1


@njit
def _place_nodes(begin: float, end: float, h: float, offset: float, depth: float, nodes: tuple[Floats, ...]) -> None:
    """Fill ``nodes`` with Gauss's nodes over the heights from ``begin`` to ``end`` [m].

    Its rows are s, (z - begin) - (end - z), and the weights of dz and ds. The variable is s, in which the quantities of
    a contact are smooth. Far from the onset, though, roundings of s are seen on pieces that are narrow beside their
    distance to it: there the variable is z.
    """
    s, z, weight, weight_of_s = nodes
    distance = (end - h) + offset * depth
    if end - begin < _NARROW * distance:
        half, middle = 0.5 * (end - begin), 0.5 * (end + begin)
        for m in range(s.size):
            s[m] = np.sqrt(max((middle + half * _NODES[m] - h) / depth + offset, 0.0))
            z[m] = (end - begin) * _NODES[m]
            weight[m] = _WEIGHTS[m] * half
            weight_of_s[m] = weight[m] / (2.0 * s[m])
    else:
        low, high = np.sqrt(max((begin - h) / depth + offset, 0.0)), np.sqrt(max(distance / depth, 0.0))
        half, middle = 0.5 * (high - low), 0.5 * (high + low)
        for m in range(s.size):
            s[m] = middle + half * _NODES[m]
            height = h + (s[m] * s[m] - offset) * depth
            z[m] = (height - begin) - (end - height)
            weight_of_s[m] = _WEIGHTS[m] * half * depth
            weight[m] = weight_of_s[m] * 2.0 * s[m]


@njit
def _error(force: Floats, density: Floats, weight: Floats, force_error: float, doubt: Floats, cut: bool) -> float:
    """Return how far the integral of the force over a density may be off.

    The error is that of the rule, those of both tables, and that of heights that are known only to be on the piece, or
    perhaps not on it; ``doubt`` is that of a ``HeightTable``. On a piece that is ``cut`` they may be in contact or not.
    """
    last, last_but_one, largest, mass, force_integral, force_max = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for m in range(force.size):
        value = force[m] * density[m] * (weight[m] / _WEIGHTS[m])
        last_but_one += _LAST[0, m] * value
        last += _LAST[1, m] * value
        largest = max(largest, abs(value))
        mass += weight[m] * abs(density[m])
        force_integral += weight[m] * abs(force[m])
        force_max = max(force_max, abs(force[m]))
    tail = max(abs(last_but_one), abs(last)) / largest if largest > 0.0 else 0.0
    force_range = abs(force[-1] - force[0])
    unknown = doubt[2] + (doubt[1] if cut else 0.0)
    misplaced = _BETWEEN_NODES * (doubt[1] * force_range + unknown * force_max)
    return float(largest * tail**1.5 + force_error * mass + doubt[0] * force_integral + misplaced)


@njit
def integrate(
    intervals: Intervals,
    separation: Floats,
    depth: float,
    curve: Curve,
    heights: HeightTable,
    stiffness_row: int,
    total: Floats,
) -> int:
    """Add to total[row, step] the quantities of ``curve`` over the heights of each interval.

    Separations and intervals are [m], as differences to the origin of ``heights``, ``depth`` [m] is that of the
    contact. Row ``stiffness_row`` (-1 for none) of the curve is times 2 s; the last row of ``total`` takes the error
    bound of the first. Returns how often two pieces were multiplied.
    """
    # Arrays are taken out of their tuples before the loops, which are slow otherwise.
    steps, branches, begins, ends = intervals.step, intervals.branch, intervals.begin, intervals.end
    z_low, z_high, densities, doubts = heights.low, heights.high, heights.coefficients, heights.doubt
    firsts, offsets, table = curve.first, curve.offset, curve.table
    s_low, s_high, coefficients, errors = table.low, table.high, table.coefficients, table.error_bound
    n = _NODES.size
    s, z, weight, weight_of_s, u, density, value = np.empty((7, n))
    before, earlier = np.empty(n), np.empty(n)  # apart, so that vector code may rely on no overlap
    nodes = s, z, weight, weight_of_s
    products = 0
    for i in range(steps.size):
        step, branch = steps[i], branches[i] - 1
        h, offset = separation[step], offsets[branch]
        start, stop = max(begins[i], z_low[0]), min(ends[i], z_high[-1])
        if not start < stop:
            continue
        # k is the piece of the curve, j that of the heights.
        first, last = firsts[branch], firsts[branch + 1] - 1
        s_start = np.sqrt(max((start - h) / depth + offset, 0.0))
        k = min(first + find_piece(s_high[first : last + 1], s_start), last)
        j = find_piece(z_high, start)
        begin = start
        while begin < stop and j < z_high.size:
            edge = h + (s_high[k] * s_high[k] - offset) * depth if k < last else np.inf
            low, high = z_low[j], z_high[j]
            end = max(min(stop, high, edge), begin)
            if end > begin:
                _place_nodes(begin, end, h, offset, depth, nodes)
                for m in range(n):
                    u[m] = (((begin - low) - (high - end)) + z[m]) / (high - low)
                evaluate_series(densities[j, 0], u, density, before, earlier)
                for m in range(n):
                    u[m] = (2.0 * s[m] - s_low[k] - s_high[k]) / (s_high[k] - s_low[k])
                for row in range(total.shape[0] - 1):
                    evaluate_series(coefficients[k, row], u, value, before, earlier)
                    measure = weight_of_s if row == stiffness_row else weight
                    integral = 0.0
                    for m in range(n):
                        integral += measure[m] * value[m] * density[m]
                    total[row, step] += integral
                    if row == 0:
                        cut = start > low or stop < high
                        error = errors[k, 0]
                        total[-1, step] += _error(value, density, weight, error, doubts[j], cut)
                products += 1
            if edge <= end:
                k += 1
            if end == high:
                j += 1
            begin = end
    return products


class MeanContact(NamedTuple):
    """The mean curve of contacts of one branch, and the heights that they share, above first touch.

    Summits above the flat are in contact whatever the path was. There the sum over shape parameters and the integral
    over heights may change places: one curve, the mean over the nodes, is integrated instead of one for each node.
    """

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

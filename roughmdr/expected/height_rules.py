"""A few heights with weights that stand for all summits above a lowest height.

Two rules are made. Gauss's for the distribution of the heights suits forces that begin without a jump; the highest
summits, which bear little, are one height of their own, since the nodes of a rule spread out over all that there is.
Cells of equal fractions, each with one height at its mean, suit forces that jump: no cell jumps by more than another.
"""

import numpy as np

from roughmdr.expected.heights import HeightTable
from roughmdr.expected.table import ORDER
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.gauss import gauss

RULES = ("gauss", "equal_fractions")
_NODES, _WEIGHTS = gauss(16)
_POINTS_PER_NODE = {"gauss": 32, "equal_fractions": 256}
_TAIL_POWER, _FEWEST = 1.25, 4
"""Gauss's rule of ``count`` heights has one for the highest summits, those with count^-5/4 of the sum of all heights
above the lowest. Measured on normal and exponential heights and on the summits of Gaussian surfaces, without adhesion:
an error of 6e-4 takes 49, 61 and 123 nodes in place of 105, 549 and 271; powers 1 and 2 take more.
"""
_LEAST_FRACTION = 1e-30  # fraction of all heights: a point of less is left out

Points = tuple[Floats, Floats]
"""Heights, ascending [m], and the fraction of all heights at each."""
_ROUNDINGS = 1e-13  # length of a vector of which rounding alone is left, over the spread


def points_of(heights: HeightTable, lowest: float, count: int, name: str) -> Points:
    """Return the summits above ``lowest`` [m] as points, so fine that ``count`` heights can be made of them.

    Heights are differences to the origin of the table. None where no summit is so high.
    """
    if heights.all_equal:
        return (np.zeros(1), np.ones(1)) if lowest <= 0.0 else (np.empty(0), np.empty(0))
    low, high = np.maximum(heights.low, lowest), heights.high
    kept = low < high
    parts = max(1, -(-_POINTS_PER_NODE[name] * count // (max(int(kept.sum()), 1) * _NODES.size)))
    own = np.repeat(np.flatnonzero(kept), parts)
    number = np.tile(np.arange(parts), int(kept.sum()))
    half = 0.5 * (high - low)[own] / parts
    y = (low[own] + half * (2 * number + 1))[:, None] + half[:, None] * _NODES
    wide = (heights.high - heights.low)[own, None]
    u = ((y - heights.low[own, None]) - (heights.high[own, None] - y)) / wide
    series = np.polynomial.chebyshev.chebvander(u, ORDER - 1) * heights.coefficients[own, 0][:, None, :]
    fractions = (series.sum(axis=-1) * half[:, None] * _WEIGHTS).ravel()
    some = fractions > _LEAST_FRACTION
    return y.ravel()[some], fractions[some]


def rule_of(points: Points, count: int, name: str, offset: float) -> Points:
    """Return ``count`` heights with the fractions that they stand for, by a rule of ``RULES``.

    ``offset``, from 0 to 1, tells apart the rules of asperities of different shape, so that heights of one lie between
    those of others: equal fractions begin at that part of a cell, Gauss's rule has one height more from 1/2 on.
    """
    y, fractions = points
    if y.size == 1:
        return points
    if name == "gauss":
        return _gauss(points, count + int(offset >= 0.5))
    below = np.cumsum(fractions) - 0.5 * fractions
    number = np.floor(below * (count / float(fractions.sum())) + offset).astype(np.int64)
    total = np.bincount(number, fractions)
    mean = y[0] + np.bincount(number, fractions * (y - y[0])) / np.where(total > 0.0, total, 1.0)
    return np.asarray(mean[total > 0.0]), np.asarray(total[total > 0.0], dtype=np.float64)


def _gauss(points: Points, count: int) -> Points:
    """Return the heights of Gauss's rule, the highest summits as one."""
    y, fractions = points
    share = fractions * (y - y[0])
    above = np.cumsum(share[::-1])[::-1]
    rest = int((above > above[0] * count**-_TAIL_POWER).sum())
    if count < _FEWEST or rest == y.size:
        return gauss_of_points(y, fractions, count)
    nodes, weights = gauss_of_points(y[:rest], fractions[:rest], count - 1)
    tail = fractions[rest:]
    highest = y[rest] + float((tail * (y[rest:] - y[rest])).sum() / tail.sum())
    return np.append(nodes, highest), np.append(weights, tail.sum())


def gauss_of_points(x: Floats, weights: Floats, count: int) -> tuple[Floats, Floats]:
    """Return nodes, ascending, and weights of Gauss's rule for weighted points, with ``count`` nodes or one a point.

    It integrates polynomials of degree 2 count - 1 exactly. Nodes are the eigenvalues of the Jacobi matrix of the
    measure, weights follow from their vectors (G. H. Golub, J. H. Welsch, Math. Comp. 23 (1969) 221). The matrix is
    found by Lanczos's recurrence, each vector orthogonalised anew against all before.
    """
    total = weights.sum()
    centre = float((x * weights).sum() / total)
    spread = float(np.sqrt(((x - centre) ** 2 * weights).sum() / total))
    if not spread > 0.0 or count == 1:
        return np.array([centre]), np.array([total])
    at = (x - centre) / spread
    vectors = [np.sqrt(weights / total)]
    diagonal, beside = [], []
    while True:
        image = at * vectors[-1]
        diagonal.append(float((image * vectors[-1]).sum()))
        for _ in range(2):
            for vector in vectors:
                image = image - (image * vector).sum() * vector
        length = float(np.sqrt((image * image).sum()))
        if len(diagonal) == count or length < _ROUNDINGS:
            break
        beside.append(length)
        vectors.append(image / length)
    values, states = np.linalg.eigh(np.diag(diagonal) + np.diag(beside, 1) + np.diag(beside, -1))
    return centre + spread * values, total * states[0] ** 2

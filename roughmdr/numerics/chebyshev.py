"""Functions as Chebyshev series, on one interval or piece by piece."""

from collections.abc import Callable
from functools import cache
from typing import NamedTuple

import numpy as np

from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.jit import njit


@cache
def chebyshev_nodes(count: int) -> tuple[Floats, Floats]:
    """Return the nodes on -1 to 1, descending, and the matrix that makes values there into coefficients."""
    angles = np.pi * (np.arange(count) + 0.5) / count
    matrix = 2.0 / count * np.cos(np.outer(np.arange(count), angles))
    matrix[0] *= 0.5
    return np.cos(angles), matrix


@njit
def find_piece(upper: Floats, value: float) -> int:
    """Return the index of the first of the ascending ``upper`` edges above a value; faster than np.searchsorted."""
    low, high = 0, upper.size
    while low < high:
        middle = (low + high) // 2
        if upper[middle] > value:
            high = middle
        else:
            low = middle + 1
    return low


@njit
def evaluate_series(coefficients: Floats, u: Floats, out: Floats, before: Floats, earlier: Floats) -> None:
    """Evaluate a series at all u by C. W. Clenshaw's recurrence; ``before`` and ``earlier`` are working arrays."""
    for i in range(u.size):
        before[i] = 0.0
        earlier[i] = 0.0
    degree = coefficients.size - 1
    while degree > 0 and coefficients[degree] == 0.0:
        degree -= 1
    for n in range(degree, 0, -1):
        c = coefficients[n]
        for i in range(u.size):
            now = 2.0 * u[i] * before[i] - earlier[i] + c
            earlier[i] = before[i]
            before[i] = now
    for i in range(u.size):
        out[i] = u[i] * before[i] - earlier[i] + coefficients[0]


@njit
def series_at(coefficients: Floats, u: float) -> float:
    """Return a series at one u."""
    before, earlier = 0.0, 0.0
    for n in range(coefficients.size - 1, 0, -1):
        before, earlier = 2.0 * u * before - earlier + coefficients[n], before
    return float(u * before - earlier + coefficients[0])


class PiecewiseChebyshev(NamedTuple):
    """A smooth function between the first and the last of ``edges``, as a series on each piece; constant outside."""

    edges: Floats
    coefficients: Floats
    """[order, piece]"""

    @classmethod
    def of(cls, function: Callable[[Floats], Floats], edges: Floats, count: int) -> "PiecewiseChebyshev":
        """Tabulate ``function``, which takes a one-dimensional array, with ``count`` coefficients a piece."""
        nodes, to_coefficients = chebyshev_nodes(count)
        x = edges[:-1, None] + 0.5 * np.diff(edges)[:, None] * (1.0 + nodes)
        return cls(edges, to_coefficients @ function(x.ravel()).reshape(x.shape).T)

    def __call__(self, x: Floats) -> Floats:
        """Return the function at each x, an array of any shape."""
        piece = np.clip(np.searchsorted(self.edges, x, side="right") - 1, 0, len(self.edges) - 2)
        low, high = self.edges[piece], self.edges[piece + 1]
        u = np.clip((2.0 * x - low - high) / (high - low), -1.0, 1.0)
        return np.asarray(np.polynomial.chebyshev.chebval(u, self.coefficients[:, piece], tensor=False))

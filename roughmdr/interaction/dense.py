"""The displacements of contacts by each other, each pair summed: for few asperities, and to check the mesh by."""

from copy import copy

import numpy as np
from numpy.typing import NDArray

from roughmdr.interaction.green import Periodic, below_all, periodic_load, point_load
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.jit import njit


@njit
def _fill(x: Floats, y: Floats, patch: Periodic, periodic: bool, first: int, matrices: Floats) -> None:
    """Fill the matrices but for the pairs of the points before ``first``."""
    for i in range(first, x.size):
        for j in range(i + 1):
            if periodic:
                field = periodic_load(x[i] - x[j], y[i] - y[j], patch)
            else:
                field = point_load(x[i] - x[j], y[i] - y[j]) if i != j else (0.0, 0.0, 0.0, 0.0)
            for row in range(4):
                matrices[row, i, j] = field[row]
                matrices[row, j, i] = field[row] if row in (0, 3) or i == j else -field[row]


@njit
def _sum_at(matrix: Floats, points: NDArray[np.int64], sources: NDArray[np.int64], source: Floats, out: Floats) -> None:
    """Fill the sums over sources at points, which are few of all: a copy of their part would take longer."""
    for i in points:
        total = 0.0
        for j in sources:
            total += matrix[i, j] * source[j]
        out[i] = total


class Dense:
    """Matrices of G, its slopes and its Laplacian, [row, asperity, asperity], in units of the patch.

    Those of the first points may be known.
    """

    def __init__(self, x: Floats, y: Floats, patch: Periodic, periodic: bool, known: "Dense | None" = None) -> None:
        self.error = 1e-12
        """Relative error of the displacements."""
        self.matrices = np.empty((4, x.size, x.size))
        self._last: tuple[NDArray[np.int64], Dense] | None = None
        first = 0 if known is None else known.matrices.shape[1]
        if known is not None:
            self.matrices[:, :first, :first] = known.matrices
        _fill(x, y, patch, periodic, first, self.matrices)

    def part(self, kept: NDArray[np.int64]) -> "Dense":
        """Return the matrices of some of the asperities; those returned last are remembered."""
        if self._last is None or not np.array_equal(self._last[0], kept):
            part = copy(self)
            part.matrices, part._last = np.ascontiguousarray(self.matrices[:, kept[:, None], kept]), None
            self._last = kept, part
        return self._last[1]

    def beside(self, known: NDArray[np.int64]) -> "Beside":
        """Return them for the displacement of all points but those known."""
        return Beside(self.matrices, known)

    def none(self) -> "Dense":
        """Return matrices of 0."""
        none = copy(self)
        none.matrices, none._last = np.broadcast_to(0.0, self.matrices.shape), None
        return none

    def potential(self, load: Floats) -> Floats:
        """Return the displacement of each point by point loads."""
        return np.asarray(self.matrices[0] @ load)

    def least_displacement(self, load: Floats) -> float:
        """Return about the least displacement between the points by compressive point loads."""
        values = self.potential(load)
        return below_all(values)

    def field(self, load: Floats) -> Floats:
        """Return displacement, slopes and Laplacian at each point by point loads, [row, asperity]."""
        if not load.any():
            return np.zeros((4, load.size))
        return (self.matrices.reshape(4 * load.size, load.size) @ load).reshape(
            4, -1
        )  # by one product of a matrix and a vector

    def of_moments(self, laplacian: Floats, along_x: Floats, along_y: Floats) -> Floats:
        """Return the displacement by sources of the Laplacian and of the slopes of G."""
        if not (laplacian.any() or along_x.any() or along_y.any()):
            return np.zeros(laplacian.size)
        _, x, y, lap = self.matrices
        return np.asarray(lap @ laplacian + x @ along_x + y @ along_y)


class Beside:
    """Matrices as they displace some of the points; for the others there are 0."""

    def __init__(self, matrices: Floats, known: NDArray[np.int64]) -> None:
        self._matrices = matrices
        self._points = np.delete(np.arange(matrices.shape[1]), known)

    def potential(self, load: Floats) -> Floats:
        """Return the displacement by point loads."""
        return self._sums(0, load)

    def field(self, load: Floats) -> Floats:
        """Return displacement, slopes and Laplacian by point loads, [row, asperity]."""
        return np.array([self._sums(row, load) for row in range(4)])

    def of_moments(self, laplacian: Floats, along_x: Floats, along_y: Floats) -> Floats:
        """Return the displacement by sources of the Laplacian and of the slopes of G."""
        return self._sums(3, laplacian) + self._sums(1, along_x) + self._sums(2, along_y)

    def _sums(self, row: int, source: Floats) -> Floats:
        sums = np.zeros(source.size)
        _sum_at(self._matrices[row], self._points, np.flatnonzero(source), source, sums)
        return sums

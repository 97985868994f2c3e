"""The displacements of contacts by each other, each pair summed: for few asperities, and to check the mesh by."""

from copy import copy

import numpy as np
from numpy.typing import NDArray

from roughmdr.interaction.green import Periodic, below_all, periodic_load, point_load
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.jit import njit

Integers = NDArray[np.int64]


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
def _field_at(matrices: Floats, points: Integers, sources: Integers, load: Floats, field: Floats) -> None:
    """Fill the rows of the field at points, which are few of all: a copy of their part would take longer."""
    for i in points:
        for row in range(field.shape[0]):
            total = 0.0
            for j in sources:
                total += matrices[row, i, j] * load[j]
            field[row, i] = total


@njit
def _of_moments_at(
    matrices: Floats, points: Integers, sources: Integers, laplacian: Floats, x: Floats, y: Floats, out: Floats
) -> None:
    """Add the displacement at points by sources of the Laplacian and of the slopes of G."""
    for i in points:
        for j in sources:
            out[i] += matrices[3, i, j] * laplacian[j] + matrices[1, i, j] * x[j] + matrices[2, i, j] * y[j]


class Dense:
    """Matrices of G, its slopes and its Laplacian, [row, asperity, asperity], in units of the patch.

    Those of the first points may be known.
    """

    def __init__(self, x: Floats, y: Floats, patch: Periodic, periodic: bool, known: "Dense | None" = None) -> None:
        self.error = 1e-12
        """Relative error of the displacements."""
        self.matrices = np.empty((4, x.size, x.size))
        first = 0 if known is None else known.matrices.shape[1]
        if known is not None:
            self.matrices[:, :first, :first] = known.matrices
        _fill(x, y, patch, periodic, first, self.matrices)

    def part(self, kept: Integers) -> "Dense":
        """Return the matrices of some of the asperities."""
        part = copy(self)
        part.matrices = self.matrices.take(kept, axis=1).take(kept, axis=2)
        return part

    def beside(self, known: Integers) -> "Beside":
        """Return them for the displacement of all points but those known."""
        return Beside(self.matrices, known)

    def none(self) -> "Dense":
        """Return matrices of 0."""
        none = copy(self)
        none.matrices = np.broadcast_to(0.0, self.matrices.shape)
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
        whole = self.matrices.reshape(4 * load.size, load.size)
        return np.asarray(whole @ load).reshape(4, -1)  # by one product of a matrix and a vector

    def of_moments(self, laplacian: Floats, along_x: Floats, along_y: Floats) -> Floats:
        """Return the displacement by sources of the Laplacian and of the slopes of G, of which the latter are odd."""
        sources, size = np.concatenate([-along_x, -along_y, laplacian]), laplacian.size
        return np.asarray(sources @ self.matrices[1:].reshape(3 * size, size))


class Beside:
    """Matrices as they displace some of the points; for the others there are 0."""

    def __init__(self, matrices: Floats, known: Integers) -> None:
        self._matrices = matrices
        self._points = np.delete(np.arange(matrices.shape[1]), known)

    def potential(self, load: Floats) -> Floats:
        """Return the displacement by point loads."""
        return np.asarray(self._field(load, 1)[0])

    def field(self, load: Floats) -> Floats:
        """Return displacement, slopes and Laplacian by point loads, [row, asperity]."""
        return self._field(load, 4)

    def _field(self, load: Floats, rows: int) -> Floats:
        field = np.zeros((rows, load.size))
        _field_at(self._matrices, self._points, np.flatnonzero(load), load, field)
        return field

    def of_moments(self, laplacian: Floats, along_x: Floats, along_y: Floats) -> Floats:
        """Return the displacement by sources of the Laplacian and of the slopes of G."""
        displacement = np.zeros(laplacian.size)
        sources = np.flatnonzero((laplacian != 0.0) | (along_x != 0.0) | (along_y != 0.0))
        _of_moments_at(self._matrices, self._points, sources, laplacian, along_x, along_y, displacement)
        return displacement

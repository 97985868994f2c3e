"""How loads of contacts displace, tilt and curve the surface at others; close pairs feel each other otherwise."""

from typing import Protocol

import numpy as np
from scipy.sparse.linalg import LinearOperator, cg

from roughmdr.interaction import close
from roughmdr.numerics.arguments import Floats

_MAX_ITERATIONS = 100
Moments = tuple[Floats, Floats, Floats]
"""Sources of the Laplacian of G, and of its slopes along x and along y."""


class Sums(Protocol):
    """Sums over loads at each asperity, or at some of them."""

    def potential(self, load: Floats) -> Floats:
        """Return the displacement by point loads."""
        ...

    def field(self, load: Floats) -> Floats:
        """Return displacement, slopes and Laplacian by point loads, [row, asperity]."""
        ...

    def of_moments(self, laplacian: Floats, along_x: Floats, along_y: Floats) -> Floats:
        """Return the displacement by sources of the Laplacian and of the slopes of G."""
        ...


class Coupling(Sums, Protocol):
    """How loads displace the surface at each asperity; ``Dense`` and ``Mesh``."""

    error: float

    def least_displacement(self, load: Floats) -> float:
        """Return about the least displacement between the points."""
        ...


def field_of(coupling: Sums, pairs: close.Pairs, order: int, load: Floats) -> Floats:
    """Return the displacement by point loads with its derivatives, [row, asperity], but for close pairs.

    To first order the derivatives are 0.
    """
    if order == 2:
        field = coupling.field(load)
    else:
        field = np.zeros((4, load.size))
        field[0] = coupling.potential(load)
    if pairs.share.size:
        close.take_from_field(pairs, load, order, field)
    return field


def add_moments(coupling: Sums, pairs: close.Pairs, moments: Moments, displacement: Floats) -> None:
    """Add the displacement by moments, but for close pairs."""
    displacement += coupling.of_moments(*moments)
    if pairs.share.size:
        close.take_from_moments(pairs, *moments, displacement)


def first_order(
    tangent: Coupling, pairs: close.Pairs, values: Floats, stiffness: Floats, right: Floats, rtol: float
) -> Floats:
    """Return the loads of contacts with (1/k + G) P = right, 0 where k is 0; ``values`` add to G of the pairs."""
    root = np.sqrt(stiffness)

    def product(scaled: Floats) -> Floats:
        load = root * scaled.ravel()
        potential = tangent.potential(load)
        close.add_tangent(pairs, values, load, potential)
        return scaled.ravel() + root * potential

    operator = LinearOperator((root.size, root.size), matvec=product, dtype=np.float64)
    found, _ = cg(operator, root * right, rtol=rtol, atol=0.0, maxiter=_MAX_ITERATIONS)
    return np.asarray(root * found)

"""Pressures on a nearly circular contact, and the displacement of a half-space under them, by quadrature.

The contact is the image of the unit disc under a polynomial z(ζ) with real coefficients, so it is symmetric about the
x-axis. The pressure is √(1 - |ζ|²) times a polynomial in x and y: it vanishes at the edge as a square root, which is
what a free edge asks for. E* is 1. Every integrand is smooth, so that the error falls exponentially with the degree.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.special import eval_jacobi, roots_jacobi, roots_legendre

from roughmdr.numerics.arguments import Floats

Complexes = NDArray[np.complex128]


class Points(NamedTuple):
    """Points ζ of the unit disc with the weights of a quadrature, and the pressure modes there."""

    zeta: Complexes
    weight: Floats
    modes: Floats
    """Over points and modes."""


def evaluate(coefficients: Floats, zeta: Complexes) -> tuple[Complexes, Floats]:
    """Return z(ζ) and its Jacobian |z'(ζ)|²."""
    value, slope = np.zeros_like(zeta), np.zeros_like(zeta)
    for coefficient in coefficients[::-1]:
        slope = slope * zeta + value
        value = value * zeta + coefficient
    return value, np.asarray(slope.real**2 + slope.imag**2)


def _stretch(coefficients: Floats, zeta: Complexes, other: Complexes) -> Floats:
    """Return |z(ζ) - z(ζ')|/|ζ - ζ'| without a difference (Horner)."""
    ratio, value = np.zeros(np.broadcast_shapes(zeta.shape, other.shape), dtype=np.complex128), np.zeros_like(other)
    for coefficient in coefficients[::-1]:
        ratio = ratio * zeta + value
        value = value * other + coefficient
    return np.abs(ratio)


class MappedDisc:
    """The unit disc with polynomials up to ``degree``, its collocation points and its quadratures."""

    def __init__(self, degree: int) -> None:
        self.modes = [(m, k) for m in range(degree + 1) for k in range((degree - m) // 2 + 1)]
        radial, weight = roots_legendre(degree // 2 + 4)
        angle = (np.arange(degree + 6) + 0.5) * math.pi / (degree + 6)
        self.points = np.outer(np.sqrt(0.5 + 0.5 * radial), np.exp(1j * angle)).ravel()
        """Collocation points in the upper half of the disc."""
        self.root_weight = np.repeat(np.sqrt(weight), angle.size)
        self._chords = self._chords_through_points(2 * degree + 16, degree + 8)
        self.whole = self._quadrature_of_disc(degree + 10, 3 * degree + 24)

    def _at(self, zeta: Complexes, weight: Floats) -> Points:
        square = np.abs(zeta) ** 2
        modes = [(zeta**m).real * eval_jacobi(k, m, 0.5, 1.0 - 2.0 * square) for m, k in self.modes]
        return Points(zeta, weight, np.stack(modes, axis=-1))

    def _chords_through_points(self, directions: int, nodes: int) -> Points:
        """Return, for each collocation point, nodes along the chords through it: no 1/r is left in polar coordinates.

        Over a chord of half-length l, with position l s from its middle, √(1 - |ζ|²) is l √(1 - s²).
        """
        phi = (np.arange(directions) + 0.5) * math.pi / directions
        direction = np.exp(1j * phi)[None, :, None]
        t = np.arange(1, nodes + 1) * math.pi / (nodes + 1)  # Gauss and Chebyshev, second kind
        weight = math.pi / (nodes + 1) * np.sin(t) ** 2
        own = self.points[:, None, None]
        along = (own * direction.conj()).real
        half = np.sqrt(1.0 - (np.abs(own) ** 2 - along**2))
        zeta = own + (half * np.cos(t) - along) * direction
        over = half**2 * weight / directions  # with 1/π of the displacement
        count = self.points.size
        return self._at(zeta.reshape(count, -1), np.broadcast_to(over, zeta.shape).reshape(count, -1))

    def _quadrature_of_disc(self, radii: int, angles: int) -> Points:
        """Return a rule for integrals of √(1 - |ζ|²) times a smooth function over the disc."""
        x, weight = roots_jacobi(radii, 0.0, 0.5)  # x = 1 - 2 |ζ|²
        phi = (np.arange(angles) + 0.5) * 2.0 * math.pi / angles
        zeta = np.outer(np.sqrt(0.5 - 0.5 * x), np.exp(1j * phi))
        each = weight * (math.pi / angles) * 0.5**1.5  # |ζ| d|ζ| = dx/4, √(1 - |ζ|²) = √((1 + x)/2)
        return self._at(zeta.ravel(), np.repeat(each, angles))

    def own_displacement(self, coefficients: Floats, amplitudes: Floats | None = None) -> Floats:
        """Return the displacement at the collocation points, over all modes or of the pressure of ``amplitudes``."""
        zeta, weight, modes = self._chords
        _, area = evaluate(coefficients, zeta)
        kernel = weight * area / _stretch(coefficients, zeta, self.points[:, None])
        if amplitudes is None:
            return np.asarray(np.einsum("iq,iqj->ij", kernel, modes, optimize=True))
        return np.asarray(np.sum(kernel * (modes @ amplitudes), axis=1))

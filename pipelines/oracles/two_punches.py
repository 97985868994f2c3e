"""Two equal flat punches that stay level, on a free half-space, by their exact modes; radius, approach and E* are 1.

Under a punch the pressure (1 - r²)^(-1/2) r^m P_k^(m,-1/2)(1 - 2 r²) cos mθ displaces the surface by its eigenvalue
times the polynomial in it (G. Ia. Popov, J. Appl. Math. Mech. 27 (1963) 1255). Each punch is the mirror image of the
other, and its displacement at the other is a smooth integral.
"""

import math

import numpy as np
from scipy.special import eval_jacobi, gamma, roots_jacobi, roots_legendre

from oracles.mapped_disc import Complexes
from roughmdr.numerics.arguments import Floats


def _polynomials(z: Complexes, modes: list[tuple[int, int]]) -> Floats:
    square = np.abs(z) ** 2
    return np.stack([(z**m).real * eval_jacobi(k, m, -0.5, 1.0 - 2.0 * square) for m, k in modes], axis=-1)


def punch_force(distance: float, degree: int = 20) -> float:
    """Return the force on each of two punches, 2 on its own, by polynomials up to ``degree``."""
    modes = [(m, k) for m in range(degree + 1) for k in range((degree - m) // 2 + 1)]
    m, k = np.array(modes).T
    eigenvalues = gamma(m + k + 0.5) * gamma(k + 0.5) / (gamma(m + k + 1.0) * gamma(k + 1.0))
    x, weight = roots_jacobi(degree + 10, 0.0, -0.5)  # x = 1 - 2 r², √(1 - r²) = √((1 + x)/2), r dr = -dx/4
    angle = (np.arange(3 * degree + 24) + 0.5) * 2.0 * math.pi / (3 * degree + 24)
    source = np.outer(np.sqrt(0.5 - 0.5 * x), np.exp(1j * angle)).ravel()
    load = np.repeat(weight * 0.25 * math.sqrt(2.0) * 2.0 * math.pi / angle.size, angle.size)[:, None]
    load = load * _polynomials(source, modes)
    s, share = roots_legendre(degree // 2 + 4)
    half = (np.arange(degree + 6) + 0.5) * math.pi / (degree + 6)
    points = np.outer(np.sqrt(0.5 + 0.5 * s), np.exp(1j * half)).ravel()
    by_other = (1.0 / (math.pi * np.abs(points[:, None] - distance + source.conj()))) @ load
    influence = eigenvalues * _polynomials(points, modes) + by_other
    root = np.repeat(np.sqrt(share), half.size)
    amplitudes = np.linalg.lstsq(root[:, None] * influence, root, rcond=None)[0]
    return float(load.sum(axis=0) @ amplitudes)

"""Flat punches that stay level, of any radii and places, by their exact modes; the displacement and E* are 1.

Under a punch of radius 1 the pressure (1 - r²)^(-1/2) r^m P_k^(m,-1/2)(1 - 2 r²) times cos mθ or sin mθ displaces the
surface by its eigenvalue times the polynomial in it (G. Ia. Popov, J. Appl. Math. Mech. 27 (1963) 1255). What other
punches do is a smooth integral over them; on a square patch that repeats, images have zero mean displacement.
"""

import numpy as np
from scipy.special import eval_jacobi, gamma, roots_jacobi, roots_legendre

from roughmdr.numerics.arguments import Floats
from twins.mapped_disc import Complexes
from twins.periodic_contact import image_green

_MORE = 8  # points of the quadratures beyond the degree


def _polynomials(z: Complexes, modes: list[tuple[int, int, bool]]) -> Floats:
    square = np.abs(z) ** 2
    return np.stack(
        [((z**m).imag if odd else (z**m).real) * eval_jacobi(k, m, -0.5, 1.0 - 2.0 * square)
         for m, k, odd in modes], axis=-1,
    )  # fmt: skip


def disc_forces(at: Complexes, radius: Floats, side: float | None = None, degree: int = 8) -> Floats:
    """Return the force on each of the discs at places ``at``, by polynomials up to ``degree``.

    They stand on a free half-space or on a patch of ``side`` that repeats.
    """
    modes = [(m, k, odd) for m in range(degree + 1) for k in range((degree - m) // 2 + 1)
             for odd in ((False, True) if m else (False,))]  # fmt: skip
    m, k = (np.array([mode[i] for mode in modes]) for i in (0, 1))
    eigenvalues = gamma(m + k + 0.5) * gamma(k + 0.5) / (gamma(m + k + 1.0) * gamma(k + 1.0))
    x, weight = roots_jacobi(degree + _MORE, 0.0, -0.5)  # x = 1 - 2 r², √(1 - r²) = √((1 + x)/2), r dr = -dx/4
    turns = 2 * degree + 2 * _MORE
    circle = np.exp(2j * np.pi * (np.arange(turns) + 0.5) / turns)
    source = np.outer(np.sqrt(0.5 - 0.5 * x), circle).ravel()
    load = np.repeat(weight * 0.25 * np.sqrt(2.0) * 2.0 * np.pi / turns, turns)[:, None] * _polynomials(source, modes)
    s, share = roots_legendre(degree // 2 + 3)
    around = np.exp(2j * np.pi * (np.arange(2 * degree + 3) + 0.25) / (2 * degree + 3))
    points = np.outer(np.sqrt(0.5 + 0.5 * s), around).ravel()
    root = np.sqrt(np.repeat(share, around.size))
    own, count = eigenvalues * _polynomials(points, modes), len(modes)
    influence = np.zeros((at.size, points.size, at.size, count))
    for i in range(at.size):
        for j in range(at.size):
            apart = (at[i] + radius[i] * points)[:, None] - (at[j] + radius[j] * source)
            green = np.zeros(apart.shape)
            if side is not None:
                apart = apart - side * (np.rint(apart.real / side) + 1j * np.rint(apart.imag / side))
                green = image_green(apart / side) / side
            if i != j:
                green = green + 1.0 / (np.pi * np.abs(apart))
            influence[i, :, j] = radius[j] ** 2 * (green @ load) + (radius[i] * own if i == j else 0.0)
    influence *= root[:, None, None]
    right = np.tile(root, at.size)
    amplitudes = np.linalg.lstsq(influence.reshape(right.size, -1), right, rcond=None)[0].reshape(at.size, count)
    return np.asarray(radius**2 * (amplitudes @ load.sum(axis=0)))

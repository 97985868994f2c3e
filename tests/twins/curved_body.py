"""A paraboloid on a rough layer, after Greenwood and Tripp (1967), by means that share nothing with the package.

The half-space has the ring kernel, u(r) = 4/(pi E*) ∫ p(t) t/(r + t) K(4 r t/(r + t)^2) dt, K the complete elliptic
integral of parameter m (K. L. Johnson, Contact Mechanics (1985), section 3.8). The pressure is a polynomial in r^2
through Chebyshev points; its integrals over both sides of r take the logarithm by a substitution. The layer is that of
paraboloids with Gaussian heights, by Gauss's rule. The separation is found by damped repetition.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.special import ellipkm1

Floats = NDArray[np.float64]

_HEIGHTS, _HIGHEST = 200, 10.0  # points of the integral over heights, and the highest, in standard deviations
_SIDE = 120  # points of the integral on each side of a ring
_FINE = 1e-13  # tolerance, over the standard deviation


def layer_pressure(s: Floats, modulus: float, radius: float, std: float, density: float) -> Floats:
    """Return the pressure [Pa] of paraboloids on a layer at separations s [m]; z = s + t^2 takes the root."""
    nodes, weights = np.polynomial.legendre.leggauss(_HEIGHTS)
    top = np.sqrt(np.maximum(_HIGHEST * std - s, 0.0))[..., None]
    t = 0.5 * top * (nodes + 1.0)
    z = s[..., None] + t * t
    heights = np.exp(-0.5 * (z / std) ** 2) / (np.sqrt(2.0 * np.pi) * std)
    force = 4.0 / 3.0 * modulus * np.sqrt(radius) * t**3
    return np.asarray(density * (force * heights * 2.0 * t * 0.5 * top * weights).sum(axis=-1))


def ring_matrix(r: Floats, modulus: float) -> Floats:
    """Return the matrix from pressures at ``r`` to displacements there; ``r`` are square roots of Chebyshev points."""
    x, last = r * r, r.max()
    nodes, weights = np.polynomial.legendre.leggauss(_SIDE)
    y, w = 0.5 * (nodes + 1.0), 0.5 * weights
    barycentric = np.array([1.0 / np.prod((xi - np.delete(x, i)) / x.max() * 4.0) for i, xi in enumerate(x)])
    matrix = np.zeros((r.size, r.size))
    for i, ri in enumerate(r):
        for end in (0.0, last):
            if end == ri:
                continue
            beyond = (end - ri) * y**4
            t, dt = ri + beyond, abs(end - ri) * 4.0 * y**3 * w
            kernel = 4.0 / (np.pi * modulus) * t / (ri + t) * ellipkm1((beyond / (ri + t)) ** 2) * dt
            apart = (t * t)[:, None] - x
            exact = np.abs(apart) < 1e-15 * x.max()
            parts = barycentric / np.where(exact, 1.0, apart)
            basis = np.where(exact.any(axis=1)[:, None], exact, parts / parts.sum(axis=1, keepdims=True))
            matrix[i] += kernel @ basis
    return matrix


def force_at(
    h: float, body_radius: float, modulus: float, radius: float, std: float, density: float, points: int = 50
) -> tuple[float, float]:
    """Return the force [N] and Greenwood and Tripp's effective radius [m] of a paraboloid at separation h [m]."""
    nodes = 0.5 * (1.0 - np.cos(np.pi * np.arange(points) / (points - 1)))
    x = 2.0 * body_radius * (_HIGHEST * std - h) * nodes
    r = np.sqrt(x)
    matrix, rigid = ring_matrix(r, modulus), h + x / (2.0 * body_radius)
    s, step = rigid.copy(), 1.0
    change = np.inf
    while change > _FINE * std:
        p = layer_pressure(s, modulus, radius, std, density)
        residual = rigid + matrix @ p - s
        steepness = (layer_pressure(s - 1e-6 * std, modulus, radius, std, density) - p) / (1e-6 * std)
        step = 1.0 / (1.0 + float((np.abs(matrix) @ steepness).max()))
        s, change = s + step * residual, float(np.abs(residual).max())
    p = layer_pressure(s, modulus, radius, std, density)
    series = np.polynomial.Chebyshev.fit(x, p, points - 1, domain=[0.0, x.max()])
    rule, weights = np.polynomial.legendre.leggauss(2 * points)
    at, width = 0.5 * r.max() * (rule + 1.0), 0.5 * r.max() * weights
    along = series(at * at)
    force = 2.0 * np.pi * float((along * at * width).sum())
    return force, 0.75 * np.pi * float((along * at * width).sum()) / float((along * width).sum())

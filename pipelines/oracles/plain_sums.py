"""Plain alternatives to the sum over asperities: NumPy vectors, or a root finder for each contact."""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from roughmdr.numerics.arguments import Floats


class Sums(NamedTuple):
    """The results of a plain loop over the path."""

    force: Floats  # [N], at each separation
    area: Floats  # [m2]
    visits: int


Contacts = Callable[[NDArray[np.bool_], float], tuple[Floats, Floats]]
"""(which touch, separation) -> contact radius [m] and force [N] of each of these."""


def along(path: Floats, height: Floats, fold: Floats, contacts: Contacts) -> Sums:
    """Sum contacts along a path; an asperity stays in contact to |delta_c|, ``fold``, once the flat was below it."""
    force, area, visits, closest = np.zeros(path.size), np.zeros(path.size), 0, math.inf
    for step, h in enumerate(path.tolist()):
        closest = min(closest, h)
        touching = (height > closest) & (height - h > (-fold if h > closest else 0.0))
        a, load = contacts(touching, h)
        force[step], area[step], visits = np.sum(load), np.pi * np.sum(a * a), visits + a.size
    return Sums(force, area, visits)


def with_numpy(height: Floats, radius: Floats, path: Floats, effective_modulus: float, work: float) -> Sums:
    """Sum paraboloids with vectors: JKR by six steps of Newton's method on t^4 - t = delta/d0."""
    a0 = np.cbrt(2.0 * np.pi * work * radius * radius / effective_modulus)

    def contacts(touching: NDArray[np.bool_], h: float) -> tuple[Floats, Floats]:
        delta, R, scale = height[touching] - h, radius[touching], a0[touching]
        if not work:
            a = np.sqrt(R * delta)
            return a, 4.0 / 3.0 * effective_modulus * a * delta
        d0 = scale * scale / R
        t = 1.0 + np.sqrt(np.sqrt(np.maximum(delta / d0, 0.0)))
        for _ in range(6):
            t -= (t**4 - t - delta / d0) / (4.0 * t**3 - 1.0)
        return scale * t * t, 2.0 * effective_modulus * scale * d0 * (2.0 / 3.0 * t**6 - t**3)

    return along(path, height, 0.75 * 4.0 ** (-1.0 / 3.0) * a0 * a0 / radius, contacts)


def with_brentq(height: Floats, radius: Floats, path: Floats, effective_modulus: float, work: float) -> Sums:
    """Sum paraboloids with a root finder for each contact."""
    folds = np.cbrt(np.pi * work * radius * radius / (8.0 * effective_modulus))

    def indentation(a: float, R: float, delta: float) -> float:
        return float(a * a / R - np.sqrt(2.0 * np.pi * a * work / effective_modulus) - delta)

    def contacts(touching: NDArray[np.bool_], h: float) -> tuple[Floats, Floats]:
        found = []
        for z, R, fold in zip(height[touching], radius[touching], folds[touching], strict=True):
            top = fold + 2.0 * np.sqrt(R * max(z - h, 0.0)) + 8.0 * fold
            found.append(brentq(indentation, fold, top, args=(R, z - h), xtol=1e-12 * top))
        a = np.array(found)
        load = 4.0 * effective_modulus * a**3 / (3.0 * radius[touching])
        return a, load - np.sqrt(8.0 * np.pi * work * effective_modulus * a**3)

    depths = np.sqrt(2.0 * np.pi * folds * work / effective_modulus) - folds * folds / radius
    return along(path, height, depths, contacts)

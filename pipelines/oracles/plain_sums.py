"""Plain alternatives to the sum over asperities: NumPy vectors, or a root finder for each contact."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from roughmdr.numerics.arguments import Floats


class Sums(NamedTuple):
    """The results of a plain loop over the path."""

    force: Floats
    """[N], at each separation."""
    area: Floats
    """[m2]."""
    visits: int


def in_contact(height: Floats, fold: Floats, h: float, closest: float) -> NDArray[np.bool_]:
    """Return which asperities are in contact at h after the flat was at ``closest``; ``fold`` is |delta_c| of each."""
    return (height > closest) & (height - h > (-fold if h > closest else 0.0))


def with_numpy(height: Floats, radius: Floats, path: Floats, effective_modulus: float, work: float) -> Sums:
    """Sum paraboloids with vectors: JKR by six steps of Newton's method on t^4 - t = delta/d0."""
    a0 = np.cbrt(2.0 * np.pi * work * radius * radius / effective_modulus)
    force, area, visits, closest = np.zeros(path.size), np.zeros(path.size), 0, math.inf
    for step, h in enumerate(path):
        closest = min(closest, h)
        touching = in_contact(height, 0.75 * 4.0 ** (-1.0 / 3.0) * a0 * a0 / radius, h, closest)
        delta, R = height[touching] - h, radius[touching]
        visits += delta.size
        if work:
            scale = a0[touching]
            d0 = scale * scale / R
            t = 1.0 + np.sqrt(np.sqrt(np.maximum(delta / d0, 0.0)))
            for _ in range(6):
                t -= (t**4 - t - delta / d0) / (4.0 * t**3 - 1.0)
            a, force[step] = scale * t * t, np.sum(2.0 * effective_modulus * scale * d0 * (2.0 / 3.0 * t**6 - t**3))
        else:
            a = np.sqrt(R * delta)
            force[step] = np.sum(4.0 / 3.0 * effective_modulus * a * delta)
        area[step] = np.pi * np.sum(a * a)
    return Sums(force, area, visits)


def with_brentq(height: Floats, radius: Floats, path: Floats, effective_modulus: float, work: float) -> Sums:
    """Sum paraboloids with a root finder for each contact."""
    folds = np.cbrt(np.pi * work * radius * radius / (8.0 * effective_modulus))
    depths = np.sqrt(2.0 * np.pi * folds * work / effective_modulus) - folds * folds / radius
    force, area, visits, closest = np.zeros(path.size), np.zeros(path.size), 0, math.inf

    def indentation(a: float, R: float, delta: float) -> float:
        return float(a * a / R - np.sqrt(2.0 * np.pi * a * work / effective_modulus) - delta)

    for step, h in enumerate(path.tolist()):
        closest = min(closest, h)
        touching = in_contact(height, depths, h, closest)
        for z, R, fold in zip(height[touching], radius[touching], folds[touching], strict=True):
            top = fold + 2.0 * np.sqrt(R * max(z - h, 0.0)) + 8.0 * fold
            a = brentq(indentation, fold, top, args=(R, z - h), xtol=1e-12 * top)
            force[step] += 4.0 * effective_modulus * a**3 / (3.0 * R) - np.sqrt(
                8.0 * np.pi * work * effective_modulus * a**3
            )
            area[step] += np.pi * a * a
            visits += 1
    return Sums(force, area, visits)

"""Plain alternatives to the sum over asperities: NumPy vectors, or a root finder for each contact; and their cost."""

import math
import time
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

import roughmdr as rm
from roughmdr.ensemble import Ensemble
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.jit import compiled
from roughmdr.shapes import SHAPES, PowerLaw, ProfileShape, Shape
from roughmdr.shapes.kappa import kappa


class Cost(NamedTuple):
    """The run time of some visits."""

    seconds: float
    visits: int

    @property
    def each(self) -> float:
        """Time per visit [ns]."""
        return self.seconds / self.visits * 1e9


def cost_of(action: Callable[[], int], repeats: int) -> Cost:
    """Return the shortest wall time of ``action``, which returns its visits."""
    times, visits = [], 1
    for _ in range(repeats):
        started = time.perf_counter()
        visits = action()
        times.append(time.perf_counter() - started)
    return Cost(min(times), visits)


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


def by_numpy(ensemble: Ensemble, path: Floats, effective_modulus: float, work: float) -> Cost:
    """Return the cost of ``with_numpy``."""
    columns = ensemble.height, ensemble.parameters["radius"]
    return cost_of(lambda: with_numpy(*columns, path, effective_modulus, work).visits, 1)


def by_brentq(ensemble: Ensemble, path: Floats, effective_modulus: float, work: float) -> Cost:
    """Return the cost of ``with_brentq``, from a few hundred asperities."""
    columns = ensemble.height[:300], ensemble.parameters["radius"][:300]
    return cost_of(lambda: with_brentq(*columns, path, effective_modulus, work).visits, 1)


def scalar_g(shape: Shape) -> Callable[[float], float]:
    """Return g(a) of one shape as a function of floats, the fastest for a root finder."""
    width, rise, params = shape.nondimensional()
    if isinstance(shape, PowerLaw):
        factor, n = kappa(params) * rise, params
        return lambda a: factor * (a / width) ** n
    assert isinstance(shape, ProfileShape)
    mdr_profile, t_of_radius = compiled(shape.profile.mdr_profile), compiled(shape.profile.t_of_radius)
    numbers = np.atleast_1d(np.asarray(params, dtype=np.float64))
    return lambda a: rise * mdr_profile(t_of_radius(a, width, numbers), numbers)[2]


def by_brentq_on(ensemble: Ensemble, effective_modulus: float, work: float) -> Cost:
    """Return the cost of a root finder on delta = g(a) - dl(a), for 200 contacts of the first asperity."""
    first = {name: float(column[0]) for name, column in ensemble.parameters.items()}
    shape: Shape = ensemble.shared_profile or SHAPES[ensemble.shape](**first)
    fold = float(rm.pull_off(shape, effective_modulus=effective_modulus, work=work).contact_radius)
    g = scalar_g(shape)
    g(fold)  # compiled before the clock runs

    def indentation(a: float, delta: float) -> float:
        return g(a) - math.sqrt(2.0 * math.pi * a * work / effective_modulus) - delta

    top = 0.999999 * shape.end if shape.name == "sphere" else 1e3 * fold

    def action() -> int:
        deltas = np.linspace(1e-8, 1e-6, 200)
        for delta in deltas:
            brentq(indentation, fold, top, args=(delta,), xtol=1e-15 * fold)
        return int(deltas.size)

    return cost_of(action, 1)

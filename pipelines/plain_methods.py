"""What most would write instead of the package's sum: vectors, or a root finder for each contact. And a clock."""

import math
import time
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq

import roughmdr as rm
from roughmdr._jit import compiled
from roughmdr.ensemble import Ensemble
from roughmdr.shapes import SHAPES, Curved, PowerLaw, Shape
from roughmdr.shapes.kappa import kappa


class Cost(NamedTuple):
    """What some visits cost."""

    seconds: float
    visits: int

    @property
    def each(self) -> float:
        """Time per visit [ns]."""
        return self.seconds / self.visits * 1e9


def cost_of(action: Callable[[], int], repeats: int) -> Cost:
    """The shortest wall time of ``action``, which returns its visits."""
    times, visits = [], 1
    for _ in range(repeats):
        started = time.perf_counter()
        visits = action()
        times.append(time.perf_counter() - started)
    return Cost(min(times), visits)


def by_numpy(ensemble: Ensemble, path: np.ndarray, modulus: float, work: float) -> Cost:
    """The same with vectors, as most would write it: loading only, JKR by six Newton steps on t^4 - t = delta/d0."""
    height, radius = ensemble.height, ensemble.parameters["radius"]

    def action() -> int:
        visits = 0
        for h in path:
            touching = height > h
            delta, R = height[touching] - h, radius[touching]
            visits += delta.size
            if work:
                a0 = np.cbrt(2.0 * np.pi * work * R * R / modulus)
                d0 = a0 * a0 / R
                t = 1.0 + np.sqrt(np.sqrt(delta / d0))
                for _ in range(6):
                    t -= (t**4 - t - delta / d0) / (4.0 * t**3 - 1.0)
                a = a0 * t * t
                force = 2.0 * modulus * a0 * d0 * (2.0 / 3.0 * t**6 - t**3)
                stiffness = 2.0 * modulus * a * (4.0 * t**3 - 3.0) / (4.0 * t**3 - 1.0)
            else:
                a = np.sqrt(R * delta)
                force, stiffness = 4.0 / 3.0 * modulus * a * delta, 2.0 * modulus * a
            np.array([force.sum(), np.pi * (a * a).sum(), delta.size, stiffness.sum()])
        return visits

    return cost_of(action, 1)


def by_brentq(ensemble: Ensemble, path: np.ndarray, modulus: float, work: float) -> Cost:
    """The same with a root finder for each contact: loading only, a few hundred asperities."""
    height, radius = ensemble.height[:300], ensemble.parameters["radius"][:300]

    def indentation(a: float, R: float, delta: float) -> float:
        return float(a * a / R - np.sqrt(2.0 * np.pi * a * work / modulus) - delta)

    def action() -> int:
        visits, force = 0, 0.0
        for h in path:
            for z, R in zip(height[height > h], radius[height > h], strict=True):
                fold = np.cbrt(np.pi * work * R * R / (8.0 * modulus))
                a = brentq(indentation, fold, fold + 2.0 * np.sqrt(R * (z - h)) + 8.0 * fold, args=(R, z - h))
                force += 4.0 * modulus * a**3 / (3.0 * R) - np.sqrt(8.0 * np.pi * work * modulus * a**3)
                visits += 1
        return visits

    return cost_of(action, 1)


def scalar_g(shape: Shape) -> Callable[[float], float]:
    """g(a) of one shape, floats in, floats out: what a root finder calls fastest."""
    width, rise, form = shape.stretched()
    if isinstance(shape, PowerLaw):
        factor, n = kappa(form) * rise, form
        return lambda a: factor * (a / width) ** n
    assert isinstance(shape, Curved)
    curve, place = compiled(shape.profile.curve), compiled(shape.profile.place)
    numbers = np.atleast_1d(np.asarray(form, dtype=np.float64))
    return lambda a: rise * curve(place(a, width, numbers), numbers)[2]


def by_brentq_on(ensemble: Ensemble, modulus: float, work: float) -> Cost:
    """A root finder on delta = g(a) - dl(a), for a few hundred contacts of the first asperity."""
    first = {name: float(column[0]) for name, column in ensemble.parameters.items()}
    shape: Shape = ensemble.fixed or SHAPES[ensemble.shape](**first)
    fold = float(rm.pull_off(shape, modulus=modulus, work=work).contact_radius)
    g = scalar_g(shape)
    g(fold)  # compiled before the clock runs

    def indentation(a: float, delta: float) -> float:
        return g(a) - math.sqrt(2.0 * math.pi * a * work / modulus) - delta

    top = 0.999999 * shape.end if shape.name == "sphere" else 1e3 * fold

    def action() -> int:
        deltas = np.linspace(1e-8, 1e-6, 200)
        for delta in deltas:
            brentq(indentation, fold, top, args=(delta,), xtol=1e-15 * fold)
        return int(deltas.size)

    return cost_of(action, 1)

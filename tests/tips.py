"""One tip, apart from the package: its law from the textbook, its measurements, and least squares by scipy."""

import math
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy.optimize import least_squares

Floats = NDArray[np.float64]
MODULUS, WORK, OFFSET = "material.modulus", "adhesion.work", "offset"
POISSON = 0.5
COMBINATIONS = {
    "hertz": [[MODULUS], [OFFSET], [MODULUS, OFFSET]],
    "cone": [[MODULUS], [MODULUS, OFFSET]],
    "jkr": [[MODULUS, WORK], [MODULUS, OFFSET], [WORK, OFFSET], [MODULUS, WORK, OFFSET]],
}
NOISES = ("constant", "proportional", "alternating")


def hertz(modulus: float, radius: float, work: float, depth: Floats) -> Floats:
    """4/3 E* sqrt(R) delta^(3/2)."""
    return np.asarray(4.0 / 3.0 * modulus * math.sqrt(radius) * np.maximum(depth, 0.0) ** 1.5)


def cone(modulus: float, slope: float, work: float, depth: Floats) -> Floats:
    """2 E* delta^2/(pi S)."""
    return np.asarray(2.0 * modulus / (math.pi * slope) * np.maximum(depth, 0.0) ** 2)


def jkr(modulus: float, radius: float, work: float, depth: Floats) -> Floats:
    """JKR pressed and lifted once: on at delta = 0, off at the fold; Newton's method for the radius from above."""
    fold = (math.pi * work * radius * radius / (8.0 * modulus)) ** (1.0 / 3.0)
    lowest, deepest = -3.0 * fold * fold / radius, int(np.argmax(depth))
    a = np.full(depth.shape, 4.0 * fold + 2.0 * math.sqrt(radius * max(depth.max(), 0.0)))
    reached = np.maximum(depth, lowest)
    for _ in range(60):
        slope = 2.0 * a / radius - 0.5 * np.sqrt(2.0 * math.pi * work / (modulus * a))
        excess = a * a / radius - np.sqrt(2.0 * math.pi * a * work / modulus) - reached
        a = np.maximum(a - excess / np.maximum(slope, 1e-300), fold)
    force = 4.0 * modulus * a**3 / (3.0 * radius) - np.sqrt(8.0 * math.pi * work * modulus * a**3)
    touching = np.concatenate(
        [
            np.maximum.accumulate(depth[:deepest]) >= 0.0,
            (np.minimum.accumulate(depth[deepest:]) >= lowest) & (depth.max() >= 0.0),
        ]
    )
    return np.where(touching, force, 0.0)


LAWS = {"hertz": hertz, "cone": cone, "jkr": jkr}


class Twin(NamedTuple):
    """A fit by scipy."""

    values: list[float]
    cost: float
    errors: list[float]


class Tip(NamedTuple):
    """A tip pressed by ``scale`` [m] into a body of this modulus [Pa]."""

    kind: str
    scale: float
    modulus: float

    @property
    def size(self) -> float:
        """Radius [m] of a paraboloid, slope of a cone."""
        return 0.3 if self.kind == "cone" else 10.0 * self.scale

    @property
    def work(self) -> float:
        """[J/m2]; the natural depth of JKR is 0.3 of the scale."""
        effective = self.modulus / (1.0 - POISSON**2)
        return math.sqrt((0.3 * self.scale) ** 3 * effective**2 / (math.pi**2 * self.size)) * (self.kind == "jkr")

    def law(self, modulus: float, work: float, depth: Floats) -> Floats:
        return LAWS[self.kind](modulus / (1.0 - POISSON**2), self.size, work, depth)

    def scene(self, **changes: Any) -> dict[str, Any]:
        shape = {"slope": self.size, "shape": "cone"} if self.kind == "cone" else {"radius": self.size}
        asperities = {"source": "random", "shape": "paraboloid", "count": 1, "patch": 100.0 * self.scale, "height": 0}
        scene: dict[str, Any] = {"title": "One tip", "asperities": asperities | shape}
        scene["material"] = {"modulus": self.modulus, "poisson": POISSON}
        return scene | ({"adhesion": {"model": "jkr", "work": self.work}} if self.work else {}) | changes

    def measure(self, rng: np.random.Generator, points: int, noise: tuple[str, float], offset: float) -> pd.DataFrame:
        """A curve with this noise, of its kind and over the largest force, and the stated errors."""
        down = np.linspace(2.0 * self.scale, -self.scale, points if self.kind != "jkr" else points // 2)
        steps = np.concatenate([down, down[::-1]]) if self.kind == "jkr" else down
        steps = steps + rng.uniform(0.0, down[0] - down[1])
        force = self.law(self.modulus, self.work, -steps)
        kind, level = noise
        factor = {
            "constant": np.ones(steps.size),
            "proportional": np.maximum(np.abs(force) / np.abs(force).max(), 0.05),
            "alternating": np.where(np.arange(steps.size) % 2, 1.5, 0.5),
        }[kind]
        error = level * np.abs(force).max() * factor
        measured = force + error * rng.standard_normal(steps.size)
        return pd.DataFrame({"separation": steps - offset, "force": measured, "force_error": error})

    def true(self, offset: float) -> dict[str, float]:
        return {MODULUS: self.modulus, WORK: self.work, OFFSET: offset}

    def start(self, rng: np.random.Generator, free: list[str]) -> dict[str, float]:
        """Values off by up to two; the offset starts at 0."""
        return {key: self.true(0.0)[key] * 2.0 ** rng.uniform(-1.0, 1.0) for key in free if key != OFFSET}

    def twin(self, measured: pd.DataFrame, free: list[str], offset: float) -> Twin:
        """Least squares from the true values, with the standard errors of the stated ones."""
        true = self.true(offset)

        def values(x: Floats) -> dict[str, float]:
            pairs = zip(free, x.tolist(), strict=True)
            return true | {
                k: offset + self.scale * each if k == OFFSET else true[k] * math.exp(each) for k, each in pairs
            }

        def deviations(x: Floats) -> Floats:
            found = values(x)
            force = self.law(found[MODULUS], found[WORK], -(measured.separation.to_numpy() + found[OFFSET]))
            return np.asarray((force - measured.force.to_numpy()) / measured.force_error.to_numpy())

        best = least_squares(deviations, np.zeros(len(free)), x_scale="jac", ftol=1e-14, xtol=1e-14, gtol=1e-14)
        errors = np.sqrt(np.diag(np.linalg.inv(best.jac.T @ best.jac)))
        found = [values(best.x)[key] for key in free]
        pairs = zip(free, found, errors.tolist(), strict=True)
        scaled = [(self.scale if key == OFFSET else value) * error for key, value, error in pairs]
        return Twin(found, 2.0 * best.cost, scaled)

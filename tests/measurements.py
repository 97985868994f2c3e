"""Measured curves for the tests of fits: the expected law of a scene at true parameters, with noise."""

import copy
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scenes import scene

import roughmdr as rm

Floats = NDArray[np.float64]
DOWN = np.linspace(3e-6, 0.5e-6, 40)
BOTH = np.concatenate([DOWN, DOWN[::-1]])
_ADHESIVE = {"adhesion.work": 0.05, "material.modulus": 3e6}


class Case(NamedTuple):
    """A scene, the steps of its measurement, and the parameters to be found."""

    scene: dict[str, Any]
    control: str
    steps: Floats  # in the scene; the measurement reads ``offset`` less
    true: dict[str, float]

    @property
    def offset(self) -> float:
        return self.true.get("offset", 0.0)

    def force(self) -> Floats:
        """The force of the true parameters."""
        table = copy.deepcopy(self.scene)
        table.setdefault("path", {})[self.control] = self.steps.tolist()
        law: Floats = rm.run(table | {"batch": {"estimator": "expected"}}).force.to_numpy().ravel()
        return law

    def measure(self, deviation: Floats, force: Floats, seed: int = 0) -> pd.DataFrame:
        """A measurement with noise of this standard deviation at each step."""
        noise = np.random.default_rng(seed).standard_normal(force.size)
        return pd.DataFrame({self.control: self.steps - self.offset, "force": force + deviation * noise})

    def start(self, factors: dict[str, float]) -> dict[str, float]:
        """The starting values: the true ones times factors."""
        return {key: value * factors.get(key, 1.0) for key, value in self.true.items() if key != "offset"}


def plain_scene(**changes: Any) -> dict[str, Any]:
    """Asperities of one radius, without a path."""
    table = scene(path=None, batch=None, **changes)
    table["asperities"]["radius"] = "50 um"
    return table


def noise_of(kind: str, force: Floats) -> Floats:
    """The standard deviation of 1 % of the largest force, or of each."""
    largest = np.abs(force).max()
    return 0.01 * (np.full_like(force, largest) if kind == "constant" else np.maximum(np.abs(force), 0.01 * largest))


CASES = {
    "adhesive": Case(plain_scene(), "separation", BOTH, _ADHESIVE),
    "elastic": Case(
        plain_scene(adhesion=None), "separation", DOWN, {"material.modulus": 3e6, "asperities.height.std": 1e-6}
    ),
    "machine": Case(
        plain_scene() | {"path": {"machine_stiffness": "20 kN/m"}},
        "remote",
        np.concatenate([np.linspace(3e-6, -1e-6, 16), np.linspace(-1e-6, 3e-6, 16)]),
        _ADHESIVE,
    ),
    "zero": Case(plain_scene(), "separation", BOTH, _ADHESIVE | {"offset": 0.7e-6}),
}


def inside(fit: Any, key: str, value: float) -> bool:
    """Whether a value is in the 95 % interval of a fit."""
    name = key.replace(".", "_")
    return bool(fit[f"{name}_low"] <= value <= fit[f"{name}_high"])

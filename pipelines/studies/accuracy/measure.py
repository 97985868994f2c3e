"""[accuracy]: how often a run meets the error asked for, and how many realisations it takes.

Many realisations of small scenes are computed once. Runs are drawn from them with replacement, so that the minimal
number of realisations for an error is known: (spread / (error * largest mean force))^2. A run stops by the rule of a
batch; the naive rule, which stops as soon as the estimated error is small enough, is for comparison.
"""

import math
import warnings
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from studies.study import named

import roughmdr as rm
from roughmdr.batch.moments import MomentTree
from roughmdr.batch.stopping_rule import FIRST, next_count, relative_error
from roughmdr.numerics.arguments import Floats
from roughmdr.scene.sections import Accuracy


def scene_of(count: int, height: dict[str, Any], work: float = 0.0) -> dict[str, Any]:
    """Return a scene of ``count`` asperities, loaded and, with adhesion, unloaded."""
    return {
        "title": "A small scene",
        "material": {"effective_modulus": "4 MPa"},
        "adhesion": {"model": "jkr", "work": work},
        "asperities": {
            "source": "random",
            "shape": "paraboloid",
            "count": count,
            "patch": "0.5 mm",
            "height": height,
            "radius": "200 um",
        },
        "path": {"separation": {"start": "2 um", "stop": "-0.5 um", "steps": 20}, "unload": work > 0.0},
        "output": {"variables": ["force"]},
    }


NORMAL = {"distribution": "normal", "std": "1 um"}
SCENES = {
    "Hertz, 40 asperities": scene_of(40, NORMAL),
    "JKR, 40 asperities": scene_of(40, NORMAL, 0.05),
    "Hertz, 8 asperities, exponential heights": scene_of(8, {"distribution": "expon", "std": "1 um"}),
}
MINIMAL_COUNTS = (50, 200, 500, 1000, 4000)
"""Realisations that the errors asked for need at least."""
TOLERATED = 1.3
"""Times the minimal count that a run should not exceed."""


class ForceSamples(NamedTuple):
    """The force of many realisations of a scene."""

    force: Floats
    """[N], [realization, step]."""

    @property
    def kurtosis(self) -> float:
        """Return the kurtosis of the force at the step where it varies most; 3 for a normal distribution."""
        force = self.force[:, int(self.force.std(axis=0).argmax())]
        return float(np.mean((force - force.mean()) ** 4) / force.var() ** 2)

    def true_error(self, count: int) -> float:
        """Return the true standard error of the mean force of ``count`` realisations, over its largest value."""
        return float(self.force.std(axis=0).max() / np.abs(self.force.mean(axis=0)).max() / math.sqrt(count))

    def stop_as_a_batch(self, draws: np.ndarray, error: float) -> int:
        """Return how many of these draws a batch makes before it stops at ``error``."""
        accuracy, moments, count, target = Accuracy(relative=error, max_realizations=len(draws)), MomentTree(), 0, FIRST
        while count < target:
            moments.add_curves(count, self.force[draws[count:target]])
            total = moments.total(target)
            assert total is not None
            count, target = target, next_count(target, relative_error(total), accuracy)
        return count

    def stop_naively(self, draws: np.ndarray, error: float) -> int:
        """Return how many of these draws are made before the estimated error is below ``error``."""
        force = self.force[draws] - self.force.mean(axis=0)  # so that the squares keep their digits
        count = np.arange(1.0, len(draws) + 1.0)[:, None]
        mean = np.cumsum(force, axis=0) / count
        variance = np.cumsum(force**2, axis=0) / count - mean**2
        largest = np.abs(mean + self.force.mean(axis=0)).max(axis=1)
        estimate = np.sqrt(variance.max(axis=1) / np.maximum(count[:, 0] - 1.0, 1.0)) / largest
        reached = np.flatnonzero(estimate[FIRST - 1 :] <= error)
        return FIRST + int(reached[0]) if reached.size else len(draws)


RULES: dict[str, Callable[[ForceSamples, np.ndarray, float], int]] = {
    "as in a batch": ForceSamples.stop_as_a_batch,
    "estimate small enough": ForceSamples.stop_naively,
}


def force_samples(name: str, realizations: int) -> ForceSamples:
    """Compute realisations of one of ``SCENES``."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", rm.LimitWarning)  # steep or not, the statistics are the same
        result = rm.run({**SCENES[name], "batch": {"realizations": realizations}})
    return ForceSamples(result.force.to_numpy())


def realizations_taken(samples: ForceSamples, error: float, seeds: int, rule: str = "as in a batch") -> np.ndarray:
    """Return how many realisations runs with other seeds take to meet ``error``: [seed]."""
    most = 2 * math.ceil((samples.true_error(1) / error) ** 2) + 200
    draws = (np.random.default_rng(seed).integers(0, len(samples.force), most) for seed in range(seeds))
    return np.array([RULES[rule](samples, each, error) for each in draws])


def measure(quick: bool) -> xr.Dataset:
    """Return the realisations taken by every scene, rule and error, and the share of runs that met the error."""
    realizations, seeds = (4000, 40) if quick else (25_000, 200)
    samples = [force_samples(name, realizations) for name in SCENES]
    errors = np.array([[each.true_error(count) for count in MINIMAL_COUNTS] for each in samples])
    taken = np.array(
        [
            [[realizations_taken(each, error, seeds, rule) for error in row] for rule in RULES]
            for each, row in zip(samples, errors, strict=True)
        ]
    )
    minimal, over = np.array(MINIMAL_COUNTS)[:, None], ("scene", "rule", "minimal")
    return xr.Dataset(
        {
            "taken": ((*over, "seed"), taken, named("realisations that a run takes")),
            "asked": (("scene", "minimal"), errors, named("standard error of the mean force over its largest value")),
            "reached": (over, (taken >= minimal).mean(axis=-1), named("share of the runs that meet the error")),
            "thrifty": (
                over,
                (taken <= TOLERATED * minimal).mean(axis=-1),
                named(f"share that takes at most {TOLERATED} times the minimal number"),
            ),
            "kurtosis": ("scene", [each.kurtosis for each in samples], named("kurtosis of the force where it varies")),
        },
        {
            "scene": list(SCENES),
            "rule": list(RULES),
            "minimal": ("minimal", list(MINIMAL_COUNTS), named("least number of realisations that meets the error")),
        },
    )

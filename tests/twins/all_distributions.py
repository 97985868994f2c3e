"""Random expected curves over all continuous distributions of scipy.stats, against quadrature in the probability.

Heights or radii of Hertzian paraboloids have a distribution with shape parameters drawn at random; the force at a few
separations must be within the stated error of a reference that evaluates no density, or the scene be refused.
"""

import math
import warnings
from typing import Any, NamedTuple

import numpy as np
import scipy.stats
from scipy.stats import rv_continuous
from scipy.stats._distn_infrastructure import rv_generic

import roughmdr as rm
from roughmdr.ensemble.random.distribution_families import known_families
from roughmdr.numerics.arguments import Floats
from twins.quantile_means import mean_of_heights, mean_of_radii

SLOW = ("gausshyper", "levy_stable", "rel_breitwigner", "studentized_range")
"""Families whose quantiles take scipy longer than a scene may."""
_COUNT, _MODULUS, _RADIUS, _STD = 1000, 4e6, 5e-5, 1e-6
_SCALE = {"heights": 2e-6, "radii": 5e-5}  # [m]
_SHAPE_PARAMETERS = (0.03, 30.0)
_TRIES = 200
_DRAWS, _SIGMAS = 1_000_000, 5.0
_RTOL_REFERENCE = 3e-2  # references with larger errors judge nothing


class Scene(NamedTuple):
    """A distribution of heights or radii, and separations of the flat."""

    of: str  # "heights" or "radii"
    family: str
    parameters: dict[str, float]
    loc: float
    separation: list[float]

    @property
    def frozen(self) -> Any:
        """The distribution, of scipy.stats [m]."""
        return getattr(scipy.stats, self.family)(**self.parameters, loc=self.loc, scale=_SCALE[self.of])

    @property
    def as_table(self) -> dict[str, Any]:
        """The scene as ``rm.run`` takes it."""
        drawn = {"distribution": self.family, **self.parameters, "loc": self.loc, "scale": _SCALE[self.of]}
        normal = {"distribution": "normal", "std": _STD}
        height, radius = (drawn, _RADIUS) if self.of == "heights" else (normal, drawn)
        source = {"source": "random", "shape": "paraboloid", "count": _COUNT, "patch": 1e9}
        return {
            "material": {"effective_modulus": _MODULUS},
            "asperities": {**source, "height": height, "radius": radius},
            "path": {"separation": self.separation},
            "output": {"variables": ["force"]},
            "batch": {"estimator": "expected"},
        }

    def reference(self) -> tuple[Floats, Floats]:
        """Return the force [N] at each separation, and a bound on its error: the mean of R^1/2 (z - h)^3/2."""
        frozen, heights, separation = self.frozen, self.of == "heights", self.separation
        if has_own_sampler(self.family):
            draws = frozen.rvs(_DRAWS, random_state=np.random.default_rng(_DRAWS))
            terms = [np.maximum(draws - h, 0.0) ** 1.5 for h in separation] if heights else [np.sqrt(draws)]
            mean, doubt = np.mean(terms, axis=1), _SIGMAS * np.std(terms, axis=1) / math.sqrt(_DRAWS)
        else:
            means = [mean_of_heights(frozen, h, 1.5) for h in separation] if heights else [mean_of_radii(frozen, 0.5)]
            mean, doubt = np.array(means).T
        normal = scipy.stats.norm(scale=_STD)
        other = [math.sqrt(_RADIUS) if heights else mean_of_heights(normal, h, 1.5).value for h in separation]
        unit = _COUNT * 4.0 / 3.0 * _MODULUS * np.array(other)
        return unit * mean, unit * doubt


class Verdict(NamedTuple):
    """An expected curve beside its reference; errors are relative to the largest force."""

    scene: Scene
    outcome: str  # "right", "wrong", "refused" or "no reference"
    error: float = math.nan
    stated: float = math.nan


def families() -> list[str]:
    """Return all families that are drawn from."""
    return [name for name in known_families() if name not in SLOW and hasattr(scipy.stats, name)]


def has_own_sampler(family: str) -> bool:
    """Return whether scipy finds the inverse of a family numerically, which is slow, but draws from it otherwise."""
    kind = type(getattr(scipy.stats, family))
    return kind._ppf is rv_continuous._ppf and kind._rvs is not rv_generic._rvs and kind._rvs is not rv_continuous._rvs


def draw(rng: np.random.Generator, of: str, family: str) -> Scene | None:
    """Return a random scene, or None where no set of parameters that was tried has a finite mean."""
    distribution = getattr(scipy.stats, family)
    names = distribution.shapes.split(", ") if distribution.shapes else []
    for _ in range(_TRIES):
        parameters = {name: float(np.exp(rng.uniform(*np.log(_SHAPE_PARAMETERS)))) for name in names}
        for name, share in zip(names, rng.random(len(names)), strict=True):
            parameters[name] *= -1.0 if share < 0.15 else 1.0
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("ignore")
            try:
                if not distribution._argcheck(*parameters.values()) or not np.isfinite(distribution.mean(**parameters)):
                    continue
                if of == "radii" and not distribution.ppf(1e-16, **parameters) >= 0.0:
                    continue
                loc = float(rng.choice([0.0, 0.0, 1e-5, 1e-3])) if of == "heights" else 0.0
                scene = Scene(of, family, parameters, loc, [])
                quantiles = scene.frozen.ppf(np.append(rng.uniform(0.01, 0.999, 2), [0.5]))
            except (ArithmeticError, RuntimeError):  # from Boost and from scipy, for some parameters
                continue
        if not np.isfinite(quantiles).all():
            continue
        spread = float(np.ptp(quantiles)) or _SCALE[of]
        steps = [*quantiles[:2].tolist(), loc, float(quantiles[2]) - spread * float(rng.uniform(0.0, 2.0))]
        return scene._replace(separation=steps if of == "heights" else [1e-6, 0.0, -2e-6])
    return None


def judge(scene: Scene) -> Verdict:
    """Compare the expected curve of a scene with its reference."""
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")
        try:
            curve = rm.run(scene.as_table)
        except rm.RoughmdrError:
            return Verdict(scene, "refused")
        force, doubt = scene.reference()
    largest = float(np.abs(force).max())
    if not doubt.max() <= _RTOL_REFERENCE * largest:
        return Verdict(scene, "no reference", float(doubt.max()) / largest)
    stated = float(curve.numerical_error[0])
    deviation = np.abs(curve.force.to_numpy()[0] - force)
    right = bool((deviation <= stated * largest + doubt).all())
    return Verdict(scene, "right" if right else "wrong", float(deviation.max()) / largest, stated)

"""Random expected laws over all continuous distributions of scipy.stats, each against quadrature in the probability.

Heights or radii of Hertzian paraboloids have a distribution with its own parameters drawn at random; the force at a few
separations must be within the stated error of a reference that evaluates no density, or the scene be refused.
"""

import math
import warnings
from typing import Any, NamedTuple

import numpy as np
import scipy.stats
from oracles.quantile_means import mean_of_heights, mean_of_radii
from scipy.stats import rv_continuous
from scipy.stats._distn_infrastructure import rv_generic

import roughmdr as rm
from roughmdr.ensemble.random.families import known_families
from roughmdr.numerics.arguments import Floats

SLOW = ("gausshyper", "levy_stable", "rel_breitwigner", "studentized_range")
"""Families the quantiles of which take scipy longer than a scene may."""
_COUNT, _MODULUS, _RADIUS, _STD = 1000, 4e6, 5e-5, 1e-6
_SCALE = {"heights": 2e-6, "radii": 5e-5}  # [m]
_OWN = (0.03, 30.0)  # own parameters, where a family takes them
_TRIES = 200
_DRAWS, _SIGMAS = 1_000_000, 5.0
_REFERENCE = 3e-2  # relative: references that are known less well judge nothing


class Scene(NamedTuple):
    """A distribution of heights or radii, and where the flat is."""

    of: str
    """"heights" or "radii"."""
    family: str
    own: dict[str, float]
    loc: float
    separation: list[float]

    @property
    def frozen(self) -> Any:
        """The distribution, of scipy.stats [m]."""
        return getattr(scipy.stats, self.family)(**self.own, loc=self.loc, scale=_SCALE[self.of])

    @property
    def asked(self) -> dict[str, Any]:
        """The scene as ``rm.run`` takes it."""
        drawn = {"distribution": self.family, **self.own, "loc": self.loc, "scale": _SCALE[self.of]}
        heights = self.of == "heights"
        return {
            "material": {"effective_modulus": _MODULUS},
            "asperities": {
                "source": "random",
                "shape": "paraboloid",
                "count": _COUNT,
                "patch": "1 mm",
                "height": drawn if heights else {"distribution": "normal", "std": _STD},
                "radius": _RADIUS if heights else drawn,
            },
            "path": {"separation": self.separation},
            "output": {"variables": ["force"]},
            "batch": {"estimator": "expected"},
        }

    def reference(self) -> tuple[Floats, Floats]:
        """The force [N] at each separation, and how far it may be off."""
        unit = _COUNT * 4.0 / 3.0 * _MODULUS
        means = self._drawn() if drawn_otherwise(self.family) else self._integrated()
        return unit * means[0], unit * means[1]

    def _drawn(self) -> tuple[Floats, Floats]:
        """Means of R^1/2 (z - h)^3/2 over draws that scipy does not make by its inverse."""
        draws = self.frozen.rvs(_DRAWS, random_state=np.random.default_rng(_DRAWS))
        if self.of == "radii":
            heights = self._normal_heights()
            return np.sqrt(draws).mean() * heights, _SIGMAS * np.sqrt(draws).std() / math.sqrt(_DRAWS) * heights
        terms = np.array([math.sqrt(_RADIUS) * np.maximum(draws - h, 0.0) ** 1.5 for h in self.separation])
        return terms.mean(axis=1), _SIGMAS * terms.std(axis=1) / math.sqrt(_DRAWS)

    def _integrated(self) -> tuple[Floats, Floats]:
        """The expected law by quadrature in the probability."""
        if self.of == "heights":
            found = np.array([mean_of_heights(self.frozen, h, 1.5) for h in self.separation]) * math.sqrt(_RADIUS)
            return found[:, 0], found[:, 1]
        value, doubt = mean_of_radii(self.frozen, 0.5)
        return value * self._normal_heights(), doubt * self._normal_heights()

    def _normal_heights(self) -> Floats:
        normal = scipy.stats.norm(scale=_STD)
        return np.array([mean_of_heights(normal, h, 1.5).value for h in self.separation])


def drawn_otherwise(family: str) -> bool:
    """Whether scipy finds the inverse of a family by numbers, which is slow, but draws from it in another way."""
    kind = type(getattr(scipy.stats, family))
    return kind._ppf is rv_continuous._ppf and kind._rvs is not rv_generic._rvs and kind._rvs is not rv_continuous._rvs


class Verdict(NamedTuple):
    """An expected law beside its reference; relative to the largest force."""

    scene: Scene
    outcome: str
    """"right", "wrong", "refused" or "no reference"."""
    error: float
    stated: float
    remark: str = ""


def draw(generator: np.random.Generator, of: str, family: str) -> Scene | None:
    """A scene; None where no tried set of parameters has a finite mean."""
    shapes = getattr(scipy.stats, family).shapes
    names = shapes.split(", ") if shapes else []
    for _ in range(_TRIES):
        own = {name: float(np.exp(generator.uniform(*np.log(_OWN)))) for name in names}
        signs = generator.random(len(names)) < 0.15
        own = {name: -value if sign else value for (name, value), sign in zip(own.items(), signs, strict=True)}
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("ignore")
            distribution = getattr(scipy.stats, family)
            try:
                if not distribution._argcheck(*own.values()) or not np.isfinite(distribution.mean(**own)):
                    continue
                if of == "radii" and not distribution.ppf(1e-16, **own) >= 0.0:
                    continue
                loc = float(generator.choice([0.0, 0.0, 1e-5, 1e-3])) if of == "heights" else 0.0
                scene = Scene(of, family, own, loc, [])
                quantiles = scene.frozen.ppf(np.append(generator.uniform(0.01, 0.999, 2), [0.5]))
            except (ArithmeticError, RuntimeError):  # of Boost and of scipy, for some parameters
                continue
        if not np.isfinite(quantiles).all():
            continue
        spread = float(np.ptp(quantiles)) or _SCALE[of]
        steps = [*quantiles[:2].tolist(), loc, float(quantiles[2]) - spread * float(generator.uniform(0.0, 2.0))]
        return scene._replace(separation=steps if of == "heights" else [1e-6, 0.0, -2e-6])
    return None


def judge(scene: Scene) -> Verdict:
    """The expected law of a scene against its reference."""
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")
        try:
            law = rm.run(scene.asked)
        except rm.RoughmdrError as error:
            return Verdict(scene, "refused", np.nan, np.nan, str(error))
        force, doubt = scene.reference()
    largest = float(np.abs(force).max())
    if not doubt.max() <= _REFERENCE * largest:
        return Verdict(scene, "no reference", float(doubt.max()) / largest, np.nan)
    stated = float(law.numerical_error[0])
    off = np.abs(law.force.to_numpy()[0] - force)
    right = bool((off <= stated * largest + doubt).all())
    return Verdict(scene, "right" if right else "wrong", float(off.max()) / largest, stated)


def families() -> list[str]:
    """All families that are drawn from."""
    return [name for name in known_families() if name not in SLOW]

"""Which adhesion model a curve is of: none, JKR or Dugdale, by Akaike's criterion for small samples (AICc).

K. P. Burnham, D. R. Anderson, Sociological Methods & Research 33 (2004) 261. JKR is the limit of Dugdale for a short
range, and no adhesion that of either: of models that the data do not tell apart that with fewest parameters is taken.
"""

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from roughmdr.errors import RoughmdrError, SceneError
from roughmdr.fitting.measured import MeasuredCurve
from roughmdr.fitting.model import LEAST_NOISE, Model
from roughmdr.fitting.parameters import Known, free_parameters
from roughmdr.fitting.search import Fitted, fitted
from roughmdr.fitting.uncertainty import noise_correlation
from roughmdr.numerics.arguments import Floats
from roughmdr.scene import Scene, read
from roughmdr.scene.keys import entry_at
from roughmdr.schema.toml_text import parse_toml
from roughmdr.storage.labelled import Array

RANGES = "adhesion.range", "adhesion.strength"
"""The keys of which Dugdale's model has one, which is free."""
_TABOR_NUMBERS = 0.3, 1.0, 3.0, 10.0  # Tabor numbers that are tried for the start of Dugdale's range
_ANY_RANGE = 1e-9  # range [m] at which the Tabor number is asked for, which is inversely proportional to it
_NOT_TOLD = 2.0  # difference of AICc up to which data do not tell models apart


class Candidate(NamedTuple):
    """An adhesion model that is fitted, or the reason why not."""

    name: str
    fit: Fitted | None
    reason: str = ""

    @property
    def free(self) -> int:
        """The number of free keys."""
        return len(self.fit.model.parameters) if self.fit else 0

    @property
    def squares(self) -> float:
        """The sum of squares of the measured points; inf where there is no fit."""
        return float(np.sum(np.square(self.fit.found.residuals))) if self.fit else math.inf

    @property
    def tabor(self) -> float:
        """The Tabor number, 0 without adhesion and inf for JKR, the limits."""
        if self.name == "dugdale" and self.fit:
            return self.fit.model.law(self.fit.found.x).tabor
        return math.inf if self.name == "jkr" else 0.0

    def aicc(self, points: int, effective: float, *, stated: bool) -> float:
        """Return AICc up to a constant, with an effective number of independent points; inf where these are too few."""
        parameters, mean = self.free + (not stated), max(self.squares / points, LEAST_NOISE**2)  # one is the noise
        spare = effective - parameters - 1
        if not (spare > 0.0 and mean < math.inf):
            return math.inf
        return effective * (mean if stated else math.log(mean)) + 2.0 * parameters * effective / spare


def best_model(scene: Scene, curve: MeasuredCurve, free: list[str], known: Known = Known()) -> Fitted:
    """Return the best adhesion model, compared with the others.

    Points are as many as are independent by the residuals of the closest fit. SceneError where the scene has no work
    to start from, a key cannot be fitted or is not free, or no model can be fitted.
    """
    if not scene.work > 0.0:
        raise SceneError("scene: adhesion.work: model 'auto' needs one above 0 to start from")
    table = parse_toml(scene.toml)
    own = [key for key in RANGES if key not in free and entry_at(key, table) is not None]
    free_parameters([*free, *own], scene, table, curve, known)
    sticky = [key for key in free if key not in RANGES]
    plain = [key for key in sticky if not key.startswith("adhesion.")]

    def model_of(scene: Scene, keys: list[str]) -> Model:
        bounds, priors = ({key: pair for key, pair in each.items() if key in keys} for each in known)
        return Model(scene, curve, keys, Known(bounds, priors))

    without = _fitted("none", lambda: model_of(_with(scene, {}), plain))
    jkr = _fitted("jkr", lambda: model_of(_with(scene, {"model": "jkr", "work": scene.work}), sticky))
    near = jkr.fit.model.scene(jkr.fit.found.x) if jkr.fit else scene
    candidates = [without, jkr, _fitted("dugdale", lambda: _dugdale(scene, near, sticky, model_of))]
    fits = [each.fit for each in candidates if each.fit]
    has_free = np.array([each.free > 0 for each in candidates])
    if not has_free.any():
        reasons = "; ".join(f"{each.name}: {each.reason}" for each in candidates if each.reason)
        raise SceneError(f"scene: no adhesion model: {reasons}")
    points = curve.load.size
    closest = min((each.found for each in fits), key=lambda found: float(np.sum(np.square(found.residuals))))
    left = np.linalg.qr(closest.slopes[:points])[0]
    effective = noise_correlation(curve, left, closest.residuals).effective(points)
    aicc = np.array([each.aicc(points, effective, stated=curve.error is not None) for each in candidates])
    if not np.isfinite(least := aicc[has_free].min()):
        raise SceneError(f"{curve.origin}: has {effective:.3g} independent points, too few to tell models apart")
    alike = [each for each, number in zip(candidates, aicc, strict=True) if number <= least + _NOT_TOLD]
    best = min(alike, key=lambda each: (each.free == 0, each.free, each.squares))
    others = " and ".join(f'"{each.name}"' for each in alike if each is not best)
    doubt = f'the curve does not tell adhesion model "{best.name}", the simplest with free keys, from {others}'
    if aicc.min() < least - _NOT_TOLD:
        doubt = "without adhesion, which leaves no key free, the curve is fitted better"
    assert best.fit is not None
    model = best.fit.model
    model.seconds = sum(each.model.seconds for each in fits)
    model.evaluations = sum(each.model.evaluations for each in fits)
    return Fitted(model, best.fit.found, _table(candidates, aicc), (doubt,) if others else ())


def _table(candidates: list[Candidate], aicc: Floats) -> dict[str, Array]:
    """Return the arrays over ``model``; those without units are texts."""
    weight = np.exp(-0.5 * (aicc - aicc.min()))
    sizes = [c.fit.model.curve.relative_rms(c.fit.found.deviations) if c.fit else math.inf for c in candidates]
    numbers: dict[str, tuple[Any, str]] = {
        "aicc": (aicc, "corrected Akaike criterion, up to a constant; infinite where there is no fit"),
        "akaike_weight": (weight / weight.sum(), "Akaike weight"),
        "tabor_parameter": ([each.tabor for each in candidates], "Tabor number; 0 without adhesion, infinite for JKR"),
        "model_residual_rms": (sizes, "root mean square of the residual over the largest load"),
    }
    texts = {
        "model_name": ([each.name for each in candidates], "adhesion model"),
        "model_failure": ([each.reason for each in candidates], "why there is no fit; empty where there is one"),
    }
    return {
        name: Array(("model",), np.array(values), {"long_name": text} | ({"units": "1"} if name in numbers else {}))
        for name, (values, text) in (numbers | texts).items()
    }


def _with(scene: Scene, adhesion: dict[str, Any]) -> Scene:
    table = {key: entry for key, entry in parse_toml(scene.toml).items() if key != "adhesion"}
    return read(table | ({"adhesion": adhesion} if adhesion else {}))


def _fitted(name: str, made: Callable[[], Model]) -> Candidate:
    try:
        return Candidate(name, fitted(made()))
    except RoughmdrError as error:
        return Candidate(name, None, str(error))


def _dugdale(scene: Scene, near: Scene, free: list[str], model_of: Callable[[Scene, list[str]], Model]) -> Model:
    """Return Dugdale's model with the parameters of a nearby scene and the best of some ranges and the scene's."""
    given, start = parse_toml(scene.toml)["adhesion"], np.zeros(len(free))
    key = "strength" if "strength" in given else "range"
    jkr = model_of(_with(near, {"model": "jkr", "work": near.work, "range": _ANY_RANGE}), free)
    ranges = [_ANY_RANGE * jkr.law(start).tabor / number for number in _TABOR_NUMBERS]
    values = [each if key == "range" else near.work / each for each in ranges] + [given.get(key)] * (key in given)
    scenes = [_with(near, {"model": "dugdale", "work": near.work, key: value}) for value in values]
    models = [model_of(each, [*free, f"adhesion.{key}"]) for each in scenes]
    return min(models, key=lambda each: each.point(np.append(start, 0.0)).cost)

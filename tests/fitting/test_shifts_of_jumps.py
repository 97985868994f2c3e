"""Derivatives of the positions of jumps: those of differences of two laws, for every kind of fold, in any units."""

from typing import Any

import numpy as np
import pandas as pd
import pytest
from forms import large
from tips import MODULUS, OFFSET, WORK, Floats

import roughmdr as rm
from roughmdr.fitting.fit import scene_to_fit
from roughmdr.fitting.jumps import _least, _neighbours, foreseen, nearest_in
from roughmdr.fitting.measured import read_measured
from roughmdr.fitting.model import Model
from roughmdr.fitting.slopes import slopes_of, slopes_of_jumps

SHAPES = {
    "paraboloid": {"radius": 10.0},
    "sphere": {"radius": 10.0},
    "cone": {"slope": 0.3},
    "power_law": {"width": 1.0, "rise": 0.1, "exponent": 3.0},
    "truncated_cone": {"flat_radius": 1.0, "slope": 0.2},
    "rounded_cone": {"blend_radius": 1.0, "slope": 0.3},
    "rounded_punch": {"flat_radius": 1.0, "edge_radius": 3.0},
    "flat_punch": {"radius": 1.0},
}
"""Shape parameters, lengths over the scale; the first one is free. Folds are smooth, at a corner, or of a flat."""
STIFFNESS = {"none": None, "soft": 0.3, "stiff": 30.0}
"""Stiffness of the machine over modulus and scale."""


def scene_of(shape: str, scale: float, stiffness: float | None) -> dict[str, Any]:
    own = {key: value if key in ("slope", "exponent") else value * scale for key, value in SHAPES[shape].items()}
    return {
        "title": "One tip",
        "asperities": {"source": "random", "shape": shape, "count": 1, "patch": 100.0 * scale, "height": 0} | own,
        "material": {"modulus": 1e6, "poisson": 0.5},
        "adhesion": {"model": "jkr", "work": 1e3 * scale},
        "path": {} if stiffness is None else {"machine_stiffness": stiffness * 1e6 * scale},
    }


def model_of(scene: dict[str, Any], steps: Floats, force: Floats, free: list[str]) -> Model:
    control = "remote" if scene["path"] else "separation"
    curve = read_measured(pd.DataFrame({control: steps, "force": force}), 4)
    return Model(*scene_to_fit(scene, {}, curve, free), free)


def down_and_up(scale: float, points: int) -> Floats:
    down = np.linspace(2.0 * scale, -2.0 * scale, points)
    return np.concatenate([down, down[::-1]])


@pytest.mark.parametrize("stiffness", STIFFNESS)
@pytest.mark.parametrize("scale", [1e-9, large(1e-6), 1.0])
@pytest.mark.parametrize("shape", ["paraboloid", *map(large, list(SHAPES)[1:])])
def test_shifts_are_those_of_differences(shape: str, scale: float, stiffness: str) -> None:
    """To rounding for both bodies and the zero of the control, without a law; to 1e-8 for the shape, by two laws."""
    steps, x, step = down_and_up(scale, 40), np.array([0.1, -0.2, 0.05, 0.03]), 2e-3
    free = [MODULUS, WORK, OFFSET, f"asperities.{next(iter(SHAPES[shape]))}"]
    model = model_of(scene_of(shape, scale, STIFFNESS[stiffness]), steps, -steps, free)

    def control(x: Floats) -> Floats:
        return model.point(x).law.changes.control

    model.point(x)
    before, found = model.evaluations, slopes_of_jumps(model, x)
    assert found is not None
    assert model.evaluations == before + 2 + (stiffness != "none")
    assert found.shape == (2, 4)
    for number, tolerance in enumerate([1e-12, 1e-12, 1e-12, 1e-8]):
        one = np.eye(4)[number] * step
        exact = (8.0 * (control(x + one) - control(x - one)) - control(x + 2.0 * one) + control(x - 2.0 * one)) / 12.0
        assert found[:, number] == pytest.approx(exact / step, abs=tolerance * scale)


CURVES = [(shape, points, "none") for shape in SHAPES for points in (15, 200)]


@pytest.mark.large
@pytest.mark.parametrize(("shape", "points", "stiffness"), [*CURVES, ("paraboloid", 40, "soft")])
def test_an_interval_that_is_foreseen_to_be_worse_is_worse(shape: str, points: int, stiffness: str) -> None:
    rng, scale, left_out = np.random.default_rng([points, list(SHAPES).index(shape)]), 1e-6, 0
    scene, steps = scene_of(shape, scale, STIFFNESS[stiffness]), down_and_up(scale, points)
    control = "separation" if stiffness == "none" else "remote"
    law = rm.run(scene | {"path": scene["path"] | {control: steps.tolist()}, "batch": {"estimator": "expected"}})
    force = law.force.to_numpy().ravel()
    for noise in (1e-3, 1e-2, 0.1):
        noisy = force + noise * np.abs(force).max() * rng.standard_normal(force.size)
        model = model_of(scene, steps, noisy, [MODULUS, WORK, OFFSET])
        for x in (np.zeros(3), rng.normal(size=3) * [0.02, 0.02, 0.01]):
            best = _least(model, model.point(x))
            slopes, by_each = slopes_of(model, best.x), slopes_of_jumps(model, best.x)
            for interval in _neighbours(best.jumps):
                other = nearest_in(model, best, interval, by_each)
                if other is not None and foreseen(model, best, slopes, interval) > best.cost:
                    assert _least(model, other).cost > (1.0 - 1e-7) * best.cost
                    left_out += 1
    assert left_out > 0

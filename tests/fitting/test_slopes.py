"""Slopes that follow from the law: those of the textbook's law, and of differences of our own, in any units."""

from typing import Any

import numpy as np
import pandas as pd
import pytest
from forms import large
from tips import COMBINATIONS, MODULUS, OFFSET, WORK, Floats, Tip

from roughmdr.fitting.fit import scene_to_fit
from roughmdr.fitting.measured import read_measured
from roughmdr.fitting.model import Model
from roughmdr.fitting.parameters import Known
from roughmdr.fitting.slopes import slopes_of

LINE = ["baseline", "baseline_slope"]
LOGNORMAL = {"distribution": "lognormal", "mean": 1e-6, "std": 3e-7}
ROUGH = {"count": 300, "patch": 30e-6, "height": {"distribution": "normal", "std": 3e-8}, "radius": LOGNORMAL}
TIP = Tip("jkr", 1e-7, 1e6)


def model_of(scene: dict[str, Any], measured: pd.DataFrame, free: list[str], known: Known = Known()) -> Model:
    curve = read_measured(measured, len(free))
    return Model(*scene_to_fit(scene, {}, curve, free), free, known)


def measured_by(tip: Tip, control: str = "separation") -> pd.DataFrame:
    measured = tip.measure(np.random.default_rng(0), 60, ("constant", 0.01), 0.0)
    return measured.rename(columns={"separation": control})


def difference(of: Any, number: int, x: Floats, step: float) -> Floats:
    """The derivative of the fourth order."""
    one = np.eye(x.size)[number] * step
    return np.asarray((8.0 * (of(x + one) - of(x - one)) - of(x + 2.0 * one) + of(x - 2.0 * one)) / (12.0 * step))


@pytest.mark.parametrize(("scale", "modulus"), [(1e-9, 1e9), (1e-3, 1e5)])
@pytest.mark.parametrize("kind", COMBINATIONS)
def test_slopes_of_a_tip_are_the_textbooks(kind: str, scale: float, modulus: float) -> None:
    tip, free = Tip(kind, scale, modulus), [*COMBINATIONS[kind][-1], *LINE]
    measured = measured_by(tip)
    model, x = model_of(tip.scene(), measured, free), np.array([0.1, -0.2, 0.3, 0.02, 0.03][-len(free) :])
    model.point(x)
    before, found = model.evaluations, slopes_of(model, x)
    assert model.evaluations == before + 1

    def law(x: Floats) -> Floats:
        true = tip.true(0.0) | {p.key: p.value(float(each)) for p, each in zip(model.parameters, x, strict=True)}
        force = tip.law(true[MODULUS], true[WORK], -(measured.separation.to_numpy() + true[OFFSET]))
        return np.asarray((force + model.baseline(x)) / model.curve.weight)

    for number in range(x.size):
        exact = difference(law, number, x, 1e-4)
        assert found[:, number] == pytest.approx(exact, abs=1e-7 * np.abs(exact).max())


CASES = {
    "rough": (ROUGH, {}, {"effective_modulus": 1e6}, ["material.effective_modulus", OFFSET], 1),
    "a body opposite": (ROUGH, {"counter": {"modulus": 3e6, "poisson": 0.3}}, {}, [MODULUS, OFFSET], 3),
    "a flat with an edge": (
        {"shape": "truncated_cone", "slope": 0.2, "flat_radius": 2e-7},
        None,
        {},
        [MODULUS, WORK],
        1,
    ),
    "a sphere": ({"shape": "sphere", "radius": 3e-6}, None, {}, [MODULUS, WORK, OFFSET], 1),
    "populations that adhere": (ROUGH, None, {}, [MODULUS, WORK, OFFSET], 6),
}


@pytest.mark.few(1)
@pytest.mark.parametrize("case", [large(name) if name in ("a sphere", "rough") else name for name in CASES])
def test_slopes_are_differences_of_the_law(case: str) -> None:
    """With a prior, whose row is behind those of the points; without adhesion pressures are measured."""
    own, changes, material, free, laws = CASES[case]
    scene = TIP.scene(**changes or {})
    scene["asperities"] = {"source": "random", "shape": "paraboloid", "count": 1, "height": 0, "patch": 1e-5} | own
    scene["material"] = material or scene["material"]
    measured = measured_by(TIP)
    if changes is not None:
        del scene["adhesion"]
        measured = measured.drop(columns="force_error").rename(columns={"force": "pressure"})
    known = Known(priors={free[0]: (2e6, 1e5)})
    model, x = model_of(scene, measured, free, known), np.array([0.1, -0.2, 0.3])[: len(free)]
    model.noise = 1.0
    model.point(x)
    before, found = model.evaluations, slopes_of(model, x)
    assert model.evaluations == before + laws
    assert found.shape[0] == len(measured) + 1
    for number in range(x.size):
        exact = difference(lambda x: model.point(x).deviations, number, x, 1e-3)
        assert found[:, number] == pytest.approx(exact, abs=2e-6 * np.abs(exact).max())


@pytest.mark.parametrize("kind", ["hertz", large("jkr")])
def test_slopes_on_a_machine_are_those_of_its_law(kind: str) -> None:
    tip = Tip(kind, 1e-6, 1e6)
    free = [*COMBINATIONS[kind][-1], *LINE, "path.machine_stiffness"]
    model = model_of(tip.scene(path={"machine_stiffness": 0.7}), measured_by(tip, "remote"), free)
    x = np.array([0.1, -0.2, 0.1, 0.02, 0.03, 0.1][-len(free) :])
    found, model.near = slopes_of(model, x), None
    for number in range(x.size):
        exact = difference(lambda x: model.point(x).deviations, number, x, 1e-3)
        assert found[:, number] == pytest.approx(exact, abs=2e-6 * np.abs(exact).max())

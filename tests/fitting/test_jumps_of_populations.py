"""Two tips at two heights: each makes and loses contact by a jump of its own, of which the other knows nothing."""

from typing import Any

import numpy as np
import pandas as pd
import pytest
from tips import MODULUS, OFFSET, WORK, Tip

import roughmdr as rm
from roughmdr.fitting.fit import scene_to_fit
from roughmdr.fitting.measured import read_measured
from roughmdr.fitting.model import Model
from roughmdr.fitting.slopes import slopes_of_jumps

TIP, BELOW, ZERO = Tip("jkr", 1e-6, 2e6), 0.6e-6, 1e-7
FREE = [MODULUS, WORK, OFFSET]


def two() -> dict[str, Any]:
    scene = TIP.scene()
    scene["asperities"] |= {"count": 2, "second": {"share": 0.5, "height": -BELOW}}
    return scene


def measure(seed: int, points: int) -> tuple[pd.DataFrame, float]:
    """Both tips' forces with 1 % noise, pressed and lifted, and the sum of squares of that noise."""
    down = np.linspace(1e-6, -2e-6, points)
    steps = np.concatenate([down, down[::-1]])
    force = sum(TIP.law(2e6, TIP.work, -(steps + ZERO + below)) for below in (0.0, BELOW))
    noise = 0.01 * np.abs(force).max() * np.random.default_rng(seed).standard_normal(steps.size)
    return pd.DataFrame({"separation": steps, "force": force + noise}), float(np.sum(noise**2))


@pytest.mark.parametrize("points", [100, 3])
def test_the_jumps_of_both_lie_where_they_are_alone(points: int) -> None:
    """Made at first touch and lost at the fold, -3/4 (pi w R^(1/2)/E*)^(2/3); of few points, in one step together."""
    measured, _ = measure(0, points)
    curve = read_measured(measured, 3)
    model = Model(*scene_to_fit(two(), {}, curve, FREE), FREE)
    offset = model.parameters[2]
    x = np.array([0.0, 0.0, (ZERO - offset.start) / offset.scale])
    found = slopes_of_jumps(model, x)
    assert found is not None
    fold = 0.75 * (np.pi * TIP.work * np.sqrt(TIP.size) / (2e6 / 0.75)) ** (2.0 / 3.0)
    places = np.array([0.0, -BELOW, fold - BELOW, fold]) - ZERO
    assert model.point(x).law.changes.control == pytest.approx(places, abs=1e-12 * TIP.scale)
    shift = 2.0 / 3.0 * fold * np.array([0.0, 0.0, 1.0, 1.0])
    by_each = np.stack([-shift, shift, np.full(4, -offset.scale)], axis=1)
    assert found == pytest.approx(by_each, abs=1e-12 * TIP.scale)


@pytest.mark.parametrize("stiffness", [0.3, 3.0, 300.0])
def test_a_cantilever_jumps_where_one_asperity_does(stiffness: float) -> None:
    """Into contact at first touch, off it where ``pull_off`` finds the fold with that spring."""
    fold = float(
        rm.pull_off(
            rm.Paraboloid(radius=TIP.size),
            control="remote",
            machine_stiffness=stiffness,
            effective_modulus=2e6 / 0.75,
            work=TIP.work,
            adhesion="jkr",
        ).remote
    )
    remote = np.concatenate([down := np.linspace(-2.0 * fold, -2e-6, 60), down[::-1]])
    curve = read_measured(pd.DataFrame({"remote": remote, "force": -remote}), 3)
    model = Model(*scene_to_fit(TIP.scene(path={"machine_stiffness": stiffness}), {}, curve, FREE), FREE)
    assert model.point(np.zeros(3)).law.changes.control == pytest.approx([0.0, -fold], abs=1e-10 * TIP.scale)


@pytest.mark.large
def test_every_start_leads_to_the_same_jumps() -> None:
    measured, noise = measure(2, 100)
    starts = [{MODULUS: 1.5e6}, {MODULUS: 1e6, WORK: 0.5 * TIP.work}]
    fits = [rm.fit(measured, two(), FREE, set=start) for start in starts]
    assert float(np.sum(np.square(fits[0].residual))) < noise
    for key, true in TIP.true(ZERO).items():
        name = key.replace(".", "_")
        found = [float(fit[name]) for fit in fits]
        assert found == pytest.approx([found[0]] * len(fits), rel=1e-5)
        assert float(fits[0][f"{name}_low"]) <= true <= float(fits[0][f"{name}_high"])

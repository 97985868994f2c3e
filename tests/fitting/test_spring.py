"""Slopes of a law behind a spring: as its own differences, with the memory of adhesion, in any units."""

from itertools import pairwise
from typing import Any

import numpy as np
import pandas as pd
import pytest
from forms import large
from hypothesis import given, settings, strategies as st
from numpy.typing import NDArray

from roughmdr.fitting.fit import scene_to_fit
from roughmdr.fitting.measured import read_measured
from roughmdr.fitting.model import Model
from roughmdr.fitting.slopes import slopes_of
from roughmdr.fitting.spring import Spring

FREE = ["material.effective_modulus", "adhesion.work", "asperities.height.std", "path.machine_stiffness", "offset"]
_STEP = 1e-4  # change of x in differences, whose errors are its square and 1e-12 over it


def rough(length: float, modulus: float, unlike: bool) -> dict[str, Any]:
    """Adhesive asperities whose pull-off shows beside their force; lengths of about ``length`` [m]."""
    radius = {"distribution": "lognormal", "mean": length, "std": 0.3 * length} if unlike else length
    asperities = {"source": "random", "shape": "paraboloid", "count": 300, "patch": 30.0 * length, "radius": radius}
    return {
        "title": "Rough and adhesive",
        "material": {"effective_modulus": modulus},
        "adhesion": {"model": "jkr", "work": 3e-3 * modulus * length},
        "asperities": asperities | {"height": {"distribution": "normal", "std": 0.03 * length}},
        "path": {"machine_stiffness": 30.0 * modulus * length},
    }


def model_on_machine(scene: dict[str, Any], remote: NDArray[np.float64]) -> Model:
    force = np.linspace(-1.0, 1.0, remote.size) * scene["path"]["machine_stiffness"] * float(np.ptp(remote))
    curve = read_measured(pd.DataFrame({"remote": remote, "force": force}), len(FREE))
    return Model(*scene_to_fit(scene, {}, curve, FREE), FREE)


@pytest.mark.large
@pytest.mark.parametrize(
    ("length", "modulus", "unlike"), [(1e-6, 1e6, False), large(1e-9, 1e11, False), large(1e-3, 1e4, True)]
)
def test_slopes_are_those_of_the_law_on_its_machine(length: float, modulus: float, unlike: bool) -> None:
    """Loading, half unloading, loading again and unloading: each load remembers three turns."""
    ends = np.array([0.12, -0.05, 0.02, -0.1, 0.1]) * length
    remote = np.concatenate([np.linspace(a, b, 4)[:-1] for a, b in pairwise(ends)])
    model = model_on_machine(rough(length, modulus, unlike), remote)
    x = np.array([0.05, -0.1, 0.08, 0.02, 0.03])
    found = slopes_of(model, x)
    apart = model_on_machine(rough(length, modulus, unlike), remote)
    for number, direction in enumerate(np.eye(x.size)):
        sides = [apart.point(x + sign * _STEP * direction).deviations for sign in (1.0, -1.0)]
        exact = (sides[0] - sides[1]) / (2.0 * _STEP)
        assert found[:, number] == pytest.approx(exact, abs=3e-6 * np.abs(exact).max())


@pytest.mark.large
def test_loads_near_known_ones_are_those_of_the_machine() -> None:
    length = 1e-7
    remote = np.concatenate([np.linspace(0.1, -0.1, 10), np.linspace(-0.08, 0.1, 10)]) * length
    model, apart = (model_on_machine(rough(length, 1e8, unlike=False), remote) for _ in range(2))
    x = np.zeros(len(FREE))
    slopes_of(model, x)
    assert model.near is not None
    before = model.evaluations
    near, exact = (each.point(x + 0.02).law.force for each in (model, apart))
    assert model.evaluations - before > 1  # by iteration, each time at given separations
    assert near == pytest.approx(exact, abs=1e-10 * np.abs(exact).max())


@settings(deadline=None, max_examples=50)
@given(st.lists(st.sampled_from([-1.0, 0.0, 1.0, 2.0]), min_size=2, max_size=12), st.integers(0, 2**31))
def test_it_solves_the_linear_equations(moves: list[float], seed: int) -> None:
    """Against the whole matrix, in which a load depends on the mean change at each turn before."""
    control, rng = np.cumsum([0.0, *moves]), np.random.default_rng(seed)
    matrix = np.diag(-rng.random(control.size))
    memory = rng.uniform(-1.0, 1.0, control.size)

    def slope(steps: NDArray[np.bool_]) -> NDArray[np.float64]:
        after = np.arange(control.size) > np.flatnonzero(steps).max(initial=control.size)
        return np.where(steps, np.diag(matrix), np.where(after & (steps.sum() < control.size / 2), memory, 0.0))

    spring = Spring.of(control, np.zeros(control.size), 1.0, slope)
    whole = np.diag(spring.own)
    for number, turn in enumerate(spring.turns):
        whole[:, turn] += spring.by_turns[:, number, None] / turn.sum()
    change = rng.standard_normal((control.size, 2))
    exact = np.linalg.solve(np.eye(control.size) - whole, change)
    assert spring.yielded(change) == pytest.approx(exact, rel=1e-10, abs=1e-12)

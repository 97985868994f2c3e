"""Jumps of a law cut the intervals of a fit, and no farther than they are certain."""

import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings, strategies as st
from scipy.optimize import minimize
from tips import MODULUS, OFFSET, WORK, Floats, Tip

import roughmdr as rm
from roughmdr.fitting.profile import Edges, farthest


@settings(deadline=None, max_examples=30)
@given(seed=st.integers(0, 10**6), count=st.integers(1, 3), edges=st.integers(0, 4))
def test_the_farthest_is_that_of_an_optimiser(seed: int, count: int, edges: int) -> None:
    rng = np.random.default_rng(seed)
    direction, sides = rng.standard_normal(count), rng.standard_normal((edges, count))
    direction /= np.linalg.norm(direction)  # else the optimiser takes a short one for none
    ends, radius = rng.uniform(0.0, 2.0, edges), rng.uniform(0.5, 3.0)
    bounds = [
        {"type": "ineq", "fun": lambda u: radius**2 - u @ u, "jac": lambda u: -2.0 * u},
        {"type": "ineq", "fun": lambda u: ends - sides @ u, "jac": lambda u: -sides},
    ]
    found = minimize(
        lambda u: -direction @ u, np.zeros(count), jac=lambda u: -direction, constraints=bounds[: 1 + (edges > 0)]
    )
    assert farthest(direction, radius, Edges(sides, ends)) == pytest.approx(-found.fun, rel=1e-5, abs=1e-6)


def touching(tip: Tip, steps: Floats, offset: float) -> Floats:
    return tip.law(tip.modulus, tip.work, -(steps + offset)) != 0.0


def ends_of_offset(points: int, columns: list[str]) -> tuple[Tip, Floats, list[float]]:
    tip, rng = Tip("jkr", 1e-6, 1e3), np.random.default_rng(points)
    measured = tip.measure(rng, points, ("constant", 0.01), 1e-7)[columns]
    fit = rm.fit(measured, tip.scene(), [OFFSET])
    return tip, measured.separation.to_numpy(), [float(fit[f"offset{end}"]) for end in ("_low", "", "_high")]


@pytest.mark.few(1)
@pytest.mark.parametrize("columns", [["separation", "force"], ["separation", "force", "force_error"]])
def test_an_offset_stays_where_the_contact_is_made_and_lost_as_measured(columns: list[str]) -> None:
    cut = 0
    for points in range(400, 800, 80):
        tip, steps, (low, value, high) = ends_of_offset(points, columns)
        slack = 1e-5 * abs(steps[1] - steps[0])
        assert low <= value <= high
        seen = [tip.law(tip.modulus, tip.work, -(steps + each)) != 0.0 for each in (low + slack, value, high - slack)]
        assert (seen[0] == seen[1]).all()
        assert (seen[2] == seen[1]).all()
        cut += abs((high - value) - (value - low)) > 1e-3 * (high - low)
    assert cut


def test_a_jump_within_the_noise_cuts_nothing() -> None:
    tip, rng = Tip("jkr", 1e-6, 1e3), np.random.default_rng(1)
    measured: pd.DataFrame = tip.measure(rng, 60, ("constant", 1.0), 0.0)
    fit = rm.fit(measured, tip.scene(), [MODULUS, WORK], set={MODULUS: tip.modulus, WORK: tip.work})
    logarithm = [np.log(float(fit[f"material_modulus{end}"])) for end in ("_low", "", "_high")]
    assert logarithm[2] - logarithm[1] == pytest.approx(logarithm[1] - logarithm[0], rel=1e-6)

"""Quadrature over normal scores, and means over tails."""

import math

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from scipy.special import ndtr

import roughmdr as rm
from roughmdr.ensemble.nodes import Rule, fraction_above, hermite, mean_over_edge


@pytest.mark.parametrize("order", [1, 2, 5, 12])
def test_a_smooth_rule_has_the_moments_of_a_normal_score(order: int) -> None:
    """Up to twice its order; the odd ones are 0, the even ones (m - 1)!!."""
    scores, weights = Rule.smooth(order)
    for m in range(2 * order):
        exact = 0.0 if m % 2 else math.prod(range(m - 1, 0, -2))
        assert float(weights @ scores**m) == pytest.approx(exact, rel=1e-10, abs=1e-10 * math.factorial(m))
    np.testing.assert_allclose(hermite(scores, order) * weights @ hermite(scores, order).T, np.eye(order), atol=1e-10)


@settings(deadline=None, max_examples=30)
@given(st.floats(-6.0, 6.0))
def test_weights_below_an_end_integrate_polynomials_up_to_it(end: float) -> None:
    rule = Rule.smooth(7)
    weights = rule.weights_below(np.array([end, -50.0, 50.0]))
    density = math.exp(-0.5 * end * end) / math.sqrt(2.0 * math.pi)
    exact = [float(ndtr(end)), -density, float(ndtr(end)) - end * density]
    np.testing.assert_allclose([weights[0] @ rule.scores**m for m in range(3)], exact, atol=1e-12)
    np.testing.assert_allclose(weights[1], 0.0, atol=1e-12)
    np.testing.assert_allclose(weights[2], rule.weights, atol=1e-12)


@pytest.mark.parametrize("cuts", [[], [0.3], [-1.2, 0.0, 2.5], [99.0, -99.0]])
def test_a_rule_between_cuts_takes_roots_next_to_them(cuts: list[float]) -> None:
    rule = Rule.between(cuts, 40)
    assert float(rule.weights.sum()) == pytest.approx(1.0, abs=1e-12)
    assert (np.diff(rule.scores) > 0.0).all()
    for cut in (each for each in cuts if abs(each) < 5.0):
        x = np.linspace(cut, cut + 12.0, 400_001)[1:] - 1.5e-5  # plain midpoints
        exact = float(np.sum(np.sqrt(x - cut) * np.exp(-0.5 * x * x)) * 3e-5 / math.sqrt(2.0 * math.pi))
        found = float(rule.weights @ np.sqrt(np.maximum(rule.scores - cut, 0.0)))
        assert found == pytest.approx(exact, rel=1e-6)


def test_a_mean_over_a_tail_has_a_bound_below_index_1_only() -> None:
    """The mean of u^-k over u from 0 to 1 is 1/(1 - k)."""
    found = mean_over_edge(np.array([-1.0, 0.0, 0.5, 0.9, 1.0, 1.5]))
    np.testing.assert_allclose(found, [0.5, 1.0, 2.0, 10.0, math.inf, math.inf], rtol=1e-12)


def test_half_of_a_distribution_lies_above_its_median() -> None:
    assert fraction_above(0.0) == 0.5
    assert fraction_above(1.0) + fraction_above(-1.0) == pytest.approx(1.0)
    assert fraction_above(10.0) == pytest.approx(7.6e-24, rel=1e-2)


def test_a_narrow_distribution_far_from_0_has_its_moments() -> None:
    """Moments of a family are checked by bounds that do not depend on the location."""
    heights = {"distribution": "loguniform", "a": 1000.0, "b": 1001.0, "mean": 0.0, "std": "1 um"}
    section = {"source": "random", "shape": "paraboloid", "count": 2000, "patch": "1 mm", "radius": "50 um"}
    height = rm.generate({**section, "height": heights}, seed=1).height.values
    assert float(height.std()) == pytest.approx(1e-6, rel=0.05)
    assert abs(float(height.mean())) < 1e-7

"""Gauss's rules of discrete measures: against Gauss-Legendre and Gauss-Hermite rules, and polynomials."""

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from roughmdr.expected.height_rules import gauss_of_points

FINE = np.polynomial.legendre.leggauss(200)


@pytest.mark.parametrize("count", [1, 2, 5, 12])
def test_of_a_fine_uniform_measure_it_is_the_rule_of_legendre(count: int) -> None:
    nodes, weights = gauss_of_points(*FINE, count)
    exact_nodes, exact_weights = np.polynomial.legendre.leggauss(count)
    np.testing.assert_allclose(nodes, exact_nodes, atol=1e-13)
    np.testing.assert_allclose(weights, exact_weights, rtol=1e-11)


def test_of_a_normal_density_it_is_the_rule_of_hermite() -> None:
    x = 12.0 * FINE[0]
    nodes, weights = gauss_of_points(x, FINE[1] * np.exp(-0.5 * x * x), 10)
    exact_nodes, exact_weights = np.polynomial.hermite_e.hermegauss(10)
    np.testing.assert_allclose(nodes, exact_nodes, atol=1e-11)
    np.testing.assert_allclose(weights / weights.sum(), exact_weights / exact_weights.sum(), rtol=1e-9)


@settings(deadline=None)
@given(
    points=st.lists(st.floats(-1.0, 1.0), min_size=1, max_size=40, unique=True),
    scale=st.sampled_from([1e-9, 1.0, 1e9]),
    count=st.integers(1, 12),
    seed=st.integers(0, 99),
)
def test_polynomials_are_integrated_exactly(points: list[float], scale: float, count: int, seed: int) -> None:
    """Up to degree 2n - 1, on any scale; few points are their own rule."""
    x = scale * np.sort(np.array(points))
    weights = np.random.default_rng(seed).uniform(0.1, 1.0, x.size)
    nodes, found = gauss_of_points(x, weights, count)
    assert nodes.size <= min(count, x.size)
    assert (found > 0.0).all()
    assert (np.diff(nodes) > 0.0).all()
    assert np.isclose(found.sum(), weights.sum(), rtol=1e-12)
    assert nodes.min() >= x.min() - 1e-9 * scale
    assert nodes.max() <= x.max() + 1e-9 * scale
    for degree in range(2 * nodes.size):
        exact, by_rule = (weights * (x / scale) ** degree).sum(), (found * (nodes / scale) ** degree).sum()
        assert abs(by_rule - exact) <= 1e-9 * weights.sum()

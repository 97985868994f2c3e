"""Integrals over panels that are halved: powers, kinks and jumps at any place, several integrals at once."""

import math

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.quadrature import Rows, integrate, panel_rule, refine_edges, running_integral

UNIT = np.array([[0.0, 1.0]])
places = st.floats(0.01, 0.99)


def one(function: object, edges: Floats = UNIT) -> float:
    def checked(rows: Rows, x: Floats) -> Floats:
        assert ((x >= edges[0, 0]) & (x <= edges[0, -1])).all()  # never beyond the ends
        return np.asarray(function(x))  # type: ignore[operator]

    return float(integrate(checked, edges)[0])


@settings(deadline=None, max_examples=30)
@given(places, st.floats(0.5, 8.0))
def test_a_kink_is_found_wherever_it_is(place: float, power: float) -> None:
    found = one(lambda x: np.abs(x - place) ** power)
    exact = (place ** (power + 1.0) + (1.0 - place) ** (power + 1.0)) / (power + 1.0)
    assert found == pytest.approx(exact, rel=1e-12)


@pytest.mark.large
@settings(deadline=None, max_examples=30)
@given(st.floats(1e-8, 1.0 - 1e-8))
def test_a_jump_is_found_wherever_it_is(place: float) -> None:
    """Also between an end and the node next to it, which no rule of Gauss sees."""
    assert one(lambda x: np.where(x < place, 1.0, 3.0)) == pytest.approx(place + 3.0 * (1.0 - place), abs=1e-9)


@pytest.mark.parametrize("power", [-0.6, -0.5, -0.3, 0.25, 1.5])
def test_powers_at_an_end_are_integrated(power: float) -> None:
    tolerance = 1e-9 if power < -0.5 else 1e-11
    assert one(lambda x: x**power) == pytest.approx(1.0 / (1.0 + power), rel=tolerance)
    assert one(lambda x: (1.0 - x) ** max(power, 0.0)) == pytest.approx(1.0 / (1.0 + max(power, 0.0)), rel=1e-11)


def test_many_integrals_have_each_its_own_panels() -> None:
    """Over edges that do not descend; of no width they have no integral. Lengths in any unit."""
    for unit in (1e-9, 1.0, 1e6):
        edges = unit * np.array([[0.0, 1.0, 1.0, 2.0], [1.0, 1.0, 1.0, 1.0], [-3.0, -1.0, 0.0, 4.0]])
        steep = np.array([3.0, 1.0, 0.5])
        found = integrate(lambda rows, x, steep=steep, unit=unit: np.exp(-steep[rows][:, None] * x / unit), edges)
        exact = unit * (np.exp(-steep * edges[:, 0] / unit) - np.exp(-steep * edges[:, -1] / unit)) / steep
        np.testing.assert_allclose(found, exact, rtol=1e-13, atol=0.0)


def test_what_is_not_finite_is_left_to_the_caller() -> None:
    assert math.isnan(one(lambda x: np.full_like(x, math.nan)))


@settings(deadline=None, max_examples=30)
@given(st.lists(st.floats(0.05, 3.0), min_size=1, max_size=6))
def test_the_running_integral_is_that_up_to_each_node(widths: list[float]) -> None:
    edges = np.cumsum([0.0, *widths])
    nodes, weights = panel_rule(edges)
    running = running_integral(np.cos(nodes), edges)
    np.testing.assert_allclose(running, np.sin(nodes), rtol=1e-12, atol=1e-13)
    assert float(np.sum(np.cos(nodes) * weights)) == pytest.approx(math.sin(edges[-1]), abs=1e-13)


@pytest.mark.parametrize("place", [0.123, 0.7])
def test_edges_are_added_where_a_function_bends(place: float) -> None:
    """Until Gauss's rule between them is right for the running integral, and not where it is smooth."""

    def bent(x: Floats) -> Floats:
        return np.maximum(x - place, 0.0) ** 0.5

    edges = refine_edges(bent, np.array([0.0, 0.5, 1.0]))
    nodes, weights = panel_rule(edges)
    assert float(np.sum(bent(nodes) * weights)) == pytest.approx((1.0 - place) ** 1.5 / 1.5, rel=1e-12)
    smooth = refine_edges(np.exp, np.array([0.0, 0.5, 1.0]))
    assert smooth.tolist() == [0.0, 0.5, 1.0]

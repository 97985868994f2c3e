"""Sums whose order depends on the terms alone: against sums without rounding."""

import math

import numpy as np
from hypothesis import given, settings, strategies as st

from roughmdr.numerics.summation import BLOCK, accumulate, block_minimum, cumulative_sum, sum_by_halves

EPS = np.finfo(float).eps
TERMS = st.lists(st.floats(-1.0, 1.0) | st.floats(-1e18, 1e18), max_size=60)


def compensated(terms: list[float]) -> float:
    total = compensation = 0.0
    for term in terms:
        total, compensation = accumulate(total, compensation, term)
    return total + compensation


def test_what_a_large_term_swallows_is_kept() -> None:
    """Whether the large term comes first or last, and whatever its sign."""
    for large in (1e100, -1e100):
        assert compensated([1.0, large, 1.0, -large]) == 2.0
        assert compensated([large, 1.0, 1.0, -large]) == 2.0
        assert compensated([1.0, 1.0, large, -large]) == 2.0


@settings(deadline=None)
@given(TERMS)
def test_a_compensated_sum_is_right_to_a_rounding(terms: list[float]) -> None:
    exact, sizes = math.fsum(terms), math.fsum(map(abs, terms))
    assert abs(compensated(terms) - exact) <= EPS * abs(exact) + (len(terms) * EPS) ** 2 * sizes


@settings(deadline=None)
@given(TERMS)
def test_a_running_sum_is_right_everywhere(terms: list[float]) -> None:
    running = np.array(terms)
    cumulative_sum(running)
    for i, value in enumerate(running.tolist()):
        exact, sizes = math.fsum(terms[: i + 1]), math.fsum(map(abs, terms[: i + 1]))
        assert abs(value - exact) <= EPS * abs(exact) + (len(terms) * EPS) ** 2 * sizes


@settings(deadline=None)
@given(st.lists(st.floats(-1e9, 1e9), min_size=1, max_size=BLOCK))
def test_a_block_has_its_sum_and_its_least_term(terms: list[float]) -> None:
    """Numbers behind the terms in the array have no part in the results, at any length."""
    count, rest = len(terms), [-1e30] * (BLOCK - len(terms))
    total = sum_by_halves(np.array(terms + rest), count, BLOCK)
    assert abs(total - math.fsum(terms)) <= 8.0 * EPS * math.fsum(map(abs, terms))
    assert block_minimum(np.array(terms + rest), count) == min(terms)


def test_the_sum_of_a_block_does_not_depend_on_its_size() -> None:
    """Blocks of fewer terms are summed in the same pairs, so that the bits are the same."""
    terms = np.random.default_rng(3).normal(size=BLOCK)
    for count in (1, 2, 3, 31, 32, 33, 128, 200):
        padded = np.concatenate([terms[:count], np.zeros(BLOCK - count)])
        assert sum_by_halves(terms.copy(), count, BLOCK) == sum_by_halves(padded, BLOCK, BLOCK)

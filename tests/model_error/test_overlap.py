"""Contacts that reach into a neighbour's: by positions, and the Poisson estimate."""

import math

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from roughmdr.model_error.interaction import overlap_share, poisson_overlap


def plain_share(x: np.ndarray, y: np.ndarray, radius: np.ndarray) -> float:
    """Every pair, one by one."""
    reached = [
        any(math.hypot(x[i] - x[j], y[i] - y[j]) < radius[i] + radius[j] for j in range(x.size) if j != i)
        for i in range(x.size)
    ]
    return sum(reached) / x.size


@settings(deadline=None, max_examples=50)
@given(st.integers(1, 60), st.floats(0.001, 0.05), st.sampled_from([1e-9, 1.0, 1e3]), st.integers(0, 2**31))
def test_the_share_by_positions_is_that_of_all_pairs(count: int, size: float, unit: float, seed: int) -> None:
    rng = np.random.default_rng(seed)
    x, y = rng.random((2, count)) * unit
    radius = rng.uniform(0.5, 1.0, count) * size * unit
    assert overlap_share(x, y, radius) == pytest.approx(plain_share(x, y, radius), abs=1e-12)


@pytest.mark.parametrize("spread", [0.0, 0.3, 1.0])
def test_contacts_placed_at_random_overlap_as_poisson_has_it(spread: float) -> None:
    rng = np.random.default_rng(1)
    x, y = rng.random((2, 40_000))
    radius = 7e-4 * np.exp(spread * rng.standard_normal(x.size))
    assert overlap_share(x, y, radius) == pytest.approx(poisson_overlap(radius, 1.0), abs=0.01)


def test_no_contacts_do_not_overlap_and_a_full_patch_does() -> None:
    assert poisson_overlap(np.full(1000, 1e-12), 1.0) == pytest.approx(0.0, abs=1e-15)
    assert poisson_overlap(np.full(100, 1e-6), 100.0 * math.pi * 1e-12) == pytest.approx(1.0 - math.exp(-4.0))
    lattice = np.arange(10.0)
    x, y = (part.ravel() for part in np.meshgrid(lattice, lattice))
    assert overlap_share(x, y, np.full(100, 0.49)) == 0.0
    assert overlap_share(x, y, np.full(100, 0.51)) == 1.0

"""The noise as residuals tell it: intervals of linear least squares hold the true values as often as stated."""

from itertools import product

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.stats import t

from roughmdr.fitting.uncertainty import by_residuals

DRAWS = 750
X = np.linspace(0.05, 1.0, 40)
SLOPES = {
    "line": np.stack([np.ones_like(X), X], axis=1),
    "power": np.stack([X**1.5, X**2.5], axis=1),
    "one deciding step": np.stack([X**1.5, np.where(np.arange(40) == 30, 4.0, 0.2 * X)], axis=1),
}
NOISES = {
    "even": np.ones(40),
    "proportional": X,
    "alternating": np.where(np.arange(40) % 2, 1.5, 0.5),
}


def drawn(slopes: NDArray[np.float64], noise: NDArray[np.float64]) -> tuple[NDArray[np.bool_], NDArray[np.float64]]:
    """Whether intervals hold the true values, and the standard errors, [draw, parameter]."""
    left, sizes, right = np.linalg.svd(slopes, full_matrices=False)
    inverse = right.T @ (left / sizes).T
    held, errors = [], []
    for seed in range(DRAWS):
        deviations = noise * np.random.default_rng(seed).standard_normal(noise.size)
        off = inverse @ deviations
        influence, freedom = by_residuals(inverse, left, deviations - slopes @ off)
        errors.append(np.linalg.norm(influence, axis=1))
        held.append(np.abs(off) <= t.ppf(0.975, freedom) * errors[-1])
    return np.array(held), np.array(errors)


@pytest.mark.few(1)
@pytest.mark.parametrize(
    ("kind", "noise"), [each for each in product(SLOPES, NOISES) if each != ("one deciding step", "alternating")]
)
def test_intervals_hold_true_values(kind: str, noise: str) -> None:
    """The noise of a single step that decides cannot be told where that of its neighbours is another."""
    held, _ = drawn(SLOPES[kind], NOISES[noise])
    share = 100.0 * held.mean(axis=0)
    assert share.min() > 91.0
    assert share.max() < 98.5


@pytest.mark.few(1)
@pytest.mark.parametrize("kind", SLOPES)
def test_standard_errors_are_those_of_even_noise(kind: str) -> None:
    slopes = SLOPES[kind]
    _, errors = drawn(slopes, NOISES["even"])
    exact = np.sqrt(np.diag(np.linalg.inv(slopes.T @ slopes)))
    assert np.sqrt(np.mean(np.square(errors), axis=0)) == pytest.approx(exact, rel=0.03)


@pytest.mark.parametrize("points", [3, 4, 5, 9])
def test_few_points_and_exact_ones(points: int) -> None:
    """A line through few points; exact points leave no error, and a finite number of degrees of freedom."""
    slopes = np.stack([np.ones(points), np.arange(points)], axis=1)
    left, sizes, right = np.linalg.svd(slopes, full_matrices=False)
    inverse = right.T @ (left / sizes).T
    influence, freedom = by_residuals(inverse, left, np.zeros(points))
    assert not influence.any()
    assert (freedom >= 1.0).all()
    assert (freedom <= points - 2 + 1e-9).all()


@pytest.mark.parametrize("scale", [1e-150, 1e100])
def test_standard_errors_grow_with_the_noise(scale: float) -> None:
    left, sizes, right = np.linalg.svd(SLOPES["line"], full_matrices=False)
    inverse, residuals = right.T @ (left / sizes).T, np.cos(7.0 * np.arange(40))
    larger, one = (by_residuals(inverse, left, each * residuals) for each in (scale, 1.0))
    assert larger[0] == pytest.approx(scale * one[0], rel=1e-12)
    assert larger[1] == pytest.approx(one[1], rel=1e-12)

"""Means over the realisations of a result that holds the curves."""

import math

import numpy as np
import pytest

from roughmdr.result.means import holds, mean_of
from roughmdr.storage.labelled import Array, Labelled
from roughmdr.variables import DONE, FAILED

FORCE = np.array(
    [[[1.0, 2.0], [3.0, math.nan], [8.0, 9.0]], [[1.0, 4.0], [math.nan, math.nan], [3.0, 8.0]]]
)  # [cell, realisation, step]
PULL_OFF = np.array([[-1.0, -3.0, math.nan], [-2.0, math.nan, math.nan]])
STATUS = np.array([[DONE, DONE, DONE], [DONE, FAILED, DONE]])
RESULT = Labelled(
    {
        "force": Array(("work", "realization", "step"), FORCE, {}),
        "pull_off_force": Array(("work", "realization"), PULL_OFF, {}),
        "status": Array(("work", "realization"), STATUS, {}),
    },
    {},
    {},
)


def test_of_curves_those_of_the_runs_that_were_computed_count() -> None:
    """A step at which one of them has no value has no mean, since the others do not stand for it."""
    mean, error = mean_of(RESULT, "force")
    np.testing.assert_array_equal(mean, [[4.0, math.nan], [2.0, 6.0]])
    expected = [[np.std([1.0, 3.0, 8.0], ddof=1) / math.sqrt(3.0), math.nan], [1.0, 2.0]]
    np.testing.assert_allclose(error, expected, rtol=1e-14)


def test_of_pull_offs_those_that_there_are_count() -> None:
    mean, error = mean_of(RESULT, "pull_off_force")
    assert mean.tolist() == [-2.0, -2.0]
    assert error[0] == pytest.approx(1.0)
    assert math.isnan(error[1])


def test_statistics_are_their_own_means() -> None:
    stored = {f"force_{name}": Array(("step",), np.array([value]), {}) for name, value in (("mean", 5.0), ("sem", 0.5))}
    result = Labelled(stored, {}, {})
    assert mean_of(result, "force") == (5.0, 0.5)
    assert holds(result, "force")
    assert holds(RESULT, "pull_off_force")
    assert not holds(result, "pull_off_force")

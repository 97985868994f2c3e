"""A result read from its arrays and from a Dataset: means over its realisations, its cells, legs and curves."""

import math

import numpy as np
import pytest
from scenes import scene

import roughmdr as rm
from roughmdr.result.view import ResultView
from roughmdr.storage.labelled import Array, Labelled
from roughmdr.variables import DONE, FAILED

FORCE = np.array(
    [[[1.0, 2.0], [3.0, math.nan], [8.0, 9.0]], [[1.0, 4.0], [math.nan, math.nan], [3.0, 8.0]]]
)  # [cell, realisation, step]
PULL_OFF = np.array([[-1.0, -3.0, math.nan], [-2.0, math.nan, math.nan]])
STATUS = np.array([[DONE, DONE, DONE], [DONE, FAILED, DONE]])
RESULT = ResultView(
    Labelled(
        {
            "force": Array(("work", "realization", "step"), FORCE, {}),
            "pull_off_force": Array(("work", "realization"), PULL_OFF, {}),
            "status": Array(("work", "realization"), STATUS, {}),
        },
        {},
        {},
    )
)


def test_of_curves_those_of_the_runs_that_were_computed_count() -> None:
    """A step at which one of them has no value has no mean, since the others do not stand for it."""
    mean, error = RESULT.mean("force")
    np.testing.assert_array_equal(mean, [[4.0, math.nan], [2.0, 6.0]])
    expected = [[np.std([1.0, 3.0, 8.0], ddof=1) / math.sqrt(3.0), math.nan], [1.0, 2.0]]
    np.testing.assert_allclose(error, expected, rtol=1e-14)


def test_of_pull_offs_those_that_there_are_count() -> None:
    mean, error = RESULT.mean("pull_off_force")
    assert mean.tolist() == [-2.0, -2.0]
    assert error[0] == pytest.approx(1.0)
    assert math.isnan(error[1])


def test_statistics_are_their_own_means() -> None:
    stored = {f"force_{name}": Array(("step",), np.array([value]), {}) for name, value in (("mean", 5.0), ("sem", 0.5))}
    result = ResultView(Labelled(stored, {}, {}))
    assert result.mean("force") == (5.0, 0.5)
    assert result.holds("force")
    assert RESULT.holds("pull_off_force")
    assert not result.holds("pull_off_force")


@pytest.mark.few(1)
@pytest.mark.parametrize("keep", ["curves", "statistics"])
@pytest.mark.parametrize("path", [{"separation": ["3 um", "1 um", "3 um", "2 um"]}, {"preload": "1 mN", "steps": 4}])
def test_arrays_a_dataset_and_one_in_chunks_are_read_alike(keep: str, path: dict[str, object]) -> None:
    sweep = {"mode": "product", "adhesion.work": ["20 mJ/m^2", "50 mJ/m^2"], "asperities.radius": ["20 um", "50 um"]}
    found = rm.run(scene(path=path, sweep=sweep, output={"keep": keep}, batch={"realizations": 3}))
    views = [
        ResultView(Labelled.of(found)),
        ResultView(found),
        ResultView(found.chunk({"adhesion_work": 1, "step": 2})),
    ]
    for name in ("control", "abscissa", "sweep", "cells", "curves", "keeps_statistics", "keeps_runs", "realizations"):
        assert len({repr(getattr(view, name)) for view in views}) == 1, name
    for view in views:
        assert view.label((1, 0)) == "adhesion_work = 50 mJ/m^2, asperities_radius = 20 um"
        np.testing.assert_array_equal(view.path, views[0].path)
        np.testing.assert_array_equal(view.mean("force"), views[0].mean("force"))
        assert [leg.branch for leg in view.legs] == [leg.branch for leg in views[0].legs]
    assert views[0].estimator == "sampled"
    np.testing.assert_array_equal(np.concatenate([leg.steps for leg in views[1].legs]), np.arange(found.sizes["step"]))


def test_a_part_of_a_result_without_status_is_read() -> None:
    """A sweep whose separations differ from cell to cell, of which a user keeps some variables only."""
    path = {"separation": {"start": "3 sigma", "stop": "1 sigma", "steps": 20}}
    found = rm.run(scene(path=path, sweep={"asperities.height.std": ["1 um", "2 um"]}, batch={"realizations": 2}))
    part = found[["force", "contact_area"]]
    for each in (part, found.drop_vars("status")):
        assert ResultView(each).sweep == {"asperities_height_std": 2}
        law = each.roughmdr.fit_power_law("contact_area", "force")
        np.testing.assert_array_equal(law.exponent, found.roughmdr.fit_power_law("contact_area", "force").exponent)

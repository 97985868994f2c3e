"""``numerical_error`` and the true error of random scenes, from references that are ten times finer."""

from pathlib import Path

import pytest
import xarray as xr
from forms import COMPILED, large
from studies import stated_error as study
from studies.stated_error import STUDY, report
from studies.stated_error.scenes import ESTIMATORS, RandomScene, scene

DEAR = 9
"""Number of a scene with adhesion of finite range, whose reference takes seconds."""
ONE_OF_EACH = (0, 11, DEAR, 10)  # expected, sampled with JKR's and with adhesion of finite range, stratified


def judge_random_scenes(drawn: list[RandomScene]) -> None:
    """Check that the stated error is a bound in all scenes, of which none is refused."""
    result = study.as_dataset(drawn, [study.judge(one) for one in drawn])
    assert result.attrs["refused"] == 0
    assert result.honest.all(), report(result)
    assert set(result.estimator.to_numpy()) == set(ESTIMATORS)
    ordinary = result.stated_error.groupby(result.estimator).median()
    assert (ordinary < 1e-10).all(), "the bound is useless"


def test_the_stated_error_is_honest() -> None:
    judge_random_scenes([one for one in map(scene, range(16)) if one.shape in COMPILED and one.number != DEAR])


@pytest.mark.large
def test_the_stated_error_of_many_scenes_is_honest() -> None:
    judge_random_scenes([scene(number) for number in range(study.SCENES // 3)])


@pytest.mark.large
def test_the_study_is_carried_out(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """By two processes, into files."""
    monkeypatch.setattr(study, "QUICK", 12)
    told = STUDY.carry_out(tmp_path, quick=True)
    assert "in 100.0 % of 12 random scenes" in told
    with xr.open_dataset(tmp_path / "stated_error.nc") as result:
        assert result.sizes["scene"] == 12
        assert result.honest.all()


@pytest.mark.parametrize("number", [large(number) if number == DEAR else number for number in ONE_OF_EACH])
def test_the_judge_finds_forces_that_are_off_by_a_few_stated_errors(number: int) -> None:
    assert study.judge(scene(number)).honest
    assert not study.judge(scene(number), disturbance=3.0).honest
    assert not study.judge(scene(number), disturbance=-3.0).honest


@pytest.mark.large
def test_orders_that_agree_by_chance_are_not_accepted() -> None:
    """Some punches of many radii have detached: there are kinks over the radii."""
    assert study.judge(scene(44)).honest


@pytest.mark.large
def test_a_force_that_almost_jumps_has_a_reference() -> None:
    """For some radii two folds nearly divide the branch."""
    assert study.judge(scene(188)).honest


def test_scenes_beyond_their_bound_are_listed() -> None:
    drawn = [scene(number) for number in range(4)]
    judged = [study.Judged(1e-15, 1e-13), study.Judged(1e-12, 1e-13), study.Judged(0.0, 0.0), study.Judged(0, 0, "no")]
    told = report(study.as_dataset(drawn, judged))
    assert "in 66.7 % of 3 random scenes" in told
    assert "1 more were refused" in told
    assert "scene 1:" in told
    assert "scene 0:" not in told

"""The study of the pull-off of coupled asperities in its short form."""

from collections.abc import Iterator

import numpy as np
import pytest
from carried_out import CarriedOut, carried_out
from coupled_pull_off import STUDY
from studies.coupled_pull_off.measure import LONE, PAIRWISE, Sample, cycle
from studies.coupled_pull_off.report import groups


@pytest.fixture(scope="module")
def studied(tmp_path_factory: pytest.TempPathFactory) -> Iterator[CarriedOut]:
    with carried_out(STUDY, tmp_path_factory.mktemp("coupled_pull_off")) as made:
        yield made


def test_it_writes_its_numbers_and_a_picture(studied: CarriedOut) -> None:
    assert sorted(path.name for path in studied.folder.iterdir()) == ["coupled_pull_off.nc", "coupled_pull_off.png"]
    assert (studied.folder / "coupled_pull_off.png").stat().st_size > 20_000
    assert all(np.isfinite(studied.result[name]).all() for name in studied.result)
    assert "change" in studied.text


def test_far_apart_they_are_nearly_independent(studied: CarriedOut) -> None:
    """And nearer the farther apart they are; no tension is larger than that of all lone ones together."""
    for spread in np.unique(studied.result["spread"]):
        own = [group for group in groups(studied.result, of_number=False) if group.spread == spread]
        changes = [abs(group.change[0]) for group in sorted(own, key=lambda group: group.spacing)]
        assert changes[-1] <= max(changes[0], 0.1)
        assert changes[-1] < 5.0
    assert (studied.result["coupled"] < 1.0).all()


def test_the_pull_off_force_does_not_depend_on_the_steps() -> None:
    ensemble = Sample(25, 8.0, 0.3, 3).generate()
    few, many = (cycle(ensemble, 0.3, PAIRWISE, steps)[0] for steps in (10, 41))
    assert float(few["pull_off_force"]) == pytest.approx(float(many["pull_off_force"]), rel=1e-6)
    assert float(few["dissipated_energy"][-1]) == pytest.approx(float(many["dissipated_energy"][-1]), rel=1e-9)


def test_one_alone_pulls_off_by_the_force_of_jkr() -> None:
    ensemble = Sample(1, 200.0, 0.3, 0).generate()
    alone, _ = cycle(ensemble, 0.3, None)
    assert -float(alone["pull_off_force"]) == pytest.approx(LONE, rel=1e-9)

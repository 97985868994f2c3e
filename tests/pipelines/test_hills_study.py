"""The study of hills: its maps, and what it finds in its quick form."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from carried_out import CarriedOut, carried_out
from hills import STUDY
from studies.hills.maps import MapCase
from studies.hills.measure import METHODS
from studies.hills.report import errors_of, groups, rms


@pytest.fixture(scope="module")
def studied(tmp_path_factory: pytest.TempPathFactory) -> Iterator[CarriedOut]:
    with carried_out(STUDY, tmp_path_factory.mktemp("hills")) as made:
        yield made


def test_a_map_is_the_same_on_every_grid() -> None:
    case = MapCase(0.5, 8, 3)
    np.testing.assert_allclose(case.height(8)[::2, ::2], case.height(4), atol=1e-12 * case.height(4).max())


def test_hills_are_better_than_summits(studied: CarriedOut) -> None:
    for own in groups(studied.result).values():
        errors = errors_of(own)
        assert rms(errors.sel(solver="hills").to_numpy()) < 0.7 * rms(errors.sel(solver="summits in pairs").to_numpy())


def test_it_reports_each_method_and_draws(studied: CarriedOut) -> None:
    for method in METHODS:
        assert f"| {method} |" in studied.text
    assert (Path(studied.folder) / "hills.png").stat().st_size > 5000

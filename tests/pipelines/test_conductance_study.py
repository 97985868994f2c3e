"""The study of conductance in its quick form."""

from collections.abc import Iterator

import numpy as np
import pytest
from carried_out import CarriedOut, carried_out
from studies.conductance import STUDY, bounded, errors


@pytest.fixture(scope="module")
def studied(tmp_path_factory: pytest.TempPathFactory) -> Iterator[CarriedOut]:
    with carried_out(STUDY, tmp_path_factory.mktemp("conductance")) as made:
        yield made


@pytest.mark.large
def test_pairs_are_better_than_independent_asperities(studied: CarriedOut) -> None:
    """Where the grid of the quick form resolves the contacts."""
    for group in ("random", "separated"):
        own = abs(errors(studied.result)).isel(
            case=np.flatnonzero(studied.result["group"] == group), step=slice(3, None)
        )
        pairs, independent = (own.sel(model=model).mean() for model in ("order 2", "independent"))
        assert float(pairs) < 0.1 * float(independent)


@pytest.mark.large
def test_the_stated_error_holds(studied: CarriedOut) -> None:
    for under_load in (False, True):
        assert float(bounded(studied.result, under_load).mean()) >= 0.85


def test_it_is_told_and_drawn(studied: CarriedOut) -> None:
    assert "| separated | order 2 | separation |" in studied.text
    assert (studied.folder / "conductance.png").stat().st_size > 0

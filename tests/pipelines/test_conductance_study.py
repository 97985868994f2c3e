"""The study of conductance in its quick form."""

from pathlib import Path

import numpy as np
import pytest
from carried_out import CarriedOut, carried_out
from studies import conductance
from studies.conductance import STUDY, bounded, errors

STUDIED = "conductance"


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
    assert float(bounded(studied.result).mean()) >= 0.85


@pytest.mark.large
def test_it_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """With one of its cases."""
    monkeypatch.setattr(conductance, "QUICK", conductance.QUICK[1:2])
    with carried_out(STUDY, tmp_path) as made:
        assert "| separated | order 2 | separation |" in made.text

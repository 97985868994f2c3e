"""The study of spectra: hills of maps are nearest to boundary elements, and it reports and draws all sources."""

from pathlib import Path

import numpy as np
import pytest
from carried_out import CarriedOut
from studies.spectrum import METHODS, means

STUDIED = "spectrum"


@pytest.mark.large
def test_hills_are_nearest(studied: CarriedOut) -> None:
    off = np.abs(means(studied.result)[0])
    assert float(off.sel(solver="hills in pairs").max()) < 0.06
    for other in ("nayak", "summits in pairs"):
        assert float(off.sel(solver="hills in pairs").mean()) < 0.5 * float(off.sel(solver=other).mean())


@pytest.mark.large
def test_differences_on_the_same_maps_have_small_errors(studied: CarriedOut) -> None:
    error = means(studied.result)[1]
    assert float(error.sel(solver="hills in pairs").max()) < 0.3 * float(error.sel(solver="nayak").min())
    assert np.isfinite(error.sel(solver=list(METHODS[:-1]))).all()


@pytest.mark.large
def test_it_reports_each_source_and_draws(studied: CarriedOut) -> None:
    for method in METHODS[:-1]:
        assert f"| {method} |" in studied.text
    assert "![spectrum](spectrum.png)" in studied.text
    assert (Path(studied.folder) / "spectrum.png").stat().st_size > 5000

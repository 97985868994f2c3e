"""The study of errors at given pressure."""

import numpy as np
import pytest
import xarray as xr
from carried_out import CarriedOut

STUDIED = "at_pressure"


@pytest.mark.large
def test_the_stated_errors_bound_most_of_the_true_ones(studied: CarriedOut, result: xr.Dataset) -> None:
    assert {"asperities", "cut summits", "cut hills", "adhesive asperities"} == set(result["group"].values.tolist())
    assert all(f"| {name} at given pressure |" in studied.text for name in ("contact_fraction", "stiffness"))
    error, stated, unknown = (result[name].to_numpy() for name in ("error", "stated", "unknown"))
    known = np.isfinite(error) & np.isfinite(stated)
    assert known.sum() > 400
    assert np.mean(np.abs(error[known]) <= np.maximum(stated[known], unknown[known])) > 0.9

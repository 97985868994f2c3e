"""The study of quantities that are asked for, in its reduced form."""

import numpy as np
import pytest
from studies.asked import STUDY


@pytest.mark.large
def test_requests_are_met_as_far_as_the_truth_is_known() -> None:
    result = STUDY.measure(True)
    off = np.abs(result["error"]) - 2.0 * result["unknown"]
    assert (off <= result["reached"]).all()
    assert (result["reached"] <= 1.0).all()
    assert (result["realizations"] >= 4.0).all()
    text = STUDY.report(result)
    assert "3 requests; 3 stated that they were met" in text

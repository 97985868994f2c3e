"""Summits that yield beside saturated boundary elements."""

from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from carried_out import carried_out
from studies.versus_saturated import COMMAND, SOLVERS, STUDY


def test_the_study_says_that_tamaas_is_not_there(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.delenv(COMMAND, raising=False)
    with carried_out(STUDY, tmp_path) as studied:
        assert f"the environment variable {COMMAND} holds no command" in studied.text
        assert studied.result.sizes["case"] == 0


def test_areas_are_told_over_those_of_saturated_elements() -> None:
    area = np.array([0.1, 0.1, 0.11, 0.09, 0.04, 0.05])[:, None] * np.array([[[0.05]], [[1.0]]])
    over, slope = ("case", "solver", "pressure"), ("case", [1.0, 3.0])
    text = STUDY.report(
        xr.Dataset({"area": (over, area)}, {"solver": list(SOLVERS), "slope": slope, "pressure": [0.1]})
    )
    for row in ("all", "1.0", "3.0"):
        cells = (f"{off} % ({off} to {off})" for off in ("+0", "+10", "-10", "-60", "-50", "-20"))
        assert f"| {row} | {' | '.join(cells)} |" in text

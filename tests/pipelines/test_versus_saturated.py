"""Contacts that yield beside saturated boundary elements."""

import math
from pathlib import Path

import numpy as np
import pytest
from carried_out import carried_out
from studies.versus_saturated import COMMAND, STUDY, SaturatedElements

from roughmdr.elements.half_space import BoundaryElements


def cosines(count: int) -> np.ndarray:
    x = 2.0 * np.pi * (np.arange(count) + 0.5) / count
    return np.asarray(1e-3 * (np.cos(x)[:, None] + np.cos(x) - 2.0))


def test_elements_as_hard_as_can_be_are_elastic() -> None:
    height = cosines(48)
    hard, elastic = SaturatedElements(height, math.inf), BoundaryElements(height, np.ones(2))
    for h in (-4e-4, -8e-4):
        assert hard.press(h) == pytest.approx(elastic.press(h), rel=1e-4)


def test_where_all_flows_the_load_is_the_hardness_times_the_area() -> None:
    """The elements that flow are those above the flat, as little displaces them."""
    height, most = cosines(48), 1e-6
    soft = SaturatedElements(height, most)
    assert soft.press(-1e-3) == pytest.approx(most * np.mean(height > -1e-3), rel=0.02)
    assert soft.area() == pytest.approx(np.mean(height > -1e-3), rel=0.02)


def test_no_pressure_is_above_the_hardness_and_gaps_go_with_pressures() -> None:
    soft = SaturatedElements(cosines(48), 2e-3)
    soft.press(-6e-4)
    gap, flows = soft.displacement() - soft.height - 6e-4, soft.pressure == soft.most
    assert soft.pressure.max() == soft.most
    assert gap[flows].max() < 1e-8
    assert gap[~flows].min() > -1e-8
    assert np.abs(gap[(soft.pressure > 0.0) & ~flows]).max() < 1e-8


@pytest.mark.large
def test_the_study_tells_stated_errors_and_whether_tamaas_is_there(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.delenv(COMMAND, raising=False)
    with carried_out(STUDY, tmp_path) as studied:
        assert f"No {COMMAND} is set" in studied.text
        assert "| summits, mdr | contact_fraction at given pressure |" in studied.text

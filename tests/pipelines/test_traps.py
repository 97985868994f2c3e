"""Scenes with the mistakes that users make: none ends well without contact on its patch and a line on trust."""

from pathlib import Path

import pytest
import xarray as xr
from studies.traps import KINDS, STUDY, measure, report, traps, violations


def test_every_kind_of_mistake_is_made_and_the_scenes_are_always_the_same() -> None:
    made = list(traps(60))
    assert {trap.kind for trap in made} == set(KINDS)
    assert made == list(traps(60))


@pytest.mark.large
def test_no_trap_ends_well_with_more_contact_than_patch_or_without_a_line_on_trust(tmp_path: Path) -> None:
    text = STUDY.carry_out(tmp_path, quick=True)
    with xr.open_dataset(tmp_path / "traps.nc") as found:
        assert violations(found) == (0, 0)
        assert {"refused", "done"} <= set(found.outcome.values.tolist())
        assert (found.model_error.where(found.exit_status == 0, drop=True) <= 1.0).all()
    assert "0 without a line on trust" in text


@pytest.mark.large
def test_no_trap_of_300_does() -> None:
    found = measure(quick=False)
    assert violations(found) == (0, 0), report(found)

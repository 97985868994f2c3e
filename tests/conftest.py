"""What the tests of disturbed batches have in common: the undisturbed ones, and a folder to work in."""

from pathlib import Path

import pytest
import xarray as xr
from batches import CURVES, STATISTICS, write_scene

import roughmdr as rm


@pytest.fixture(scope="module")
def curves() -> xr.Dataset:
    return rm.run(CURVES)


@pytest.fixture(scope="module")
def statistics() -> xr.Dataset:
    return rm.run(STATISTICS)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    write_scene(tmp_path / "batch", CURVES)
    return tmp_path / "batch"

"""What the tests of disturbed batches have in common: the undisturbed ones, and a folder to work in."""

import signal
from pathlib import Path

import pytest
import xarray as xr
from batches import CURVES, STATISTICS, write_scene

import roughmdr as rm


def pytest_configure() -> None:
    """Let tests interrupt what they start, also where they run in the background of a shell, which ignores SIGINT."""
    signal.signal(signal.SIGINT, signal.default_int_handler)


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

"""The file: written whole or not at all, and read back as it was."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import netCDF4
import pytest
import tomli_w
import xarray as xr
from forms import large
from scenes import ASPERITIES, scene

import roughmdr as rm
from roughmdr.batch.plan import make_plan
from roughmdr.runner.backend import Backend
from roughmdr.runner.run import execute
from roughmdr.scene import read as read_scene
from roughmdr.storage.files import replace_atomically
from roughmdr.storage.labelled import Labelled
from roughmdr.storage.result_file import read_result
from roughmdr.storage.result_form import statistics_of
from roughmdr.storage.result_validation import as_result
from roughmdr.variables import LAW_VARIABLES


@pytest.fixture
def result(tmp_path: Path) -> xr.Dataset:
    return rm.run(scene(), tmp_path / "out.nc")


def test_it_comes_back_as_it_was(result: xr.Dataset, tmp_path: Path) -> None:
    assert read_result(tmp_path / "out.nc").to_xarray().identical(result)
    with xr.open_dataset(tmp_path / "out.nc", mask_and_scale=False) as opened:
        assert opened.equals(result)
    assert [path.name for path in tmp_path.iterdir()] == ["out.nc"]


def test_it_is_one_flat_netcdf_4_file(result: xr.Dataset, tmp_path: Path) -> None:
    with netCDF4.Dataset(tmp_path / "out.nc") as file:
        assert file.data_model == "NETCDF4"
        assert not file.groups
        assert file["force"].dimensions == ("realization", "step")
        assert file["status"].flag_meanings == "done failed not_run"
        assert "_FillValue" not in file["separation"].ncattrs()


@pytest.mark.large
def test_an_old_file_is_replaced(result: xr.Dataset, tmp_path: Path) -> None:
    with pytest.raises(rm.StoreError, match="seed was 7, is 8: give another output, or --fresh"):
        rm.run(scene(seed=8), tmp_path / "out.nc")
    again = rm.run(scene(seed=8), tmp_path / "out.nc", resume=False)
    assert read_result(tmp_path / "out.nc").to_xarray().force.equals(again.force)
    assert not again.force.equals(result.force)


@pytest.mark.parametrize("target", ["folder", "none/out.nc"])
def test_an_output_that_cannot_be_written_is_found_before_computing(tmp_path: Path, target: str) -> None:
    (tmp_path / "folder").mkdir()
    endless = scene(asperities={**ASPERITIES, "count": 1_000_000_000}, batch={"realizations": 1_000_000})
    with pytest.raises(rm.StoreError, match=str(tmp_path / target)):
        execute(make_plan(read_scene(endless)), tmp_path / target, Backend(runs_per_task=1_000_000))


def test_a_failure_while_writing_leaves_the_old_file_and_no_other(tmp_path: Path) -> None:
    target = tmp_path / "out.nc"
    target.write_text("old")

    def interrupted() -> None:
        with replace_atomically(target) as temporary:
            temporary.write_text("half")
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert target.read_text() == "old"
    assert [path.name for path in tmp_path.iterdir()] == ["out.nc"]


def test_a_disk_error_is_a_store_error(tmp_path: Path) -> None:
    with pytest.raises(rm.StoreError, match="cannot be written"), replace_atomically(tmp_path / "out.nc"):
        raise OSError(28, "No space left on device")


def test_what_is_no_result_is_refused(tmp_path: Path) -> None:
    with pytest.raises(rm.StoreError, match="no such file"):
        read_result(tmp_path / "none.nc")
    (tmp_path / "text.nc").write_text("text")
    with pytest.raises(rm.StoreError, match="not a netCDF file"):
        read_result(tmp_path / "text.nc")
    xr.Dataset({"a": ("x", [1.0])}).to_netcdf(tmp_path / "other.nc")
    with pytest.raises(rm.StoreError, match="not a result as roughmdr writes it"):
        read_result(tmp_path / "other.nc")


@pytest.mark.large
def test_statistics_of_which_one_is_left_are_refused(statistics: xr.Dataset) -> None:
    groups = [[each for each in statistics_of(name) if each in statistics] for name in LAW_VARIABLES]
    for here in filter(None, groups):
        for kept in here:
            with pytest.raises(rm.StoreError, match=f"it has {kept} but no"):
                as_result(Labelled.of(statistics.drop_vars(set(here) - {kept})))


def test_runs_have_no_steps(statistics: xr.Dataset) -> None:
    status = statistics.status.expand_dims(step=statistics.sizes["step"])
    with pytest.raises(rm.StoreError, match="status has the dimensions step"):
        as_result(Labelled.of(statistics.assign(status=status)))


_ENDLESS = """
import sys, roughmdr as rm
sys.path.insert(0, {tests!r})
from scenes import ASPERITIES, scene
while True:
    rm.run(scene(), {target!r})
    print("written", flush=True)
"""


@pytest.mark.large
@pytest.mark.parametrize("pause", [*map(large, [0.0, 0.011, 0.037, 0.053]), 0.023])
def test_a_killed_run_leaves_a_whole_file_or_none(tmp_path: Path, pause: float) -> None:
    """Killed at once, at some moment of the second or third writing; what bears the name must be whole."""
    target = tmp_path / "out.nc"
    code = _ENDLESS.format(tests=str(Path(__file__).parent.parent), target=str(target))
    with subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE) as process:
        assert process.stdout is not None
        process.stdout.readline()
        time.sleep(pause)
        os.kill(process.pid, signal.SIGKILL)
    assert read_result(target).to_xarray().force.equals(rm.run(scene()).force)


def test_only_an_ordinary_file_that_is_no_input_is_replaced(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(rm.StoreError, match="not a regular file"):
        rm.run(scene(), tmp_path / "pipe")
    (tmp_path / "scene.toml").write_text(tomli_w.dumps(scene()))
    with pytest.raises(rm.StoreError, match="is an input"):
        rm.run(tmp_path / "scene.toml", tmp_path / "scene.toml")
    assert (tmp_path / "pipe").is_fifo()
    assert sorted(path.name for path in tmp_path.iterdir()) == ["pipe", "scene.toml"]


@pytest.mark.large
def test_a_full_disk_is_a_store_error(tmp_path: Path) -> None:
    code = (
        "import resource, signal, sys; signal.signal(signal.SIGXFSZ, signal.SIG_IGN)\n"
        "resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, 20_000))\n"
        "from roughmdr.cli import main; main()"
    )
    (tmp_path / "scene.toml").write_text(tomli_w.dumps(scene()))
    done = subprocess.run(
        [sys.executable, "-c", code, "run", "scene.toml", "-o", "out.nc"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 2, done.stderr
    assert "out.nc: cannot be written" in done.stderr
    assert "Traceback" not in done.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["scene.toml"]

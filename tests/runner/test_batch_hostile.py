"""Batches under hostile treatment: nothing is lost, mixed up or taken for something else."""

import errno
import json
import multiprocessing
import os
import subprocess
import sys
import threading
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tomli_w
import xarray as xr
from batches import assert_same, interrupted
from scenes import ASPERITIES, scene
from test_cli import roughmdr

import roughmdr as rm
from roughmdr.batch.moments import Moments
from roughmdr.batch.plan import make_plan
from roughmdr.batch.resume.store import store_folder
from roughmdr.runner.backend import Backend
from roughmdr.runner.run import execute
from roughmdr.scene import read
from roughmdr.storage.result_file import read_result

FEW = {**ASPERITIES, "count": 20}
PATH = {"separation": {"start": "3 um", "stop": "0 um", "steps": 6}, "unload": True}


def few(realizations: int = 60, **changes: Any) -> dict[str, Any]:
    return scene(**{"asperities": FEW, "path": PATH, "batch": {"realizations": realizations}} | changes)


def forces(table: dict[str, Any], runs_per_task: int = 1) -> np.ndarray:
    found: np.ndarray = (
        execute(make_plan(read(table)), None, Backend(runs_per_task=runs_per_task)).variables["force_mean"].values
    )
    return found


def test_batches_in_threads_of_one_process_do_not_mix(tmp_path: Path) -> None:
    """No signal can be caught there, and none needs to be."""
    tables = [few(12, seed=seed, output={"keep": "statistics"}) for seed in range(4)]
    found: dict[int, xr.Dataset] = {}

    def work(number: int) -> None:
        out = tmp_path / f"{number}.nc"
        found[number] = execute(make_plan(read(tables[number])), out, Backend(runs_per_task=3)).to_xarray()

    threads = [threading.Thread(target=work, args=(number,)) for number in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert sorted(path.name for path in tmp_path.iterdir()) == [f"{number}.nc" for number in range(4)]
    for number, table in enumerate(tables):
        assert_same(found[number], rm.run(table))


_FORKED = """
import os, sys
sys.path[:0] = {tests!r}
from test_batch_hostile import few, forces
before = forces(few(output={{"keep": "statistics"}}))
child = os.fork()
if not child:
    same = (forces(few(output={{"keep": "statistics"}})) == before).all()
    os._exit(0 if same else 1)
print(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))
"""


@pytest.mark.large
@pytest.mark.skipif(not hasattr(os, "fork"), reason="there is no fork here")
def test_a_forked_process_computes_too() -> None:
    code = _FORKED.format(tests=[str(folder) for folder in Path(__file__).parents[:2]])
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=120, check=False)
    assert done.stdout.strip() == "0", done.stderr


@pytest.mark.large
def test_a_process_that_may_have_no_children_says_so() -> None:
    with multiprocessing.get_context("spawn").Pool(1) as pool, pytest.raises(rm.RoughmdrError, match="daemonic"):
        pool.apply(rm.run, (few(),), {"scheduler": "processes"})


def saved(path: Path, seed: int) -> None:
    """An ensemble whose file has the same size and the same age, whatever is in it."""
    rm.generate(FEW, seed=seed).to_netcdf(path)
    os.utime(path, ns=(10**18, 10**18))


def test_a_file_that_looks_the_same_is_read_again(tmp_path: Path) -> None:
    asperities = {"source": "file", "file": str(tmp_path / "ensemble.nc")}
    table = scene(asperities=asperities, batch=None, path=PATH)
    saved(tmp_path / "ensemble.nc", 1)
    held = read(table)
    first = rm.run(held, tmp_path / "out.nc")
    saved(tmp_path / "ensemble.nc", 2)
    other = rm.run(table)
    assert other.cell_key != first.cell_key
    assert not other.force.equals(first.force)
    assert rm.run(held).cell_key == first.cell_key  # a scene that was read holds what was in the file then
    with pytest.raises(rm.StoreError, match="a file that it reads holds something else"):
        rm.run(table, tmp_path / "out.nc")


@pytest.mark.large
def test_no_force_yet_is_no_small_error() -> None:
    """A summit that few realisations have: sixteen without it tell nothing of the mean."""
    rare = few(asperities={**FEW, "count": 1}, path={"separation": ["3 um", "2.6 um"]}, batch=None, adhesion=None)
    found = rm.run({**rare, "accuracy": {"relative": 0.2, "method": "sampled", "max_realizations": 20_000}})
    assert (found.force.max("step") > 0.0).sum() > 10
    assert float(found.accuracy_reached) <= 0.2
    never = rm.run(
        {
            **rare,
            "path": {"separation": ["30 um", "20 um"]},
            "accuracy": {"relative": 0.2, "method": "sampled", "max_realizations": 40},
        }
    )
    assert int(never.realization_count) == 40
    assert np.isnan(never.accuracy_reached)
    assert "none of 40 realisations had any force" in never.attrs["warnings"]


def test_a_cluster_that_is_not_there_costs_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    out = tmp_path / "out.nc"
    interrupted(few(), out, 3, monkeypatch, runs_per_task=5)
    before = sorted(path.name for path in store_folder(out).iterdir())
    with pytest.raises(rm.RoughmdrError, match="no dask scheduler answers"):
        rm.run(few(), out, scheduler="tcp://127.0.0.1:1", resume=False)
    assert sorted(path.name for path in store_folder(out).iterdir()) == before


@pytest.mark.large
def test_parts_on_another_disk(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    elsewhere = Path("/dev/shm") / f"roughmdr-{os.getpid()}"
    if not elsewhere.parent.is_dir() or elsewhere.parent.stat().st_dev == tmp_path.stat().st_dev:
        pytest.skip("there is no other disk here")
    elsewhere.mkdir()
    try:
        store_folder(tmp_path / "out.nc").symlink_to(elsewhere)
        xr.testing.assert_equal(rm.run(few(), tmp_path / "out.nc").force, rm.run(few()).force)
    finally:
        for path in elsewhere.iterdir():
            path.unlink()
        elsewhere.rmdir()


@pytest.mark.large
def test_a_disk_without_locks_will_do(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    import fcntl

    def no_locks(*_: object) -> None:
        raise OSError(errno.ENOSYS, "Function not implemented")

    monkeypatch.setattr(fcntl, "flock", no_locks)
    xr.testing.assert_equal(rm.run(few(), tmp_path / "out.nc").force, rm.run(few()).force)
    assert [path.name for path in tmp_path.iterdir()] == ["out.nc"]


@pytest.mark.parametrize("name", ["lock", "manifest.jsonl"])
def test_links_in_the_parts_are_not_followed(name: str, tmp_path: Path) -> None:
    (tmp_path / "precious").write_text("precious")
    store_folder(tmp_path / "out.nc").mkdir()
    (store_folder(tmp_path / "out.nc") / name).symlink_to(tmp_path / "precious")
    with pytest.raises(rm.StoreError, match=r"out\.nc\.parts"):
        rm.run(few(), tmp_path / "out.nc")
    assert (tmp_path / "precious").read_text() == "precious"


def test_a_pipe_for_a_manifest_is_refused(tmp_path: Path) -> None:
    store_folder(tmp_path / "out.nc").mkdir()
    os.mkfifo(store_folder(tmp_path / "out.nc") / "manifest.jsonl")
    with pytest.raises(rm.StoreError, match="no ordinary file"):
        rm.run(few(), tmp_path / "out.nc")


FIRST = {"scene": "= no TOML", "versions": "1", "replaces": ""}


@pytest.mark.large
@pytest.mark.parametrize("line", ["[" * 100_000, json.dumps(FIRST), "5", "{}"])
def test_odd_lines_of_a_manifest(line: str, tmp_path: Path) -> None:
    store_folder(tmp_path / "out.nc").mkdir()
    (store_folder(tmp_path / "out.nc") / "manifest.jsonl").write_text(line + "\n")
    xr.testing.assert_equal(rm.run(few(), tmp_path / "out.nc").force, rm.run(few()).force)
    assert [path.name for path in tmp_path.iterdir()] == ["out.nc"]


@pytest.mark.large
def test_a_result_in_the_classic_format_is_refused(tmp_path: Path) -> None:
    out = tmp_path / "out.nc"
    rm.run(few()).to_netcdf(out, format="NETCDF3_64BIT")
    with pytest.raises(rm.StoreError, match="array of characters"):
        read_result(out)


def test_a_failed_cell_has_no_pull_off_force() -> None:
    with pytest.warns(UserWarning, match="1 of 2 failed"):
        found = rm.run(few(3, output={"keep": "statistics"}, sweep={"asperities.radius": ["50 um", "1e300 m"]}))
    assert np.isfinite(found.pull_off_force_sem[0])
    assert np.isnan([found.pull_off_force_mean[1], found.pull_off_force_sem[1], found.pull_off_force_of_mean[1]]).all()
    assert found.pull_off_count.values.tolist() == [3.0, 0.0]


def test_a_plan_goes_on_where_a_cell_cannot_run(tmp_path: Path) -> None:
    bad = few(3, sweep={"asperities.radius": ["50 um", "1e300 m"]})
    (tmp_path / "bad.toml").write_text(tomli_w.dumps(bad))
    done = roughmdr("plan", "bad.toml", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "cannot run   asperities.radius = 1e300 m, realisation 0: the contact" in done.stdout


def test_the_error_of_no_realisations_with_force_is_not_known() -> None:
    from roughmdr.batch.stopping_rule import relative_error

    nothing = np.zeros(3)
    assert relative_error(Moments(5, nothing, nothing, nothing, nothing)) == np.inf

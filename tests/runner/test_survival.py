"""Batches that are killed, interrupted, starved of disk or robbed of their folder: what becomes of them."""

import os
import random
import shutil
import signal
import subprocess
import time
from contextlib import suppress
from pathlib import Path

import psutil
import pytest
import xarray as xr
from batches import (
    CURVES,
    RUNS,
    STATISTICS,
    Batch,
    assert_result,
    computed,
    kept,
    lines,
    mounted,
    running,
    slow_scene,
    until,
    write_scene,
)
from forms import large

import roughmdr as rm
from roughmdr.batch.plan import make_plan
from roughmdr.batch.resume.store import CheckpointStore
from roughmdr.runner.backend import Backend
from roughmdr.runner.run import execute
from roughmdr.scene import read
from roughmdr.storage.result_file import read_result


@pytest.fixture(scope="module")
def killed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of a batch that was killed half way."""
    folder = tmp_path_factory.mktemp("killed") / "batch"
    write_scene(folder, CURVES)
    batch = Batch(folder)
    batch.wait_for_lines(RUNS // 8)
    batch.kill()
    return folder


@pytest.fixture
def left(killed: Path, tmp_path: Path) -> Path:
    """A copy of it."""
    return Path(shutil.copytree(killed, tmp_path / "left"))


def resume(folder: Path, capsys: pytest.CaptureFixture[str], base: xr.Dataset) -> int:
    """Go on in this process: how many runs were computed. The result is right, and nothing else is left."""
    capsys.readouterr()
    execute(make_plan(read(folder / "scene.toml")), folder / "out.nc", Backend(runs_per_task=4), quiet=False)
    assert_result(folder, base, alone=True)
    return computed(capsys.readouterr().err)


# Killed


@pytest.mark.large
@pytest.mark.parametrize(("keep", "kills"), [("curves", 3), large("curves", 14), large("statistics", 6)])
def test_killed_again_and_again_it_comes_to_the_same_bits(
    tmp_path: Path, keep: str, kills: int, request: pytest.FixtureRequest
) -> None:
    """At random moments, each start the resume of the one before; the last quarter while the result is written."""
    base = request.getfixturevalue(keep)
    folder, chosen = tmp_path / "batch", random.Random(2012)
    write_scene(folder, CURVES if keep == "curves" else STATISTICS)
    tasks, before, survived = RUNS // 4, 0, 0
    for kill in range(kills):
        late = kill >= 3 * kills // 4
        batch = Batch(folder, "--workers", chosen.choice([1, 2, 3]))
        if late:
            batch.wait_for_lines(tasks)
            time.sleep(chosen.uniform(0.0, 0.06))
        elif chosen.random() < 0.15:
            time.sleep(chosen.uniform(0.0, 2.0))  # anywhere, also before anything is computed
        else:
            batch.wait_for_lines(min(len(lines(folder)) + chosen.randint(1, 3), tasks - 4))
            time.sleep(chosen.uniform(0.0, 0.03))
        survived += batch.process.poll() is None
        batch.kill()
        if (folder / "out.nc").exists():  # whole, from the first moment
            assert_result(folder, base)
            (folder / "out.nc").unlink()  # so that the next has something to do
            before = 0
        else:
            now = kept(folder)
            assert now >= before
            before = now
    assert survived > 0.8 * kills
    last = Batch(folder)
    assert last.succeed() <= RUNS - before
    assert_result(folder, base, alone=True)


@pytest.mark.large
def test_killed_between_the_result_and_the_end_of_the_parts(
    left: Path, curves: xr.Dataset, capsys: pytest.CaptureFixture[str]
) -> None:
    parts = left / "out.nc.parts"
    saved = shutil.copytree(parts, left.parent / "saved")
    assert 0 < resume(left, capsys, curves) < RUNS
    written = (left / "out.nc").stat()
    for missing in ([], ["manifest.jsonl", "000001.npz"], [path.name for path in saved.iterdir()]):
        shutil.copytree(saved, parts)
        for name in missing:
            (parts / name).unlink()
        assert resume(left, capsys, curves) == 0
    assert (left / "out.nc").stat().st_mtime_ns == written.st_mtime_ns


@pytest.mark.large
def test_parts_of_another_scene_outlive_a_result_that_is_there(
    left: Path, curves: xr.Dataset, capsys: pytest.CaptureFixture[str]
) -> None:
    saved = shutil.move(left / "out.nc.parts", left.parent / "saved")
    other = slow_scene(4, count=100)
    write_scene(left, other)
    execute(make_plan(read(left / "scene.toml")), left / "out.nc", Backend(runs_per_task=4))
    shutil.move(saved, left / "out.nc.parts")
    execute(make_plan(read(left / "scene.toml")), left / "out.nc", Backend(runs_per_task=4))
    assert lines(left)
    (left / "out.nc").unlink()
    write_scene(left, CURVES)
    assert 0 < resume(left, capsys, curves) < RUNS


@pytest.mark.large
@pytest.mark.parametrize("runs_per_task", [8, large(RUNS)])
def test_killed_while_the_result_is_half_written(
    folder: Path, curves: xr.Dataset, capsys: pytest.CaptureFixture[str], runs_per_task: int
) -> None:
    """Also where all is one task, of which nothing is kept."""
    halfway = """
import os, signal
import netCDF4
def sync(*_):
    os.kill(os.getpid(), signal.SIGKILL)
netCDF4.Dataset.__exit__ = sync
"""
    with running(Batch(folder, runs_per_task=runs_per_task, code=halfway)) as batch:
        assert batch.end()[0] == -signal.SIGKILL
    assert not (folder / "out.nc").exists()
    assert [path.name for path in (folder / "out.nc.parts").glob(".roughmdr.*.tmp")]
    assert resume(folder, capsys, curves) == (0 if runs_per_task < RUNS else RUNS)


# Damaged


@pytest.mark.few(1)
@pytest.mark.parametrize(
    "damage",
    [
        "torn line",
        *map(large, ["odd lines", "no first line", "file", "no file", "every file"]),
        "nothing left",
        "leftovers",
    ],
)
def test_only_what_is_damaged_is_computed_again(
    left: Path, curves: xr.Dataset, capsys: pytest.CaptureFixture[str], damage: str
) -> None:
    parts, had = left / "out.nc.parts", lines(left)
    manifest, third = parts / "manifest.jsonl", parts / had[2]["file"]
    lost = 0
    match damage:
        case "torn line":
            manifest.write_bytes(manifest.read_bytes()[:-20])
            lost = had[-1]["realizations"]
        case "odd lines":
            with manifest.open("ab") as file:
                file.write(b'7\n[]\nnull\n{"file": 3}\n{"file": "x.npz", "sha256": "0"}\n\xff\xfe\n\0\0\0\n{"file": "0')
        case "no first line":
            manifest.write_bytes(b"".join(manifest.read_bytes().splitlines(keepends=True)[1:]))
        case "file":
            content = bytearray(third.read_bytes())
            content[len(content) // 2] ^= 1
            third.write_bytes(content)
            lost = had[2]["realizations"]
        case "no file":
            third.unlink()
            lost = had[2]["realizations"]
        case "every file" | "nothing left":
            for line in had:
                file = parts / line["file"]
                os.truncate(file, 0 if damage == "nothing left" else file.stat().st_size // 2)
            lost = sum(line["realizations"] for line in had)
        case "leftovers":
            (parts / "000099.npz.tmp").write_bytes(b"half")
            (parts / "000098.npz").write_bytes(b"of no line")
            (parts / ".roughmdr.abc.tmp").write_bytes(b"half a result")
    assert resume(left, capsys, curves) == RUNS - sum(line["realizations"] for line in had) + lost


# Interrupted


@pytest.mark.parametrize(
    ("number", "scheduler", "group"),
    [
        large(signal.SIGTERM, "threads", False),
        (signal.SIGINT, "threads", True),
        large(signal.SIGINT, "processes", True),
    ],
)
def test_interrupted_it_ends_what_it_began_and_says_what_is_kept(
    folder: Path, curves: xr.Dataset, capsys: pytest.CaptureFixture[str], number: int, scheduler: str, group: bool
) -> None:
    with running(Batch(folder, "--scheduler", scheduler)) as batch:
        batch.wait_for_lines(5)
        batch.signal_group(number) if group else os.kill(batch.pid, number)
        said = batch.fail(130)
    assert "finishing what is under way" in said
    assert "interrupted; what is finished is kept in out.nc.parts; the same command goes on from there" in said
    done = kept(folder)
    assert 20 <= done < RUNS
    assert resume(folder, capsys, curves) == RUNS - done


@pytest.mark.large
@pytest.mark.parametrize("scheduler", ["threads", large("processes")])
def test_interrupted_twice_it_ends_at_once(folder: Path, capsys: pytest.CaptureFixture[str], scheduler: str) -> None:
    """Its runs would take minutes."""
    endless = slow_scene(64, count=20_000_000)
    write_scene(folder, endless)
    with running(Batch(folder, "--scheduler", scheduler, runs_per_task=1)) as batch:
        until((folder / "out.nc.parts" / "manifest.jsonl").exists)
        if scheduler == "processes":
            until(lambda: len(batch.children()) == 2)
        time.sleep(1.0)
        workers = batch.children()
        batch.signal_group(signal.SIGINT)
        until(lambda: "finishing" in batch.said_so_far(), 5.0)
        batch.signal_group(signal.SIGINT)
        until(lambda: batch.process.poll() is not None, 10.0)
        said = batch.fail(130)
    assert "interrupted; nothing was written" in said
    gone(workers)
    assert [path.name for path in folder.iterdir()] == ["scene.toml"]


@pytest.mark.large
@pytest.mark.parametrize("delay", [large(0.0), 0.3, large(0.8)])
def test_an_interrupt_while_worker_processes_start(folder: Path, delay: float) -> None:
    with running(Batch(folder, "--scheduler", "processes")) as batch:
        until(lambda: len(batch.children()) > 0)
        time.sleep(delay)
        batch.signal_group(signal.SIGINT)
        said = batch.fail(130)
    assert "interrupted; " in said


@pytest.mark.large
def test_an_interrupt_while_the_result_is_written_lets_it_be_written(folder: Path, curves: xr.Dataset) -> None:
    slowly = """
import os, signal
import roughmdr.batch.resume.writer as writer
def write(*arguments, write=writer.write_netcdf):
    os.kill(os.getpid(), signal.SIGINT)
    write(*arguments)
writer.write_netcdf = write
"""
    with running(Batch(folder, code=slowly)) as batch:
        batch.succeed()
    assert_result(folder, curves, alone=True)


# Processes that die


def gone(processes: list[psutil.Process]) -> None:
    def is_gone(process: psutil.Process) -> bool:
        with suppress(psutil.NoSuchProcess):
            return process.status() == psutil.STATUS_ZOMBIE
        return True

    until(lambda: all(map(is_gone, processes)), 10.0)


@pytest.mark.large
def test_a_worker_process_that_is_killed_is_replaced(folder: Path, curves: xr.Dataset) -> None:
    with running(Batch(folder, "--scheduler", "processes")) as batch:
        batch.wait_for_lines(5)
        workers = batch.children()
        assert len(workers) == 2
        workers[0].kill()
        gone(workers)  # the other one is of no use any more
        assert batch.succeed() == RUNS
    assert_result(folder, curves, alone=True)


@pytest.mark.large
def test_no_worker_process_outlives_a_killed_batch(folder: Path) -> None:
    with running(Batch(folder, "--scheduler", "processes")) as batch:
        batch.wait_for_lines(2)
        workers = batch.children()
        assert len(workers) == 2
        batch.kill()
        gone(workers)


@pytest.mark.large
def test_a_run_whose_process_always_dies_has_failed_and_the_others_are_done(folder: Path) -> None:
    """A system out of memory kills whatever takes too much; here the test does it in its place."""
    counts = [100, 200, 6_000_000, 300, 400]
    write_scene(folder, slow_scene(1, count=max(counts), sweep={"asperities.count": counts}))
    with running(Batch(folder, "--scheduler", "processes", runs_per_task=1)) as batch:
        deaths = 0
        while batch.process.poll() is None:
            with suppress(psutil.NoSuchProcess):
                for child in batch.children():
                    with suppress(psutil.NoSuchProcess):
                        if child.memory_info().rss > 350e6:
                            child.kill()
                            deaths += 1
            time.sleep(0.02)
        batch.fail(1)
    assert deaths >= 3
    result = read_result(folder / "out.nc").to_xarray()
    assert (result.status.sel(asperities_count=6_000_000) == 1).all()
    assert (result.remark.sel(asperities_count=6_000_000) == "the process that computed it died").all()
    others = result.drop_sel(asperities_count=6_000_000)
    assert (others.status == 0).all()
    assert kept(folder) == 4


# Runs that fail


@pytest.mark.large
def test_a_failure_that_has_gone_away_is_repaired(folder: Path, curves: xr.Dataset) -> None:
    short_of_memory = """
import roughmdr.batch.tasks as tasks
def simulate_realization(scene, route, realization, *more, simulate_realization=tasks.simulate_realization):
    if realization in (3, 70):
        raise MemoryError
    return simulate_realization(scene, route, realization, *more)
tasks.simulate_realization = simulate_realization
"""
    with running(Batch(folder, code=short_of_memory)) as batch:
        batch.fail(1)
    result = read_result(folder / "out.nc").to_xarray()
    assert result.status.values.nonzero()[0].tolist() == [3, 70]
    assert result.remark.values[[3, 70]].tolist() == ["MemoryError"] * 2
    assert kept(folder) == RUNS - 2
    with running(Batch(folder)) as batch:
        assert batch.succeed() == 2
    assert_result(folder, curves, alone=True)


# Disks and folders


@pytest.mark.large
def test_a_full_disk_keeps_what_fits_and_more_room_is_all_it_takes(tmp_path: Path) -> None:
    everything = ["force", "contact_area", "contact_count", "stiffness", "pressure", "energy", "contact_radius_sum"]
    steps = {"separation": {"start": "3 sigma", "stop": "-0.5 sigma", "steps": 1000}, "unload": True}
    table = slow_scene(80, count=100, path=steps, output={"variables": everything})  # 112 kB each
    folder = tmp_path / "disk"
    with mounted(folder, "4m"):
        write_scene(folder, table)
        with running(Batch(folder)) as batch:
            said = batch.fail(1)
        assert "No space left on device; what is finished is kept in out.nc.parts" in said
        assert not (folder / "out.nc").exists()
        held = sum(
            result.realizations
            for read in CheckpointStore(folder / "out.nc.parts").readers()
            if (result := read()) is not None
        )
        assert 20 < held == kept(folder) < 40
        with running(Batch(folder)) as batch:  # nothing has changed, and so is the answer
            said = batch.fail(1, 2)
        assert "No space left on device" in said
        assert kept(folder) >= held
        subprocess.run(["mount", "-o", "remount,size=64m", folder], check=True)
        held = kept(folder)
        with running(Batch(folder)) as batch:
            assert batch.succeed() == 80 - held
        assert_result(folder, rm.run(table), alone=True)


def test_a_folder_that_cannot_be_written_is_found_before_computing(tmp_path: Path) -> None:
    folder = tmp_path / "disk"
    with mounted(folder, "4m"):
        write_scene(folder, CURVES)
        subprocess.run(["mount", "-o", "remount,ro", folder], check=True)
        with running(Batch(folder)) as batch:
            said = batch.fail(2)
        assert "out.nc: cannot be written: Read-only file system" in said


def remove(folder: Path) -> None:
    def is_removed() -> bool:
        shutil.rmtree(folder, ignore_errors=True)
        return not folder.exists()

    until(is_removed)


@pytest.mark.large
@pytest.mark.parametrize("what", ["", large("out.nc.parts")])
def test_a_folder_that_vanishes_is_told_of(folder: Path, curves: xr.Dataset, what: str) -> None:
    with running(Batch(folder)) as batch:
        batch.wait_for_lines(3)
        remove(folder / what)
        said = batch.fail(1, 2)
    assert "out.nc.parts: cannot be written: No such file or directory" in said
    assert "is kept" not in said
    assert not (folder / "out.nc").exists()


# Side by side


@pytest.mark.parametrize("scheduler", [*map(large, ["threads", "processes"])])
def test_nothing_listens(folder: Path, scheduler: str) -> None:
    with running(Batch(folder, "--scheduler", scheduler)) as batch:
        batch.wait_for_lines(2)
        for process in [psutil.Process(batch.pid), *psutil.Process(batch.pid).children(recursive=True)]:
            assert not process.net_connections("inet"), process

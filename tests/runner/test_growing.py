"""Zarr stores that grow with their batch: what can be read meanwhile, and what they come to, whatever ends it."""

import json
import os
import random
import shutil
import signal
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from batches import (
    Batch,
    assert_same,
    kept,
    mounted,
    running,
    slow_scene,
    until,
    write_scene,
)
from forms import large
from scenes import scene

import roughmdr as rm
from roughmdr.batch.plan import make_plan
from roughmdr.runner.backend import Backend
from roughmdr.runner.run import execute
from roughmdr.scene import read
from roughmdr.storage import zarr_store
from roughmdr.storage.result_file import read_result

RUNS, STEPS = 48, 20_000
LONG = slow_scene(RUNS, count=200, path={"separation": {"start": "3 um", "stop": "0 um", "steps": STEPS}})
IN_A_CHUNK = zarr_store._CHUNK_SIZE // STEPS
CHUNKS = -(-RUNS // IN_A_CHUNK)
NAMES = ("force", "contact_area", "contact_count", "stiffness")


@pytest.fixture(scope="module")
def expected() -> xr.Dataset:
    return rm.run(LONG)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    write_scene(tmp_path / "batch", LONG)
    return tmp_path / "batch"


def started(folder: Path, *options: object, runs_per_task: int = 3) -> Batch:
    return Batch(folder, "-o", "out.zarr", *options, runs_per_task=runs_per_task)


def chunks(folder: Path, name: str = "force") -> set[int]:
    """Which chunks of a curve have been written, of which each has its runs to itself."""
    there = folder / "out.zarr.parts" / "so_far.zarr" / name / "c"
    return {int(each.parent.name) for each in there.glob("*/0") if each.is_file()}


def assert_it_came_to(expected: xr.Dataset, folder: Path) -> None:
    """The store has the bits of an undisturbed run, and nothing else is left."""
    found = read_result(folder / "out.zarr")
    assert found.integrity_fault() == ""
    assert_same(found.to_xarray(), expected)
    assert sorted(path.name for path in folder.iterdir()) == ["out.zarr", "scene.toml"]


def files(store: Path) -> dict[str, Any]:
    """All files of a store by their names, but for what depends on the clock."""
    found: dict[str, Any] = {}
    for path in store.rglob("*"):
        name = str(path.relative_to(store))
        if path.is_file() and not name.startswith("run_time/c"):
            found[name] = path.read_bytes()
    root = json.loads(found["zarr.json"])
    del root["attributes"]["history"]
    return found | {"zarr.json": root}


@pytest.mark.large
@pytest.mark.parametrize(
    ("swept", "size"), [(False, 8), (True, 30), large(True, 8), large(True, 100), large(True, 2**18)]
)
def test_it_is_file_by_file_the_store_that_is_written_at_once(
    tmp_path: Path, size: int, swept: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Also with runs that fail, cells alike, and chunks that cut runs; each chunk is written once, before the end."""
    monkeypatch.setattr(zarr_store, "_CHUNK_SIZE", size)
    sweep = {"adhesion.work": [0.02, 0.05, 0.03], "asperities.radius": ["1e-300 m", "50 um"]} if swept else None
    table = scene(
        asperities={**scene()["asperities"], "count": 20, "radius": "50 um"},
        path={"separation": [3e-6, 2e-6, 1e-6, 0.0] * 3},
        batch={"realizations": 7},
        sweep=sweep,
    )
    written: list[tuple[slice, ...]] = []
    write = zarr_store.GrowingStore.write

    def noted(self: zarr_store.GrowingStore, block: tuple[slice, ...]) -> None:
        write(self, block)
        written.append(block)

    monkeypatch.setattr(zarr_store.GrowingStore, "write", noted)
    plan = make_plan(read(table))
    execute(plan, tmp_path / "at_once.zarr", Backend(runs_per_task=1000))
    assert not written
    result = execute(plan, tmp_path / "grown.zarr", Backend(runs_per_task=2))
    covered = np.zeros(result.variables["status"].values.shape, dtype=int)
    for block in written:
        covered[block] += 1
    assert (covered == 1).all()
    grown, at_once = (files(tmp_path / name) for name in ("grown.zarr", "at_once.zarr"))
    assert grown.keys() == at_once.keys()
    for name, content in at_once.items():
        assert grown[name] == content, name


@pytest.mark.large
def test_it_can_be_read_while_the_batch_runs(folder: Path, expected: xr.Dataset) -> None:
    with running(started(folder)) as batch:
        until(lambda: len(chunks(folder)) >= 2 or batch.process.poll() is not None)
        os.kill(batch.pid, signal.SIGSTOP)
        names = [str(name) for name, array in expected.data_vars.items() if array.dims == ("realization", "step")]
        there = set.intersection(*(chunks(folder, name) for name in names))
        assert 1 <= len(there) < CHUNKS
        with xr.open_zarr(folder / "out.zarr.parts" / "so_far.zarr") as so_far:
            assert set(so_far.dims) == {"realization", "step"}
            np.testing.assert_array_equal(so_far.separation, expected.separation)
            assert so_far.force.attrs == expected.force.attrs
            assert set(so_far.data_vars) == set(names)
            for name in names:
                values = so_far[name].to_numpy()
                for chunk in range(CHUNKS):
                    rows = slice(chunk * IN_A_CHUNK, (chunk + 1) * IN_A_CHUNK)
                    if chunk in there:
                        assert values[rows].tobytes() == expected[name].to_numpy()[rows].tobytes()
                    elif chunk not in chunks(folder, name):
                        assert np.isnan(values[rows]).all()
        assert not (folder / "out.zarr").exists()
        os.kill(batch.pid, signal.SIGCONT)
        assert batch.succeed() == RUNS
    assert_it_came_to(expected, folder)


@pytest.mark.parametrize("kills", [*map(large, [3, 20])])
def test_ended_at_any_moment_it_comes_to_the_same_bits(folder: Path, expected: xr.Dataset, kills: int) -> None:
    """By kill -9 or an interrupt, at any number of chunks, also while the last ones are written or it is moved."""
    chosen, before, cut = random.Random(7), 0, 0
    for kill in range(kills):
        number = [signal.SIGKILL, signal.SIGKILL, signal.SIGINT][kill % 3]
        wanted = chosen.randint(1, CHUNKS)
        shutil.rmtree(folder / "out.zarr.parts" / "so_far.zarr", ignore_errors=True)  # else its chunks are counted
        with running(started(folder, "--workers", chosen.choice([1, 2]))) as batch:
            until(lambda: len(chunks(folder)) >= wanted or batch.process.poll() is not None)  # noqa: B023
            batch.process.send_signal(number)
            status, said = batch.end()
        assert status in {0, 130, -signal.SIGKILL}, said
        cut += status != 0
        if (folder / "out.zarr").exists():
            assert read_result(folder / "out.zarr").integrity_fault() == ""
            shutil.rmtree(folder / "out.zarr")  # so that the next has something to do
            before = 0
        else:
            assert kept(folder, "out.zarr") >= before
            before = kept(folder, "out.zarr")
    assert cut > 0
    held = kept(folder, "out.zarr")
    with running(started(folder)) as batch:
        assert batch.succeed() == RUNS - held
    assert_it_came_to(expected, folder)


@pytest.mark.large
def test_what_another_batch_has_left_of_it_is_not_trusted(folder: Path, expected: xr.Dataset) -> None:
    """Here forces are stiffnesses, and a coordinate is not whole."""
    with running(started(folder)) as batch:
        until(lambda: len(chunks(folder, "stiffness")) >= 2)
        batch.kill()
    left = folder / "out.zarr.parts" / "so_far.zarr"
    shutil.rmtree(left / "force" / "c")
    shutil.copytree(left / "stiffness" / "c", left / "force" / "c")
    shutil.rmtree(left / "separation" / "c")
    held = kept(folder, "out.zarr")
    with running(started(folder)) as batch:
        assert batch.succeed() == RUNS - held
    assert_it_came_to(expected, folder)


@pytest.mark.large
def test_where_no_run_can_be_computed_nothing_is_left(tmp_path: Path) -> None:
    write_scene(tmp_path / "batch", LONG)
    with running(
        Batch(
            tmp_path / "batch",
            *("-o", "out.zarr"),
            code="import roughmdr.batch.tasks as tasks\ntasks.simulate_realization = lambda *_: [][0]",
        )
    ) as batch:
        status, said = batch.end()
    assert status == 1
    assert "realisation 0: IndexError: list index out of range" in said
    assert [path.name for path in (tmp_path / "batch").iterdir()] == ["scene.toml"]


@pytest.mark.large
def test_statistics_and_an_error_asked_for_are_written_at_the_end(tmp_path: Path) -> None:
    few = {"asperities": {**scene()["asperities"], "count": 20}}
    for more in ({"output": {"keep": "statistics"}}, {"accuracy": {"relative": 0.05, "method": "sampled"}}):
        folder = tmp_path / next(iter(more))
        write_scene(folder, scene(**few, **more))
        slowly = "import roughmdr.storage.zarr_store as store\nstore.GrowingStore.__init__ = None"
        with running(Batch(folder, "-o", "out.zarr", code=slowly)) as batch:
            assert batch.succeed() > 4
        assert read_result(folder / "out.zarr").integrity_fault() == ""


@pytest.mark.large
def test_a_disk_that_is_full_of_chunks_is_told_of(tmp_path: Path, expected: xr.Dataset) -> None:
    """There is room for the runs of the first chunk, not for all of its curves."""
    folder, run = tmp_path / "disk", sum(expected[name][0].nbytes for name in NAMES if name in expected)
    size = (IN_A_CHUNK * run + 2**20) // 2**10
    with mounted(folder, f"{size}k"):
        write_scene(folder, LONG)
        with running(started(folder, runs_per_task=IN_A_CHUNK)) as batch:
            said = batch.fail(1)
        assert "out.zarr.parts: cannot be written: No space left on device; what is finished is kept in" in said
        assert kept(folder, "out.zarr") == IN_A_CHUNK
        assert not all(chunks(folder, name) for name in NAMES if name in expected)
        subprocess.run(["mount", "-o", "remount,size=200m", folder], check=True)
        with running(started(folder)) as batch:
            assert batch.succeed() == RUNS - IN_A_CHUNK
        assert_it_came_to(expected, folder)


@pytest.mark.large
def test_a_folder_that_vanishes_is_told_of_and_not_made_again(folder: Path) -> None:
    parts = folder / "out.zarr.parts"

    def is_removed() -> bool:
        shutil.rmtree(parts, ignore_errors=True)
        return not parts.exists()

    with running(started(folder)) as batch:
        until(lambda: len(chunks(folder)) >= 1)
        os.kill(batch.pid, signal.SIGSTOP)
        until(is_removed)
        os.kill(batch.pid, signal.SIGCONT)
        said = batch.fail(1, 2)
    assert "out.zarr.parts: cannot be written: No such file or directory" in said
    assert [path.name for path in folder.iterdir()] == ["scene.toml"]

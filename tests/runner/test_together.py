"""Several processes that fill one batch: no run is computed twice, and one of them writes the result."""

import signal
import subprocess
import sys
from pathlib import Path
from random import Random

import numpy as np
import pytest
import xarray as xr
from batches import (
    CURVES,
    RUNS,
    STATISTICS,
    Batch,
    assert_no_traceback,
    assert_result,
    lines,
    running,
    slow_scene,
    until,
    write_scene,
)
from forms import large
from hypothesis import given, settings, strategies as st
from scenes import scene

import roughmdr as rm
from roughmdr.batch.plan import make_plan
from roughmdr.batch.resume.kept import Kept
from roughmdr.batch.resume.keys import versions
from roughmdr.batch.resume.locks import claims_in, give_up
from roughmdr.batch.resume.manifest import MANIFEST, Runs
from roughmdr.batch.resume.store import CheckpointStore
from roughmdr.batch.resume.writer import Together
from roughmdr.batch.task_result import TaskResult, not_run
from roughmdr.batch.tasks import RunRange, Task, compute, split_into_tasks
from roughmdr.errors import StoreError
from roughmdr.runner.batch import begun
from roughmdr.scene import read
from roughmdr.storage.result_file import read_result

_PUT = """
import time
from pathlib import Path
from roughmdr.batch.resume.writer import CheckpointWriter
def put(self, result, put=CheckpointWriter.put, results=[]):
    put(self, result)
    results.append(result)
    end = time.monotonic() + 60.0
    {wait}
CheckpointWriter.put = put
"""
WITH_OTHERS = _PUT.format(
    wait="""parts = Path("out.nc.parts")
    while len(results) > 1 and (parts / "manifest.jsonl").exists() and not [*parts.glob("[1-9]*.npz")]:
        assert time.monotonic() < end
        time.sleep(0.01)"""
)
"""Code that makes a process wait after its second task until another process has stored a result."""
SLOWLY = _PUT.format(wait="time.sleep(0.1)")


def of_others(folder: Path) -> int:
    """How many runs processes have stored that were not the first."""
    return sum(line["realizations"] for line in lines(folder) if int(line["file"][:-4]) >= 10**6)


def wait_for_others(folder: Path, *batches: Batch) -> None:
    until(lambda: of_others(folder) > 0 or any(batch.process.poll() is not None for batch in batches))
    assert of_others(folder) > 0


@pytest.mark.parametrize(
    ("keep", "runs_per_task", "options"),
    [
        ("curves", (4, 4), ()),
        large("curves", (3, 5), ("--scheduler", "processes")),
        large("statistics", (4, 4), ()),
        large("statistics", (3, 8), ()),
        large("statistics", (8, 3), ("--scheduler", "processes")),
    ],
)
def test_two_share_the_runs_of_a_batch(
    folder: Path,
    curves: xr.Dataset,
    statistics: xr.Dataset,
    keep: str,
    runs_per_task: tuple[int, int],
    options: tuple[str, ...],
) -> None:
    write_scene(folder, CURVES if keep == "curves" else STATISTICS)
    with running(Batch(folder, *options, runs_per_task=runs_per_task[0], code=WITH_OTHERS)) as first:
        first.wait_for_lines(1)
        with running(Batch(folder, *options, runs_per_task=runs_per_task[1], code=SLOWLY)) as second:
            wait_for_others(folder, first, second)
            found = Kept(folder / "out.nc.parts")
            assert found.holder is not None
            assert found.holder.process in {first.pid, second.pid}
            counts = second.succeed(), first.succeed()
    assert all(count > 0 for count in counts)
    if keep == "curves":
        assert sum(counts) == RUNS
    assert_result(folder, curves if keep == "curves" else statistics, alone=True)


@pytest.mark.large
@pytest.mark.parametrize("killed", ["first", "second"])
@pytest.mark.parametrize("options", [(), ("--scheduler", "processes")])
def test_one_that_is_killed_leaves_the_rest_to_the_other(
    folder: Path, curves: xr.Dataset, killed: str, options: tuple[str, ...]
) -> None:
    with running(Batch(folder, *options, code=WITH_OTHERS)) as first:
        first.wait_for_lines(1)
        with running(Batch(folder, *options, code=SLOWLY)) as second:
            wait_for_others(folder, first, second)
            (first if killed == "first" else second).kill()
            other = second if killed == "first" else first
            assert 0 < other.succeed() < RUNS
    assert_result(folder, curves, alone=True)


@pytest.mark.large
def test_three_begun_at_once_and_one_more_later(folder: Path, curves: xr.Dataset) -> None:
    batches = [Batch(folder, code=WITH_OTHERS) for _ in range(3)]
    try:
        until(lambda: of_others(folder) > 0)
        batches.append(Batch(folder, code=SLOWLY))
        assert sum(batch.succeed() for batch in batches) == RUNS
    finally:
        for batch in batches:
            if batch.process.poll() is None:
                batch.kill()
    assert_result(folder, curves, alone=True)


@pytest.mark.large
def test_one_that_waits_can_be_interrupted(folder: Path, curves: xr.Dataset) -> None:
    stuck = """
import time
from pathlib import Path
def late(task, compute=tasks.compute):
    result = compute(task)
    while not Path("../go").exists():
        time.sleep(0.01)
    return result
tasks.compute = late
"""
    with running(Batch(folder, code=stuck)) as first:
        until((folder / "out.nc.parts" / "claims").exists)
        with running(Batch(folder)) as second:
            until(lambda: "waits for" in second.said_so_far())
            second.process.send_signal(signal.SIGINT)
            said = second.fail(130)
        assert "what is finished is kept in" in said
        (folder.parent / "go").touch()
        assert first.succeed() == 8
    assert_result(folder, curves, alone=True)


@pytest.mark.large
def test_rounds_of_an_error_that_is_asked_for_are_filled_together(folder: Path) -> None:
    table = slow_scene(16, count=2000, accuracy={"relative": 0.02, "method": "sampled", "max_realizations": 400})
    alone = rm.run(table)
    write_scene(folder, table)
    with running(Batch(folder, code=WITH_OTHERS)) as first:
        first.wait_for_lines(1)
        with running(Batch(folder, code=SLOWLY)) as second:
            second.succeed()
            first.succeed()
    assert_result(folder, alone, alone=True)


@pytest.mark.large
def test_runs_that_fail_fail_for_both(folder: Path) -> None:
    write_scene(folder, slow_scene(12, count=1000, sweep={"asperities.radius": ["1e-300 m", "20 um", "50 um"]}))
    with running(Batch(folder, runs_per_task=1, code=WITH_OTHERS)) as first:
        until((folder / "out.nc.parts" / "manifest.jsonl").exists)
        with running(Batch(folder, runs_per_task=1)) as second:
            ends = first.end(), second.end()
    for status, said in ends:
        assert status == 1, said
        assert_no_traceback(said)
    result = read_result(folder / "out.nc").to_xarray()
    assert result.status.values.tolist() == [[1] * 12, [0] * 12, [0] * 12]
    assert (folder / "out.nc.parts").is_dir()


def test_a_process_does_not_join_itself(folder: Path) -> None:
    plan = make_plan(read(folder / "scene.toml"))
    with begun(plan, folder / "out.nc", resume=True) as beginning:
        beginning.writer.begin(plan.scene.toml, "")
        with pytest.raises(StoreError, match="another run is writing it"), begun(plan, folder / "out.nc", resume=True):
            pass


def test_tasks_that_another_stores_meanwhile_are_still_claimed(tmp_path: Path) -> None:
    """Only runs that were stored before, and could not be used, are computed in any case."""
    plan = make_plan(read(scene(batch={"realizations": 8})))
    with begun(plan, tmp_path / "out.nc", resume=True) as beginning:
        store = beginning.writer.store
        assert store is not None
        tasks = split_into_tasks(plan, beginning.rounds.begin(), ("force",), 1, 1)
        beginning.writer.begin(plan.scene.toml, "")
        results = [compute(tasks[number]) for number in (0, 5)]
        assert results[0] is not None
        assert results[1] is not None
        store.write(results[0])
        store.claims.look()
        claimed = Together(beginning.writer, plan, beginning.rounds.keys).claimed(tasks, by_workers=True)
        assert next(claimed).claimed_in is None
        store.write(results[1])
        store.claims.look()
        assert [task.claimed_in for task in claimed] == [store.whole_path] * 7


# Claims


@settings(deadline=None)
@given(
    sizes=st.lists(st.tuples(st.integers(0, 2), st.integers(1, 9), st.booleans()), max_size=20), shuffle=st.randoms()
)
def test_ranges_of_a_task_result_are_its_runs(sizes: list[tuple[int, int, bool]], shuffle: Random) -> None:
    """Whichever rows there are and in whatever order."""
    rows, at = [], [0, 0, 0]
    for cell, size, there in sizes:
        rows += [(cell, at[cell], size)] if there else []
        at[cell] += size
    shuffle.shuffle(rows)
    cell, first, size = np.array(rows, dtype=np.int64).reshape(-1, 3).T
    nothing = np.zeros((len(rows), 1, 1))
    result = TaskResult(("a", "b", "c"), ("force",), cell, first, size, (nothing,), nothing, not_run((len(rows),)))
    held = {("abc"[cell], run) for cell, first, size in rows for run in range(first, first + size)}
    assert [(key, run) for key, first, last in result.runs for run in range(first, last)] == sorted(held)
    assert not {(key, last) for key, _, last in result.runs} & held


_CLAIM = """
import sys
from pathlib import Path
from roughmdr.batch.resume.locks import claims_in
from roughmdr.batch.resume.manifest import MANIFEST, Runs
claims = claims_in(Path(sys.argv[1]))
print(*(claims.take([Runs("a", 10 * i, 10 * i + 10)]) for i in range(3)), claims.finish(), flush=True)
sys.stdin.read()
"""


def test_claims_last_as_long_as_their_process(tmp_path: Path) -> None:
    CheckpointStore(tmp_path).begin("scene", "versions", "", "")
    claims = claims_in(tmp_path)
    mine, both = [Runs("a", 25, 40)], [Runs("b", 0, 5), Runs("a", 5, 6)]
    assert claims.take(mine)
    with subprocess.Popen(
        [sys.executable, "-c", _CLAIM, tmp_path], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    ) as other:
        assert other.stdout is not None
        assert other.stdout.readline().split() == ["True", "True", "False", "True"]
        assert not claims.take(both)
        assert not claims.finish()
        assert claims.take(both[:1])
        other.kill()
    assert claims.take(both)
    assert claims.finish()
    give_up(tmp_path)


@pytest.fixture
def stored(tmp_path: Path) -> tuple[CheckpointStore, TaskResult]:
    """The folder of a batch, and a result of three runs that is to be kept there."""
    store = CheckpointStore(tmp_path / "out.nc.parts")
    store.folder.mkdir()
    store.begin("scene", "versions", "", "")
    cell = make_plan(read(scene())).cells[0]
    result = compute(Task((RunRange("a", cell, "sampled", 0, 3),), ("force",), False, versions(), store.whole_path))
    assert result is not None
    assert result.runs == [("a", 0, 3)]
    return store, result


def test_runs_that_are_stored_are_not_claimed(stored: tuple[CheckpointStore, TaskResult]) -> None:
    store, result = stored
    store.write(result)
    for runs, free in ((Runs("a", 0, 3), False), (Runs("a", 2, 5), False), (Runs("a", 3, 5), True)):
        assert store.claims.take([runs, Runs("b", 0, 3)]) == free
    give_up(store.whole_path)


def test_runs_that_two_processes_stored_count_once(stored: tuple[CheckpointStore, TaskResult]) -> None:
    store, result = stored
    for rows in ([0, 1, 2], [1, 2], [0]):
        store.write(result.select_rows(np.array(rows)))
    found = Kept(store.folder)
    assert (found.runs, found.by_key) == (3, {"a": 3})
    give_up(store.whole_path)


def test_half_a_line_of_a_process_that_was_killed_spoils_no_other(stored: tuple[CheckpointStore, TaskResult]) -> None:
    store, result = stored
    with (store.folder / MANIFEST).open("ab") as manifest:
        manifest.write(b'{"file": "0000')
    store.write(result)
    (again,) = (reader() for reader in CheckpointStore(store.folder).readers())
    assert again is not None
    assert again.runs == result.runs
    give_up(store.whole_path)


def test_nothing_is_kept_once_another_has_ended_the_batch(stored: tuple[CheckpointStore, TaskResult]) -> None:
    store, result = stored
    store.clear()
    assert store.ended
    with pytest.raises(StoreError, match="cannot be written"):
        store.write(result)
    assert store.ended
    assert not store.claims.take([Runs("a", 7, 8)])
    give_up(store.whole_path)

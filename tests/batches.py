"""Batches as processes of their own, to be disturbed, and what they leave behind."""

import json
import math
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import psutil
import pytest
import tomli_w
import xarray as xr
from scenes import ASPERITIES, scene

from roughmdr.batch import tasks
from roughmdr.batch.plan import make_plan
from roughmdr.batch.resume.store import store_folder
from roughmdr.batch.task_result import TaskResult
from roughmdr.errors import OutOfRange
from roughmdr.runner import local
from roughmdr.runner.backend import Backend
from roughmdr.runner.run import execute
from roughmdr.scene import Scene, read
from roughmdr.storage.files import destination

_CLI = "from roughmdr.cli import main; main()"
_OF_SMALL_TASKS = """
import sys
import roughmdr.batch.tasks as tasks
runs_per_task, split_into_tasks = int(sys.argv.pop(1)), tasks.split_into_tasks
tasks.split_into_tasks = lambda *given: split_into_tasks(*given[:4], runs_per_task)
"""
PATIENCE = 120.0
"""After so long [s] something hangs."""


def slow_scene(runs: int = 96, count: int = 10_000, **changes: Any) -> dict[str, Any]:
    """A scene whose runs take some milliseconds each, with as many asperities per area as the small one."""
    asperities = ASPERITIES | {"count": count, "patch": 1e-3 * math.sqrt(count / ASPERITIES["count"])}
    return scene(asperities=asperities, batch={"realizations": runs}, **changes)


RUNS = 96
CURVES, STATISTICS = slow_scene(RUNS), slow_scene(RUNS, output={"keep": "statistics"})


def interrupted(
    table: dict[str, Any],
    out: Path,
    after: int,
    monkeypatch: pytest.MonkeyPatch,
    runs_per_task: int = 2,
    resume: bool = True,
) -> None:
    """A batch in this process, of tasks of so many runs, ended by Ctrl-C when some of them are done."""
    left, compute, there = iter(range(after)), tasks.compute, out.exists()

    def until(task: tasks.Task) -> TaskResult:
        if next(left, None) is None:
            raise KeyboardInterrupt
        return compute(task)

    with monkeypatch.context() as patched:
        patched.setattr(local, "compute", until)
        with pytest.raises(KeyboardInterrupt):
            execute(make_plan(read(table)), out, Backend(workers=1, runs_per_task=runs_per_task), resume=resume)
    assert out.exists() == there
    assert store_folder(destination(out)).is_dir()


def let_fail(monkeypatch: pytest.MonkeyPatch, fails: Callable[[Scene, int], bool]) -> None:
    """Let runs fail in this process: those of scenes and realisations of which ``fails`` says so."""
    simulate_realization = tasks.simulate_realization

    def failing(given: Scene, path: Any, realization: int, *others: Any) -> Any:
        if fails(given, realization):
            raise OutOfRange("it must fail")
        return simulate_realization(given, path, realization, *others)

    monkeypatch.setattr(tasks, "simulate_realization", failing)


class Batch:
    """A ``roughmdr run`` in a session of its own, with tasks of a given number of runs."""

    def __init__(
        self, folder: Path, *options: object, runs_per_task: int = 4, code: str = "", scene: str = "scene.toml"
    ):
        self.folder = folder
        self._said = tempfile.NamedTemporaryFile("w+", suffix=".stderr")  # noqa: SIM115 - open until the end
        command = [sys.executable, "-c", f"{_OF_SMALL_TASKS}{code}\n{_CLI}", str(runs_per_task)]
        self.process = subprocess.Popen(
            [*command, "run", scene, "-o", "out.nc", *map(str, options)],
            cwd=folder,
            stdout=subprocess.DEVNULL,
            stderr=self._said,
            start_new_session=True,
        )
        self.pid = self.process.pid

    def said_so_far(self) -> str:
        """Text on the standard error stream by now."""
        return Path(self._said.name).read_text()

    def end(self) -> tuple[int, str]:
        """Wait for its end: exit status, and what it said on the standard error stream."""
        try:
            status = self.process.wait(PATIENCE)
        except subprocess.TimeoutExpired:
            self.kill()
            raise
        self._said.seek(0)
        with self._said as said:
            return status, said.read()

    def succeed(self) -> int:
        """Wait for its end, which must be a good one: how many runs it computed."""
        status, said = self.end()
        assert status == 0, said
        return computed(said)

    def fail(self, *statuses: int) -> str:
        """Wait for its end, which must be one of these exit statuses and no traceback: what it said."""
        status, said = self.end()
        assert status in statuses, said
        assert_no_traceback(said)
        return said

    def kill(self) -> None:
        """Kill it, unless it has ended by itself."""
        self.process.kill()
        self.process.wait()
        self._said.close()

    def signal_group(self, number: int) -> None:
        """Send a signal to the process group, as a terminal does."""
        os.killpg(self.pid, number)

    def children(self) -> list[psutil.Process]:
        """The worker processes."""
        found = psutil.Process(self.pid).children(recursive=True)
        return [child for child in found if "spawn_main" in " ".join(child.cmdline())]

    def wait_for_lines(self, count: int) -> None:
        """Until so many task results are kept, or it is over."""
        until(lambda: len(lines(self.folder)) >= count or self.process.poll() is not None)


def computed(said: str) -> int:
    """How many runs the last line about them tells of."""
    counts = re.findall(r": (\d+) of \d+ runs", said)
    return int(counts[-1]) if counts else 0


def until(condition: Callable[[], bool], patience: float = PATIENCE, pause: float = 0.002) -> None:
    end = time.monotonic() + patience
    while not condition():
        assert time.monotonic() < end, "it hangs"
        time.sleep(pause)


def lines(folder: Path, out: str = "out.nc") -> list[dict[str, Any]]:
    """The whole lines of the manifest that speak of task results."""
    manifest = folder / f"{out}.parts" / "manifest.jsonl"
    try:
        content = manifest.read_bytes()
    except OSError:
        return []
    found = [json.loads(line) for line in content[: content.rfind(b"\n") + 1].splitlines()]
    return [line for line in found if "file" in line]


def kept(folder: Path, out: str = "out.nc") -> int:
    """How many runs are kept."""
    return sum(line["realizations"] for line in lines(folder, out))


def write_scene(folder: Path, table: dict[str, Any]) -> None:
    folder.mkdir(exist_ok=True)
    (folder / "scene.toml").write_text(tomli_w.dumps(table))


def assert_clean(folder: Path, *others: str) -> None:
    """Nothing is left but the scene and the result."""
    assert sorted(path.name for path in folder.iterdir()) == sorted(["out.nc", "scene.toml", *others])


def assert_no_traceback(said: str) -> None:
    assert "Traceback" not in said, said
    assert "Error:" not in said, said


def assert_result(folder: Path, base: xr.Dataset, *, alone: bool = False) -> None:
    """The result has the bits of an undisturbed run; nothing else is left, if it must be alone."""
    with xr.open_dataset(folder / "out.nc") as file:
        found = file.load()
    assert_same(found, base)
    if alone:
        assert_clean(folder)


def assert_same(found: xr.Dataset, base: xr.Dataset, but: tuple[str, ...] = ("history", "checksum")) -> None:
    """Same bits but for the clock and some attributes."""
    found, base = (each.drop_vars("run_time").drop_attrs(deep=False).assign_attrs(
        {name: value for name, value in each.attrs.items() if name not in but}
    ) for each in (found, base))  # fmt: skip
    xr.testing.assert_identical(found, base)
    for name, array in base.data_vars.items():
        assert found[name].to_numpy().tobytes() == array.to_numpy().tobytes(), name


@contextmanager
def running(batch: Batch) -> Iterator[Batch]:
    """A batch that does not outlive a test."""
    try:
        yield batch
    finally:
        if batch.process.poll() is None:
            batch.kill()


@contextmanager
def mounted(place: Path, size: str) -> Iterator[None]:
    """A disk of a size, as long as it takes."""
    if shutil.which("mount") is None or os.geteuid() != 0:
        pytest.skip("no file systems can be mounted here")
    place.mkdir(exist_ok=True)
    if subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={size}", "tmpfs", place], check=False).returncode:
        pytest.skip("no file systems can be mounted here")
    try:
        yield
    finally:
        subprocess.run(["umount", "--lazy", place], check=True)

"""The measurements behind ``batch.py``: overhead of cells and tasks, memory, and what more workers bring."""

import json
import math
import os
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from statistics import median
from typing import NamedTuple

import numpy as np
from batch_child import tiny

from roughmdr.batch.plan import Plan, make_plan
from roughmdr.batch.rounds import Rounds
from roughmdr.batch.task_result import TaskResult
from roughmdr.batch.tasks import split_into_tasks
from roughmdr.numerics.arguments import Floats
from roughmdr.runner.cluster import connected
from roughmdr.runner.local import Pool, Processes, Threads

SCHEDULERS = ("threads", "processes", "distributed")
_CHILD = Path(__file__).with_name("batch_child.py")
_PATIENCE = 60.0  # seconds that a cluster may take to begin


def child(what: str, count: int) -> dict[str, float]:
    """What ``batch_child.py`` says."""
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, str(_CHILD), what, str(count), folder]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        raise RuntimeError(done.stderr)
    found: dict[str, float] = json.loads(done.stdout)
    return found


def medians(action: Callable[[], dict[str, float]], repeats: int) -> dict[str, float]:
    """The medians of what an action measures."""
    rows = [action() for _ in range(repeats)]
    return {name: median(row[name] for row in rows) for name in rows[0]}


class Batch(NamedTuple):
    """What is known of a batch when its tasks are done: one of each for every task, in the order they came back."""

    arrival: Floats
    """Seconds since the start."""
    inside: Floats
    """Seconds in the realisations."""
    caller: Floats
    """Processor seconds of this process so far."""
    scheduler: Floats
    """Processor seconds of the cluster's scheduler so far."""

    def steady(self, column: Floats, skipped: int) -> float:
        """What a task adds to a column, once so many have come back."""
        return float(column[-1] - column[skipped]) / (len(column) - 1 - skipped)


def batch(plan: Plan, pool: Pool, scheduler: int | None = None, runs_per_task: int | None = None) -> Batch:
    """Compute the tasks of a plan by a pool; ``scheduler`` is the process of a cluster's."""
    variables = plan.scene.output.variables
    tasks = split_into_tasks(plan, Rounds(plan).begin(), variables, pool.workers, runs_per_task)
    rows: list[tuple[float, float, float, float]] = []
    started = time.perf_counter()

    def sink(result: TaskResult) -> None:
        own = math.nan if scheduler is None else _processor_seconds(scheduler)
        inside = float(result.diagnostics["run_time"].sum())
        rows.append((time.perf_counter() - started, inside, time.process_time(), own))

    pool.compute(tasks, threading.Event(), sink)
    return Batch(*np.array(rows).T)


def speed_ups(count: int, tasks: int, repeats: int) -> dict[str, dict[str, list[float]]]:
    """By threads and processes: how many times as fast two workers are as one, and the seconds inside a task.

    Taken in turn, on tasks of one large realisation. Threads count from the start on; processes once all have begun,
    which the first four tasks a worker are left out for.
    """
    plan = make_plan(tiny(count=count, steps=200, batch={"realizations": tasks}))
    pools: dict[str, Callable[[int], Pool]] = {"threads": Threads, "processes": Processes}
    batch(plan, Threads(2), runs_per_task=1)
    found: dict[str, dict[str, list[float]]] = {name: {} for name in pools}
    for _ in range(repeats):
        for name, figures in found.items():
            taken = {}
            for workers in (1, 2):
                done = batch(plan, pools[name](workers), runs_per_task=1)
                threads = name == "threads"
                taken[workers] = done.arrival[-1] / tasks if threads else done.steady(done.arrival, 4 * workers)
                figures.setdefault(f"inside_{workers}", []).append(float(done.inside.mean()))
            figures.setdefault("speed_up", []).append(float(taken[1] / taken[2]))
    return found


class Overhead(NamedTuple):
    """Of tasks that do next to nothing."""

    each: float
    """Seconds a task, beside its realisation."""
    start: float
    """Seconds until the first is there."""
    caller: float
    """Processor seconds a task of the process that calls; NaN where the tasks are computed in it."""
    scheduler: float
    """Processor seconds a task of the cluster's scheduler; NaN where there is none."""


def overheads(tasks: int, workers: int, repeats: int) -> dict[str, Overhead]:
    """Of each scheduler, in turn; the first tenth of the tasks is left out."""
    plan = make_plan(tiny(batch={"realizations": tasks}))
    rows: dict[str, list[Overhead]] = {name: [] for name in SCHEDULERS}
    with cluster(workers) as (address, number), connected(address, None) as there:
        pools: dict[str, Pool] = {
            "threads": Threads(workers),
            "processes": Processes(workers),
            "distributed": there,
        }
        batch(plan, there, runs_per_task=1)  # the workers load what they need
        for _ in range(repeats):
            for name, pool in pools.items():
                done = batch(plan, pool, number if name == "distributed" else None, runs_per_task=1)
                skipped = tasks // 10
                inside = float(done.inside[skipped + 1 :].mean())
                each = done.steady(done.arrival, skipped) - inside / workers
                caller = math.nan if name == "threads" else done.steady(done.caller, skipped)
                own = Overhead(each, float(done.arrival[0]), caller, done.steady(done.scheduler, skipped))
                rows[name].append(own)
    return {name: Overhead(*np.median(np.array(row), axis=0).tolist()) for name, row in rows.items()}


def _processor_seconds(number: int) -> float:
    """Of a process so far."""
    fields = Path(f"/proc/{number}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


@contextmanager
def cluster(workers: int) -> Iterator[tuple[str, int]]:
    """A dask scheduler on loopback with workers of one thread, in processes that end with it: address, process id."""
    from distributed import Client

    def begun(*arguments: str) -> subprocess.Popen[bytes]:
        command = [sys.executable, "-P", "-m", "dask", *arguments, "--host", "127.0.0.1", "--no-dashboard"]
        return subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    with tempfile.TemporaryDirectory() as folder, ExitStack() as stack:
        file = Path(folder) / "scheduler.json"
        scheduler = begun("scheduler", "--port", "0", "--scheduler-file", str(file))
        stack.callback(_end, scheduler)
        for _ in range(workers):
            options = ["--scheduler-file", str(file), "--nthreads", "1", "--no-nanny", "--local-directory", folder]
            _wait_for(file, scheduler)
            stack.callback(_end, begun("worker", *options))
        address: str = json.loads(file.read_text())["address"]
        with Client(address, timeout=_PATIENCE, set_as_default=False) as client:
            client.wait_for_workers(workers, timeout=_PATIENCE)
        yield address, scheduler.pid


def _wait_for(file: Path, process: "subprocess.Popen[bytes]") -> None:
    latest = time.monotonic() + _PATIENCE
    while not file.exists() or not file.read_text().endswith("}"):
        if process.poll() is not None or time.monotonic() > latest:
            raise RuntimeError("the dask scheduler did not begin")
        time.sleep(0.05)


def _end(process: "subprocess.Popen[bytes]") -> None:
    process.terminate()
    try:
        process.wait(10.0)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()

"""The cost of a task by each scheduler, and the speed-up of two workers."""

import math
import os
import tempfile
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

import numpy as np

from benchmarks.child import small_scene
from roughmdr.batch.plan import Plan, make_plan
from roughmdr.batch.rounds import Rounds
from roughmdr.batch.task_result import TaskResult
from roughmdr.batch.tasks import split_into_tasks
from roughmdr.numerics.arguments import Floats
from roughmdr.runner.cluster import connected
from roughmdr.runner.local import Pool, Processes, Threads

SCHEDULERS = ("threads", "processes", "distributed")


class Timing(NamedTuple):
    """Times of a batch, one of each for every task in the order in which they came back."""

    arrival: Floats
    """Seconds since the start."""
    inside: Floats
    """Seconds in the realisations."""
    caller: Floats
    """Processor seconds of this process so far."""
    scheduler: Floats
    """Processor seconds of the cluster's scheduler so far; NaN where there is none."""

    def per_task(self, column: Floats, skipped: int) -> float:
        """Return what a task adds to a column, once ``skipped`` tasks have come back."""
        return float(column[-1] - column[skipped]) / (len(column) - 1 - skipped)


def timed_batch(plan: Plan, pool: Pool, scheduler_pid: int | None = None) -> Timing:
    """Compute the tasks of a plan by a pool."""
    rounds, variables = Rounds(plan), tuple(plan.scene.output.variables)
    tasks = split_into_tasks(plan, rounds.begin(), variables, pool.workers, runs_per_task=1)
    rows: list[tuple[float, float, float, float]] = []
    started = time.perf_counter()

    def sink(result: TaskResult) -> None:
        scheduler = math.nan if scheduler_pid is None else _processor_seconds(scheduler_pid)
        inside = float(result.diagnostics["run_time"].sum())
        rows.append((time.perf_counter() - started, inside, time.process_time(), scheduler))

    pool.compute(iter(tasks), threading.Event(), sink)
    return Timing(*np.array(rows).T)


def speed_ups(count: int, tasks: int, repeats: int) -> dict[str, dict[str, list[float]]]:
    """Measure for threads and processes how many times as fast two workers are as one, and the seconds inside a task.

    Taken in turn, on tasks of one large realisation. Threads count from the start on; processes once all have started,
    for which the first four tasks a worker are left out.
    """
    plan = make_plan(small_scene(count=count, steps=200, batch={"realizations": tasks}))
    pools: dict[str, Callable[[int], Pool]] = {"threads": Threads, "processes": Processes}
    timed_batch(plan, Threads(2))
    found: dict[str, dict[str, list[float]]] = {name: {} for name in pools}
    for _ in range(repeats):
        for name, figures in found.items():
            taken = {}
            for workers in (1, 2):
                batch = timed_batch(plan, pools[name](workers))
                threads = name == "threads"
                taken[workers] = batch.arrival[-1] / tasks if threads else batch.per_task(batch.arrival, 4 * workers)
                figures.setdefault(f"inside_{workers}", []).append(float(batch.inside.mean()))
            figures.setdefault("speed_up", []).append(float(taken[1] / taken[2]))
    return found


class Overhead(NamedTuple):
    """Times of tasks that do next to nothing."""

    each: float
    """Seconds a task, besides its realisation."""
    start: float
    """Seconds until the first is there."""
    caller: float
    """Processor seconds a task of the calling process; NaN where the tasks are computed in it."""
    scheduler: float
    """Processor seconds a task of the cluster's scheduler; NaN where there is none."""


def overheads(tasks: int, workers: int, repeats: int) -> dict[str, Overhead]:
    """Measure each scheduler, in turn; the first tenth of the tasks is left out."""
    plan = make_plan(small_scene(batch={"realizations": tasks}))
    rows: dict[str, list[Overhead]] = {name: [] for name in SCHEDULERS}
    skipped = tasks // 10
    with _cluster(workers) as (address, scheduler_pid), connected(address, None) as cluster:
        pools: dict[str, Pool] = dict(zip(SCHEDULERS, (Threads(workers), Processes(workers), cluster), strict=True))
        timed_batch(plan, cluster)  # the workers load what they need
        for _ in range(repeats):
            for name, pool in pools.items():
                batch = timed_batch(plan, pool, scheduler_pid if name == "distributed" else None)
                inside = float(batch.inside[skipped + 1 :].mean())
                each = batch.per_task(batch.arrival, skipped) - inside / workers
                caller = math.nan if name == "threads" else batch.per_task(batch.caller, skipped)
                scheduler = batch.per_task(batch.scheduler, skipped)
                rows[name].append(Overhead(each, float(batch.arrival[0]), caller, scheduler))
    return {name: Overhead(*np.median(np.array(row), axis=0).tolist()) for name, row in rows.items()}


def _processor_seconds(pid: int) -> float:
    """Return the processor time [s] of a process so far."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


@contextmanager
def _cluster(workers: int) -> Iterator[tuple[str, int]]:
    """Start a dask scheduler on loopback and workers of one thread, each a process: address and scheduler's process."""
    from distributed.deploy.subprocess import SubprocessCluster

    with (
        tempfile.TemporaryDirectory() as folder,
        SubprocessCluster(
            worker_class="distributed.Worker",
            n_workers=workers,
            threads_per_worker=1,
            dashboard_address="127.0.0.1:0",
            scheduler_kwargs={"dashboard": False},
            worker_kwargs={"local_directory": folder},
        ) as cluster,
    ):
        cluster.wait_for_workers(workers, timeout=60.0)
        yield cluster.scheduler_address, cluster.scheduler.process.pid

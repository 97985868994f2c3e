"""The cost of a task by each scheduler, and the speed-up of two workers."""

import itertools
import math
import os
import tempfile
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager
from pathlib import Path

import numpy as np
import xarray as xr
from studies.comparison import in_cases
from studies.study import named

from benchmarks.child import small_scene
from roughmdr.batch.plan import Plan, make_plan
from roughmdr.batch.rounds import Rounds
from roughmdr.batch.task_result import TaskResult
from roughmdr.batch.tasks import split_into_tasks
from roughmdr.numerics.arguments import Floats
from roughmdr.runner.backend import connected
from roughmdr.runner.local import Pool, Processes, Threads

SCHEDULERS = ("threads", "processes", "distributed")
_OVERHEADS = {
    "task_overhead": ("overhead of a task", "s"),
    "task_caller": ("processor time of the caller for a task", "s"),
    "task_scheduler": ("processor time of the scheduler for a task", "s"),
}
POOLS: dict[str, Callable[[int], Pool]] = {"threads": Threads, "processes": Processes}


def timed_batch(plan: Plan, pool: Pool, scheduler_pid: int | None = None) -> Floats:
    """Compute the tasks of a plan by a pool; return four columns with a value for each task that comes back.

    These are the seconds since the start, those in its realisations, and the processor seconds so far of this process
    and of the cluster's scheduler; NaN where there is none.
    """
    rounds, variables = Rounds(plan), tuple(plan.scene.output.variables)
    tasks = split_into_tasks(plan, rounds.begin(), variables, pool.workers, runs_per_task=1)
    rows: list[tuple[float, float, float, float]] = []
    started = time.perf_counter()

    def sink(result: TaskResult) -> None:
        scheduler = math.nan if scheduler_pid is None else _processor_seconds(scheduler_pid)
        inside = float(result.diagnostics["run_time"].sum())
        rows.append((time.perf_counter() - started, inside, time.process_time(), scheduler))

    pool.compute(iter(tasks), threading.Event(), sink)
    return np.array(rows).T


def by_workers(count: int, tasks: int, repeats: int) -> xr.Dataset:
    """Measure how many times as fast two workers are as one, each repeat, on tasks of one large realisation.

    It counts once all workers have started, which leaves out the first four tasks a worker.
    """
    plan = make_plan(small_scene(count=count, steps=200, batch={"realizations": tasks}))
    timed_batch(plan, Threads(2))
    each, inside = np.empty((2, len(POOLS), repeats, 2))
    for repeat, (i, pool), workers in itertools.product(range(repeats), enumerate(POOLS.values()), (1, 2)):
        arrival, seconds, *_ = timed_batch(plan, pool(workers))
        each[i, repeat, workers - 1], inside[i, repeat, workers - 1] = _per_task(arrival, 4 * workers), seconds.mean()
    over = ("pool", "repeat")
    variables = {
        "speed_up": (over, each[..., 0] / each[..., 1], named("time with one worker over time with two")),
        "task_time": (over, inside[..., 0], named("time in the realisation of a task, one worker", "s")),
    }
    return xr.Dataset(variables, {"pool": list(POOLS)})


def by_scheduler(tasks: int, repeats: int, workers: tuple[int, ...]) -> xr.Dataset:
    """Measure what a task costs that does next to nothing, for numbers of workers; medians."""
    found = [_overheads(tasks, count, repeats).T for count in workers]
    return xr.Dataset(
        in_cases(_OVERHEADS, found, "workers", "scheduler"),
        {"workers": list(workers), "scheduler": list(SCHEDULERS)},
        {"tasks": tasks},
    )


def _overheads(tasks: int, workers: int, repeats: int) -> Floats:
    """Return for each scheduler the seconds of a task beside its realisation, of the caller and of the scheduler.

    The first tenth of the tasks is left out. Threads have no caller beside them.
    """
    plan = make_plan(small_scene(batch={"realizations": tasks}))
    found, skipped = np.full((repeats, len(SCHEDULERS), 3), np.nan), tasks // 10
    with (
        _cluster(workers) as (address, scheduler_pid),
        connected(address, None) as cluster,
        closing(Processes(workers)) as processes,
    ):
        pools: tuple[Pool, ...] = (Threads(workers), processes, cluster)
        timed_batch(plan, cluster)  # the workers load what they need
        for repeat, (i, pool) in itertools.product(range(repeats), enumerate(pools)):
            arrival, inside, *processor = timed_batch(plan, pool, scheduler_pid if pool is cluster else None)
            found[repeat, i, 0] = _per_task(arrival, skipped) - inside[skipped + 1 :].mean() / workers
            found[repeat, i, 1:] = [_per_task(column, skipped) for column in processor]
    found[:, 0, 1] = np.nan
    return np.asarray(np.median(found, axis=0))


def _per_task(column: Floats, skipped: int) -> float:
    """Return what a task adds to a column, once ``skipped`` tasks have come back."""
    return float(column[-1] - column[skipped]) / (len(column) - 1 - skipped)


def _processor_seconds(pid: int) -> float:
    """Return the processor time [s] of a process so far."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


@contextmanager
def _cluster(workers: int) -> Iterator[tuple[str, int]]:
    """Start a dask scheduler on loopback and workers of one thread, each a process: address and scheduler's process."""
    from distributed.deploy.subprocess import SubprocessCluster

    with tempfile.TemporaryDirectory() as folder, SubprocessCluster(
        worker_class="distributed.Worker", n_workers=workers, threads_per_worker=1, dashboard_address="127.0.0.1:0",
        scheduler_kwargs={"dashboard": False}, worker_kwargs={"local_directory": folder},
    ) as cluster:  # fmt: skip
        cluster.wait_for_workers(workers, timeout=60.0)
        yield cluster.scheduler_address, cluster.scheduler.process.pid

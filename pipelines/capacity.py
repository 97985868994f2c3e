"""What a sweep over very many asperities would take: from what was measured on two cores to many workers.

Nothing here is measured on so many workers. What each part costs alone is measured; that they do not hinder each other
is assumed.
"""

import tempfile
import time
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from statistics import median

import numpy as np
from batch_child import tiny

from roughmdr.batch.diagnostics import row_of
from roughmdr.batch.moments import Moments, MomentTree
from roughmdr.batch.plan import Plan, make_plan
from roughmdr.batch.resume.store import locked_store
from roughmdr.batch.rounds import Rounds
from roughmdr.batch.task_result import TaskResult
from roughmdr.batch.tasks import split_into_tasks
from roughmdr.variables import DONE

ASPERITIES, CELLS, WORKERS = 1_000_000_000, 1000, 100
"""Of a cell; cells; threads of a cluster."""
ENSEMBLE = 1_000_000
"""Asperities of a realisation, of which a cell then has a thousand."""
_REPEATS = 30


@dataclass(frozen=True)
class Capacity:
    """Seconds and bytes of a sweep of ``CELLS`` cells of ``ASPERITIES`` asperities, 200 steps in and out."""

    runs: int
    tasks: int
    computing: float
    """Seconds of all cores together."""
    caller: float
    """Seconds of the process that calls, for its tasks and to put results together."""
    scheduler: float
    """Seconds of the cluster's scheduler."""
    writer: float
    """Seconds of the one thread that writes."""
    result: float
    """Bytes, where statistics are kept."""
    curves: float
    """Bytes, where curves are; the process that calls holds them about twice."""
    parts: float
    """Bytes of the task results that are kept until the result is written, one file a task."""
    ensemble: float
    """Bytes on a worker, for ensembles of ``ENSEMBLE``."""
    whole: float
    """Bytes on a worker, for one ensemble of all ``ASPERITIES``."""

    @property
    def wall(self) -> float:
        """Seconds with ``WORKERS`` workers: those of what is slowest."""
        return max(self.computing / WORKERS, self.caller, self.scheduler, self.writer)

    def table(self) -> str:
        """Line by line."""
        lines = [
            ("runs, tasks", f"{self.runs:,}, {self.tasks:,}"),
            ("computing", f"{self.computing / 3600:.0f} core-hours, {self.computing / 3600 / WORKERS:.1f} h each"),
            ("calling process", f"{self.caller / 3600:.2f} h"),
            ("scheduler", f"{self.scheduler / 3600:.2f} h"),
            ("writer", f"{self.writer / 3600:.2f} h"),
            ("most workers of use", f"{self.computing / max(self.caller, self.scheduler, self.writer):.0f}"),
            ("result, statistics", f"{self.result / 1e6:.0f} MB"),
            ("result, curves", f"{self.curves / 1e9:.1f} GB, held about twice: not to be done"),
            ("parts until the end", f"{self.parts / 1e9:.0f} GB in {self.tasks:,} files"),
            (f"memory, {ENSEMBLE:.0e} a run", f"{self.ensemble / 1e6:.0f} MB a worker"),
            (f"memory, {ASPERITIES:.0e} a run", f"{self.whole / 1e9:.0f} GB a worker"),
        ]
        return "\n".join(f"{name:<22} {value}" for name, value in lines)


def large() -> Plan:
    """The plan of the sweep, as ensembles of ``ENSEMBLE``."""
    return make_plan(
        tiny(
            count=ENSEMBLE,
            steps=200,
            output={"keep": "statistics"},
            batch={"realizations": ASPERITIES // ENSEMBLE},
            sweep={"adhesion.work": {"linspace": [0.01, 0.1], "num": CELLS}},
        )
    )


def writing(rows: int) -> tuple[float, float]:
    """Seconds to store a task result of moments safely, and its bytes; by the thread that writes."""
    steps, variables = 400, ("force", "contact_area", "contact_count", "stiffness")
    values = np.random.default_rng(1).normal(size=(2, len(variables), steps))
    moments = Moments.of(values[0]).merged(Moments.of(values[1]))
    rows_of_task = [(0, 2 * row, moments, row_of(run_time=1.0, status=DONE)) for row in range(rows)]
    result = TaskResult.of(["0" * 32], variables, rows_of_task, steps)
    times = []
    with tempfile.TemporaryDirectory() as folder, locked_store(Path(folder) / "result.nc") as parts:
        parts.begin("", "", "")
        for _ in range(_REPEATS):
            started = time.perf_counter()
            parts.write(result)
            times.append(time.perf_counter() - started)
        parts.clear()
    return median(times), float(len(result.to_bytes()))


def gathering() -> float:
    """Seconds that the calling process takes to add the moments of one more realisation to the others of its cell."""
    tree, values = MomentTree(), np.ones((4, 400))
    count = 2048
    started = time.perf_counter()
    for first in range(count):
        tree.add(first, Moments.of(values))
    return (time.perf_counter() - started) / count


def capacity(making: float, visiting: float, size: float, task: Mapping[str, float]) -> Capacity:
    """From seconds of making and visiting an asperity, its bytes, and seconds of a task by who spends them.

    ``task`` has "caller", "scheduler" and "writer", and "result", the bytes that are written.
    """
    plan = large()
    variables = plan.scene.output.variables
    tasks = split_into_tasks(plan, Rounds(plan).begin(), variables, WORKERS)
    runs = sum(each.last - each.first for one in tasks for each in one.ranges)
    curve = 8.0 * len(variables) * plan.steps
    return Capacity(
        runs=runs,
        tasks=len(tasks),
        computing=runs * ENSEMBLE * (making + visiting),
        caller=len(tasks) * (task["caller"] + gathering()),
        scheduler=len(tasks) * task["scheduler"],
        writer=len(tasks) * task["writer"],
        result=4.0 * curve * CELLS,
        curves=curve * runs,
        parts=len(tasks) * task["result"],
        ensemble=ENSEMBLE * size,
        whole=ASPERITIES * size,
    )

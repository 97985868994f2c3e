"""What a sweep over very many asperities would take: extrapolated from two cores to many workers.

What each part costs alone is measured; that parts and workers do not hinder each other is assumed.
"""

import tempfile
import time
from pathlib import Path
from statistics import median
from typing import NamedTuple

import numpy as np

from benchmarks.child import small_scene
from roughmdr.batch.moments import Moments, MomentTree
from roughmdr.batch.plan import make_plan
from roughmdr.batch.resume.store import locked_store
from roughmdr.batch.rounds import Rounds
from roughmdr.batch.task_result import RunDiagnostics, TaskResult, table_of
from roughmdr.batch.tasks import split_into_tasks

ASPERITIES, CELLS, WORKERS = 1_000_000_000, 1000, 100
"""Of a cell; cells; workers of one thread."""
ENSEMBLE = 1_000_000
"""Asperities of a realisation."""
_REPEATS = 30


class Costs(NamedTuple):
    """What was measured: times [s] and sizes [byte] of one asperity, and of one task."""

    drawing: float
    visiting: float
    asperity: float
    """Memory of an asperity [byte]."""
    caller: float
    """Time of a task in the calling process."""
    scheduler: float
    writer: float
    task_result: float
    """Size of a task result on disk [byte]."""


class Capacity(NamedTuple):
    """Times [s] and sizes [byte] of a sweep of ``CELLS`` cells of ``ASPERITIES`` asperities, 200 steps each way."""

    runs: int
    tasks: int
    computing: float
    """Of all cores together."""
    caller: float
    """Of the calling process, for its tasks and to put results together."""
    scheduler: float
    writer: float
    """Of the one thread that writes."""
    statistics: float
    """The result, where statistics are kept."""
    curves: float
    """The result, where curves are; the calling process holds it about twice."""
    task_results: float
    """What is kept until the result is written, one file a task."""
    ensemble: float
    """Memory of a worker, for ensembles of ``ENSEMBLE``."""
    whole: float
    """Memory of a worker, for one ensemble of all ``ASPERITIES``."""

    def rows(self) -> list[list[str]]:
        """Return the figures in words."""
        slowest = max(self.caller, self.scheduler, self.writer)
        return [
            ["runs, tasks", f"{self.runs:,}, {self.tasks:,}"],
            ["computing", f"{self.computing / 3600:.0f} core-hours, {self.computing / 3600 / WORKERS:.1f} h each"],
            ["calling process", f"{self.caller / 3600:.2f} h"],
            ["scheduler", f"{self.scheduler / 3600:.2f} h"],
            ["writer", f"{self.writer / 3600:.2f} h"],
            ["most workers of use", f"{self.computing / slowest:.0f}"],
            ["result, statistics", f"{self.statistics / 1e6:.0f} MB"],
            ["result, curves", f"{self.curves / 1e9:.1f} GB, held about twice: not to be done"],
            ["task results until the end", f"{self.task_results / 1e9:.0f} GB in {self.tasks:,} files"],
            [f"memory, {ENSEMBLE:.0e} a run", f"{self.ensemble / 1e6:.0f} MB a worker"],
            [f"memory, {ASPERITIES:.0e} a run", f"{self.whole / 1e9:.0f} GB a worker"],
        ]


def writing() -> tuple[float, float]:
    """Measure the time [s] to keep a task result of statistics safely, and its size [byte]."""
    steps, variables = 400, ("force", "contact_area", "contact_count", "stiffness")
    values = np.random.default_rng(1).normal(size=(2, len(variables), steps))
    moments = Moments.of(values[0]).joined(Moments.of(values[1]))
    result: TaskResult = table_of(["0" * 32], variables, [(0, 0, moments, RunDiagnostics(1.0))], steps)
    times = []
    with tempfile.TemporaryDirectory() as folder, locked_store(Path(folder) / "result.nc") as store:
        store.begin("", "", "")
        for _ in range(_REPEATS):
            started = time.perf_counter()
            store.put(result)
            times.append(time.perf_counter() - started)
        store.remove()
    return median(times), float(len(result.dumped()))


def collecting() -> float:
    """Measure the time [s] that the calling process takes to add the moments of one more task to those of its cell."""
    moments, values, count = MomentTree(), np.ones((4, 400)), 2048
    started = time.perf_counter()
    for first in range(count):
        moments.add(first, Moments.of(values))
    return (time.perf_counter() - started) / count


def capacity(costs: Costs) -> Capacity:
    """Extrapolate to the large sweep, computed as ensembles of ``ENSEMBLE``."""
    scene = small_scene(
        count=ENSEMBLE,
        steps=200,
        output={"keep": "statistics"},
        batch={"realizations": ASPERITIES // ENSEMBLE},
        sweep={"adhesion.work": {"linspace": [0.01, 0.1], "num": CELLS}},
    )
    plan, variables = make_plan(scene), scene.output.variables
    groups = split_into_tasks(plan, Rounds(plan).begin(), variables, WORKERS)
    runs, tasks = sum(each.last - each.first for group in groups for each in group), len(groups)
    curve = 8.0 * len(variables) * plan.cells[0].path.separation.size
    return Capacity(
        runs=runs,
        tasks=tasks,
        computing=runs * ENSEMBLE * (costs.drawing + costs.visiting),
        caller=tasks * (costs.caller + collecting()),
        scheduler=tasks * costs.scheduler,
        writer=tasks * costs.writer,
        statistics=4.0 * curve * CELLS,
        curves=curve * runs,
        task_results=tasks * costs.task_result,
        ensemble=ENSEMBLE * costs.asperity,
        whole=ASPERITIES * costs.asperity,
    )

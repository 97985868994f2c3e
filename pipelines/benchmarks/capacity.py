"""The time and memory of a sweep over very many asperities, extrapolated from two cores to many workers.

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
from roughmdr.batch.task_result import TaskResult, row_of
from roughmdr.batch.tasks import split_into_tasks

ASPERITIES, CELLS, WORKERS = 1_000_000_000, 1000, 100
"""Of a cell; cells; workers of one thread."""
ENSEMBLE = 1_000_000
"""Asperities of a realisation."""
_REPEATS = 30


class Costs(NamedTuple):
    """Measured times [s] and sizes [byte]: of an asperity, and of a task by who spends it."""

    drawing: float
    visiting: float
    asperity: float
    """Memory of an asperity."""
    caller: float
    scheduler: float
    writer: float
    task_result: float
    """Size of a task result on disk."""


def writing() -> tuple[float, float]:
    """Measure the time [s] to keep a task result of statistics safely, and its size [byte]."""
    steps, variables = 400, ("force", "contact_area", "contact_count", "stiffness")
    values = np.random.default_rng(1).normal(size=(2, len(variables), steps))
    moments = Moments.of(values[0]).merged(Moments.of(values[1]))
    result = TaskResult.of(["0" * 32], variables, [(0, 0, moments, row_of(run_time=1.0))], steps)
    times = []
    with tempfile.TemporaryDirectory() as folder, locked_store(Path(folder) / "result.nc") as store:
        store.begin("", "", "")
        for _ in range(_REPEATS):
            started = time.perf_counter()
            store.write(result)
            times.append(time.perf_counter() - started)
        store.clear()
    return median(times), float(len(result.to_bytes()))


def collecting() -> float:
    """Measure the time [s] that the calling process takes to add the moments of one more task to those of its cell."""
    moments, values, count = MomentTree(), np.ones((4, 400)), 2048
    started = time.perf_counter()
    for first in range(count):
        moments.add(first, Moments.of(values))
    return (time.perf_counter() - started) / count


def capacity(costs: Costs) -> dict[str, float]:
    """Return times [s] and sizes [byte] of the sweep, 200 steps each way, computed as ensembles of ``ENSEMBLE``."""
    scene = small_scene(
        count=ENSEMBLE,
        steps=200,
        output={"keep": "statistics"},
        batch={"realizations": ASPERITIES // ENSEMBLE},
        sweep={"adhesion.work": {"linspace": [0.01, 0.1], "num": CELLS}},
    )
    plan, variables = make_plan(scene), scene.output.variables
    tasks = split_into_tasks(plan, Rounds(plan).begin(), variables, WORKERS)
    runs = sum(each.last - each.first for task in tasks for each in task.ranges)
    curve = 8.0 * len(variables) * plan.cells[0].path.separation.size
    return {
        "runs": runs,
        "tasks": len(tasks),
        "computing": runs * ENSEMBLE * (costs.drawing + costs.visiting),  # of all cores together
        "caller": len(tasks) * (costs.caller + collecting()),
        "scheduler": len(tasks) * costs.scheduler,
        "writer": len(tasks) * costs.writer,
        "statistics": 4.0 * curve * CELLS,
        "curves": curve * runs,
        "task_results": len(tasks) * costs.task_result,
        "ensemble": ENSEMBLE * costs.asperity,
        "whole": ASPERITIES * costs.asperity,
    }


def rows(large: dict[str, float]) -> list[list[str]]:
    """Return what ``capacity`` found, line by line."""
    hours = {name: large[name] / 3600.0 for name in ("computing", "caller", "scheduler", "writer")}
    useful = hours["computing"] / max(hours[name] for name in ("caller", "scheduler", "writer"))
    return [
        ["runs, tasks", f"{large['runs']:,.0f}, {large['tasks']:,.0f}"],
        ["computing", f"{hours['computing']:.0f} core-hours, {hours['computing'] / WORKERS:.1f} h each"],
        *([name, f"{hours[name]:.2f} h"] for name in ("caller", "scheduler", "writer")),
        ["most workers of use", f"{useful:.0f}"],
        ["result, statistics", f"{large['statistics'] / 1e6:.0f} MB"],
        ["result, curves", f"{large['curves'] / 1e9:.1f} GB, held about twice: not to be done"],
        ["task results until the end", f"{large['task_results'] / 1e9:.0f} GB, one file a task"],
        [f"memory, {ENSEMBLE:.0e} a run", f"{large['ensemble'] / 1e6:.0f} MB a worker"],
        [f"memory, {ASPERITIES:.0e} a run", f"{large['whole'] / 1e9:.0f} GB a worker"],
    ]

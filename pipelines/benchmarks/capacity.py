"""The time and memory of a sweep over very many asperities, extrapolated from two cores to many workers.

What each part costs alone is measured; that parts and workers do not hinder each other is assumed.
"""

import tempfile
import time
from pathlib import Path
from statistics import median

import numpy as np
import xarray as xr
from studies.study import table

from benchmarks.child import small_scene
from roughmdr.batch.known_moments import KnownMoments
from roughmdr.batch.moments import Moments
from roughmdr.batch.plan import make_plan
from roughmdr.batch.resume.store import locked_store
from roughmdr.batch.rounds import Rounds
from roughmdr.batch.task_result import ResultRow, TaskResult, row_of
from roughmdr.batch.tasks import split_into_tasks
from roughmdr.loading.pull_off import PullOff

ASPERITIES, CELLS, WORKERS = 1_000_000_000, 1000, 100
"""Asperities of a cell; cells; workers of one thread."""
ENSEMBLE = 1_000_000
"""Asperities of a realisation."""
PREFIX = "large_"
"""Beginning of the attributes of a result that are extrapolated."""
_REPEATS = 30


def writing() -> tuple[float, float]:
    """Measure the time [s] to keep a task result of statistics safely, and its size [byte]."""
    steps, variables = 400, ("force", "contact_area", "contact_count", "stiffness")
    values = np.random.default_rng(1).normal(size=(2, len(variables), steps))
    moments = Moments.of(values[0]).merged(Moments.of(values[1]))
    pull_off = KnownMoments.of(np.array(PullOff()))
    pull_off = pull_off.merged(pull_off)
    result = TaskResult.of(["0" * 32], variables, [ResultRow(0, 0, moments, pull_off, row_of(run_time=1.0))], steps)
    times = []
    with tempfile.TemporaryDirectory() as folder, locked_store(Path(folder) / "result.nc") as store:
        store.begin("", "", "", "")
        for _ in range(_REPEATS):
            started = time.perf_counter()
            store.write(result)
            times.append(time.perf_counter() - started)
        store.clear()
    return median(times), float(len(result.to_bytes()))


def capacity(result: xr.Dataset) -> dict[str, float]:
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
    of_task = result.sel(scheduler="distributed").isel(workers=-1)
    by_part = {"caller": of_task.task_caller, "scheduler": of_task.task_scheduler, "writer": result.writing_time}
    return {
        "runs": runs,
        "tasks": len(tasks),
        "computing": runs * ENSEMBLE * float(result.drawing_time + result.visiting_time),  # of all cores together
        **{name: len(tasks) * float(seconds) for name, seconds in by_part.items()},
        "statistics": 4.0 * curve * CELLS,
        "curves": curve * runs,
        "task_results": len(tasks) * float(result.result_size),
        "ensemble": ENSEMBLE * float(result.asperity_memory),
        "whole": ASPERITIES * float(result.asperity_memory),
    }


def report(result: xr.Dataset) -> str:
    """Return a table of what ``capacity`` found."""
    large = {name.removeprefix(PREFIX): number for name, number in result.attrs.items() if name.startswith(PREFIX)}
    hours = {name: large[name] / 3600.0 for name in ("computing", "caller", "scheduler", "writer")}
    computing = hours.pop("computing")
    rows = [
        ["runs, tasks", f"{large['runs']:,.0f}, {large['tasks']:,.0f}"],
        ["computing", f"{computing:.0f} core-hours, {computing / WORKERS:.1f} h each"],
        *([name, f"{each:.2f} h"] for name, each in hours.items()),
        ["most workers of use", f"{computing / max(hours.values()):.0f}"],
        ["result, statistics", f"{large['statistics'] / 1e6:.0f} MB"],
        ["result, curves", f"{large['curves'] / 1e9:.1f} GB, held about twice: not to be done"],
        ["task results until the end", f"{large['task_results'] / 1e9:.0f} GB, one file a task"],
        [f"memory, {ENSEMBLE:.0e} a run", f"{large['ensemble'] / 1e6:.0f} MB a worker"],
        [f"memory, {ASPERITIES:.0e} a run", f"{large['whole'] / 1e9:.0f} GB a worker"],
    ]
    return table([f"{CELLS} cells of {ASPERITIES:,} asperities", f"{WORKERS} workers, extrapolated"], rows)

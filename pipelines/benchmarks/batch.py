"""The costs of the batch engine: a cell, a task, memory, a second worker; extrapolated to a very large sweep.

What each part costs alone is measured; that parts and workers do not hinder each other is assumed.
"""

import tempfile
from collections.abc import Callable
from pathlib import Path
from statistics import median

import numpy as np
import xarray as xr
from studies.comparison import in_cases
from studies.study import Study, named, table, timed

from benchmarks import child
from benchmarks.tasks import by_scheduler, by_workers
from roughmdr.batch.moments import KnownMoments, Moments
from roughmdr.batch.plan import make_plan
from roughmdr.batch.resume.store import locked_store
from roughmdr.batch.rounds import Rounds
from roughmdr.batch.task_result import ResultRow, TaskResult, row_of
from roughmdr.batch.tasks import split_into_tasks
from roughmdr.loading.pull_off import PullOff

PARTS = ("reading", "planning", "running")
ASPERITIES, CELLS, WORKERS = 1_000_000_000, 1000, 100  # asperities of a cell; cells; workers of one thread
ENSEMBLE = 1_000_000  # asperities of a realisation
PREFIX = "large_"  # beginning of the attributes of a result that are extrapolated
_REPEATS = 30
_STATISTICS = {
    "peak_memory": ("resident memory at most", "byte"),
    "memory_before": ("before the first realisation", "byte"),
    "statistics_time": ("time of the batch, one worker", "s"),
}
_ASPERITY = {
    "drawing_time": ("time to draw and sort an asperity", "s"),
    "visiting_time": ("time to visit an asperity, 200 steps each way", "s"),
    "asperity_memory": ("memory of an asperity", "byte"),
    "writing_time": ("time to keep a task result", "s"),
    "result_size": ("a task result of one row of statistics, 400 steps", "byte"),
}


def _medians(function: Callable[[int], dict[str, float]], count: int, repeats: int) -> dict[str, float]:
    found = [child.in_new_process(function, count) for _ in range(repeats)]
    return {name: median(each[name] for each in found) for name in found[0]}


def by_cell(cells: int, repeats: int) -> xr.Dataset:
    """Measure the overhead of a cell, by what it is spent on."""
    found = _medians(child.cells, cells, repeats)
    overhead = [found[name] / cells for name in PARTS]
    variables = {
        "cell_overhead": ("part", overhead, named("overhead of a cell, one worker", "s")),
        "cell_time": ((), found["realisations"] / cells, named("time in the realisation of a cell", "s")),
        "cell_runs": ((), found["runs"], named("cells that were run")),
    }
    return xr.Dataset(variables, {"part": list(PARTS)}, {"cells": cells})


def by_realizations(counts: list[int]) -> xr.Dataset:
    """Measure memory and time by the number of realisations, where statistics are kept."""
    found = [child.in_new_process(child.statistics, count) for count in counts]
    return xr.Dataset(in_cases(_STATISTICS, found, "realizations"), {"realizations": counts})


def by_asperity(count: int, repeats: int) -> xr.Dataset:
    """Measure time and memory of an asperity in large ensembles, and of a task result."""
    seconds, size = writing()
    found = {**_medians(child.ensemble, count, repeats), "writing_time": seconds, "result_size": size}
    return xr.Dataset(in_cases(_ASPERITY, [found], "one"), attrs={"asperities": count}).squeeze("one")


def writing() -> tuple[float, float]:
    """Measure the time [s] to keep a task result of statistics safely, and its size [byte]."""
    steps, variables = 400, ("force", "contact_area", "contact_count", "stiffness")
    values = np.random.default_rng(1).normal(size=(2, len(variables), steps))
    moments = Moments.of(values[0]).merged(Moments.of(values[1]))
    pull_off = KnownMoments.of(np.array(PullOff()))
    pull_off = pull_off.merged(pull_off)
    result = TaskResult.of(["0" * 32], variables, [ResultRow(0, 0, moments, pull_off, row_of(run_time=1.0))], steps)
    with tempfile.TemporaryDirectory() as folder, locked_store(Path(folder) / "result.nc") as store:
        store.begin("", "", "", "")
        times = [timed(lambda: store.write(result))[1] for _ in range(_REPEATS)]
        store.clear()
    return median(times), float(len(result.to_bytes()))


def capacity(result: xr.Dataset) -> dict[str, float]:
    """Return times [s] and sizes [byte] of the sweep, 200 steps each way, computed as ensembles of ``ENSEMBLE``."""
    sweep, output = {"adhesion.work": {"linspace": [0.01, 0.1], "num": CELLS}}, {"keep": "statistics"}
    batch = {"realizations": ASPERITIES // ENSEMBLE}
    scene = child.small_scene(count=ENSEMBLE, steps=200, output=output, batch=batch, sweep=sweep)
    plan, variables = make_plan(scene), scene.output.variables
    tasks = split_into_tasks(plan, Rounds(plan).begin(), variables, WORKERS)
    runs = sum(each.last - each.first for task in tasks for each in task.ranges)
    curve = 8.0 * len(variables) * plan.cells[0].path.separation.size
    of_task = result.sel(scheduler="distributed").isel(workers=-1)
    return {
        "runs": runs,
        "tasks": len(tasks),
        "computing": runs * ENSEMBLE * float(result.drawing_time + result.visiting_time),  # summed over the cores
        "caller": len(tasks) * float(of_task.task_caller),
        "scheduler": len(tasks) * float(of_task.task_scheduler),
        "writer": len(tasks) * float(result.writing_time),
        "statistics": 4.0 * curve * CELLS,
        "curves": curve * runs,
        "task_results": len(tasks) * float(result.result_size),
        "ensemble": ENSEMBLE * float(result.asperity_memory),
        "whole": ASPERITIES * float(result.asperity_memory),
    }


def measure(quick: bool) -> xr.Dataset:
    """Return all figures; ``quick`` with few of everything."""
    for scene in (child.sweep_of(4), child.small_scene(unload=False)):
        child.compiled_plan(scene)
    parts = [
        by_cell(*((200, 1) if quick else (10_000, 3))),
        by_scheduler(*((60, 1, (2,)) if quick else (500, 3, (1, 2)))),
        by_workers(*((2_000, 24, 1) if quick else (100_000, 32, 5))),
        by_asperity(*((200_000, 1) if quick else (1_000_000, 3))),
        by_realizations([1_000, 10_000] if quick else [10_000, 100_000, 1_000_000]),
    ]
    result = xr.merge(parts, combine_attrs="no_conflicts")
    return result.assign_attrs({PREFIX + name: number for name, number in capacity(result).items()})


def tables(result: xr.Dataset) -> str:
    """Return a table in Markdown for each set of dimensions, a row for each place along them."""
    found = []
    for dims in dict.fromkeys(array.dims for array in result.values()):
        names = [str(name) for name, array in result.items() if array.dims == dims]
        rows = []
        for place in np.ndindex(*(result.sizes[dim] for dim in dims)):
            one = result.isel(dict(zip(dims, place, strict=True)))
            keys = [str(result[dim].to_numpy()[number]) for dim, number in zip(dims, place, strict=True)]
            rows.append([*keys, *(f"{float(one[name]):.4g}" for name in names)])
        found.append(table([*map(str, dims), *(f"{name} [{result[name].attrs['units']}]" for name in names)], rows))
    return "\n\n".join(found)


def extrapolated(result: xr.Dataset) -> str:
    """Return a table of the ``capacity``."""
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


def report(result: xr.Dataset) -> str:
    """Return the figures in tables."""
    return f"{tables(result)}\n\n{extrapolated(result)}"


STUDY = Study(
    "batch", "What the batch engine costs", measure, {}, report,
    "few cells, tasks, asperities and realisations, each timed once",
)  # fmt: skip

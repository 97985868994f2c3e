"""What the batch engine costs: a cell, a task, memory, a second worker; and what a very large sweep would take."""

from statistics import median

import numpy as np
import xarray as xr
from studies.study import named, table

from benchmarks import child
from benchmarks.batch_picture import CELL_GOAL, MEMORY_GOAL, SPEED_GOAL
from benchmarks.capacity import ASPERITIES, CELLS, WORKERS, Capacity, Costs, capacity, writing
from benchmarks.process import in_new_process
from benchmarks.tasks import SCHEDULERS, overheads, speed_ups

PARTS = ("loading", "reading", "planning", "keys", "tasks", "file")
_WORKERS = (1, 2)


def _medians(rows: list[dict[str, float]]) -> dict[str, float]:
    return {name: median(row[name] for row in rows) for name in rows[0]}


def by_cell(cells: int, repeats: int) -> xr.Dataset:
    """Measure the overhead of a cell, by what it is spent on; medians."""
    found = _medians([in_new_process(child.cells, cells) for _ in range(repeats)])
    overhead = [found[name] / cells for name in PARTS]
    return xr.Dataset(
        {
            "cell_overhead": ("part", overhead, named("overhead of a cell, one worker", "s")),
            "cell_time": ((), found["realisations"] / cells, named("time in the realisation of a cell", "s")),
            "cell_size": ((), found["size"] / cells, named("a cell in the file", "byte")),
            "cell_runs": ((), found["runs"], named("cells that were run")),
        },
        coords={"part": list(PARTS)},
        attrs={"cells": cells},
    )


def by_realizations(counts: list[int]) -> xr.Dataset:
    """Measure memory and time by the number of realisations, where statistics are kept."""
    rows = [in_new_process(child.statistics, count) for count in counts]
    names = {
        "peak_memory": ("peak", named("resident memory at most", "byte")),
        "memory_before": ("before", named("before the first realisation", "byte")),
        "statistics_time": ("seconds", named("time of the batch, one worker", "s")),
    }
    variables = {name: ("realizations", [row[key] for row in rows], about) for name, (key, about) in names.items()}
    return xr.Dataset(variables, {"realizations": counts})


def by_scheduler(tasks: int, repeats: int, workers: tuple[int, ...]) -> xr.Dataset:
    """Measure what a task costs that does next to nothing, for numbers of workers; medians."""
    found = [overheads(tasks, count, repeats) for count in workers]
    names = {
        "task_overhead": ("each", "overhead of a task"),
        "start": ("start", "time until the first task is done"),
        "task_caller": ("caller", "processor time a task of the process that calls"),
        "task_scheduler": ("scheduler", "processor time a task of the scheduler of the cluster"),
    }
    variables = {}
    for name, (field, text) in names.items():
        values = [[getattr(each[scheduler], field) for scheduler in SCHEDULERS] for each in found]
        variables[name] = (("workers", "scheduler"), values, named(text, "s"))
    return xr.Dataset(variables, {"workers": list(workers), "scheduler": list(SCHEDULERS)}, {"tasks": tasks})


def by_workers(count: int, tasks: int, repeats: int) -> xr.Dataset:
    """Measure how much faster two workers are than one, each repeat."""
    found = speed_ups(count, tasks, repeats)
    ups = [figures["speed_up"] for figures in found.values()]
    inside = [[figures[f"inside_{workers}"] for workers in _WORKERS] for figures in found.values()]
    return xr.Dataset(
        {
            "speed_up": (("pool", "repeat"), ups, named("time with one worker over time with two")),
            "task_time": (("pool", "used", "repeat"), inside, named("time in the realisation of a task", "s")),
        },
        coords={"pool": list(found), "used": list(_WORKERS)},
    )


def by_asperity(count: int, repeats: int) -> xr.Dataset:
    """Measure time and memory of an asperity in ensembles of ``count`` and of a tenth of it, and of a task result."""
    counts = [count // 10, count]
    rows = [_medians([in_new_process(child.ensemble, number) for _ in range(repeats)]) for number in counts]
    seconds, size = writing()
    each = {name: [row[name] / n for n, row in zip(counts, rows, strict=True)] for name in ("drawing", "visiting")}
    memory = (rows[1]["size"] - rows[0]["size"]) / (counts[1] - counts[0])
    return xr.Dataset(
        {
            "drawing_time": ("asperities", each["drawing"], named("time to draw and sort an asperity", "s")),
            "visiting_time": ("asperities", each["visiting"], named("time of an asperity, 200 steps each way", "s")),
            "asperity_memory": ((), memory, named("memory of one more asperity", "byte")),
            "writing_time": ((), seconds, named("time to keep a task result", "s")),
            "result_size": ((), size, named("a task result of one row of statistics, 400 steps", "byte")),
        },
        coords={"asperities": counts},
    )


def measure(quick: bool) -> xr.Dataset:
    """Return all figures; ``quick`` with few of everything."""
    for scene in (child.sweep_of(4), child.small_scene(unload=False)):
        child.compiled_plan(scene)
    parts = [
        by_cell(*((200, 1) if quick else (10_000, 3))),
        by_scheduler(*((60, 1, _WORKERS[1:]) if quick else (500, 3, _WORKERS))),
        by_workers(*((2_000, 24, 1) if quick else (100_000, 32, 5))),
        by_asperity(*((20_000, 1) if quick else (1_000_000, 3))),
        by_realizations([1_000, 10_000] if quick else [10_000, 100_000, 1_000_000]),
    ]
    result = xr.merge(parts, combine_attrs="no_conflicts")
    extrapolated = capacity(_costs(result))
    return result.assign_attrs({f"large_{name}": value for name, value in extrapolated._asdict().items()})


def _costs(result: xr.Dataset) -> Costs:
    task = result.sel(scheduler="distributed", workers=max(_WORKERS)).isel(asperities=-1)
    names = "drawing_time", "visiting_time", "asperity_memory", "task_caller", "task_scheduler", "writing_time"
    return Costs(*(float(task[name]) for name in (*names, "result_size")))


def report(result: xr.Dataset) -> str:
    """Return the figures in tables."""
    milliseconds, ups = 1e3 * result.cell_overhead.to_numpy(), result.speed_up
    memory = []
    for count in result.realizations.to_numpy():
        row = result.sel(realizations=count)
        memory.append([f"{count:,}", f"{float(row.peak_memory) / 1e6:.0f}", f"{float(row.statistics_time):.1f}"])
    workers = []
    for pool in ups.pool.to_numpy():
        values, inside = ups.sel(pool=pool).to_numpy(), 1e3 * float(result.task_time.sel(pool=pool, used=1).median())
        workers.append([str(pool), f"{np.median(values):.2f}", f"{values.max():.2f}", f"{inside:.0f}"])
    tasks = []
    for name in ("task_overhead", "task_caller", "task_scheduler"):
        for count in result.workers.to_numpy():
            each = [f"{1e3 * value:.3f}" for value in result[name].sel(workers=count).to_numpy()]
            tasks.append([f"{name.removeprefix('task_')}, {count} workers", *each])
    costs = _costs(result)
    large = Capacity(*(result.attrs[f"large_{name}"] for name in Capacity._fields))
    return "\n\n".join(
        [
            f"A cell costs {milliseconds.sum():.3f} ms (goal {CELL_GOAL}) beside its realisation, "
            f"{1e3 * float(result.cell_time):.3f} ms:",
            table([*PARTS], [[f"{each:.4f}" for each in milliseconds]]),
            f"Memory, statistics kept (goal {MEMORY_GOAL:.0f} MB):",
            table(["realisations", "MB", "s"], memory),
            f"Two workers for one (goal {SPEED_GOAL}):",
            table(["pool", "median", "best", "ms a task"], workers),
            table(["ms a task", *SCHEDULERS], tasks),
            f"An asperity is drawn in {1e9 * costs.drawing:.0f} ns, visited in {1e9 * costs.visiting:.0f} ns, takes "
            f"{costs.asperity:.0f} bytes; a task result {1e-3 * costs.task_result:.0f} kB and "
            f"{1e3 * costs.writer:.1f} ms.",
            table([f"{CELLS} cells of {ASPERITIES:,} asperities", f"{WORKERS} workers, extrapolated"], large.rows()),
        ]
    )

"""The costs of the batch engine: a cell, a task, memory, a second worker; extrapolated to a very large sweep."""

from statistics import median

import numpy as np
import xarray as xr
from studies.study import named, table

from benchmarks import child
from benchmarks.batch_picture import CELL_GOAL, MEMORY_GOAL, SPEED_GOAL
from benchmarks.capacity import ASPERITIES, CELLS, WORKERS, Costs, capacity, rows, writing
from benchmarks.process import in_new_process
from benchmarks.tasks import SCHEDULERS, Overhead, overheads, speed_ups

PARTS = ("loading", "reading", "planning", "keys", "tasks", "file")
_WORKERS = (1, 2)
_LARGE = "large_"  # of the attributes that are extrapolated


def _medians(found: list[dict[str, float]]) -> dict[str, float]:
    return {name: median(each[name] for each in found) for name in found[0]}


def by_cell(cells: int, repeats: int) -> xr.Dataset:
    """Measure the overhead of a cell, by what it is spent on; medians."""
    found = _medians([in_new_process(child.cells, cells) for _ in range(repeats)])
    overhead = [found[name] / cells for name in PARTS]
    variables = {
        "cell_overhead": ("part", overhead, named("overhead of a cell, one worker", "s")),
        "cell_time": ((), found["realisations"] / cells, named("time in the realisation of a cell", "s")),
        "cell_size": ((), found["size"] / cells, named("a cell in the file", "byte")),
        "cell_runs": ((), found["runs"], named("cells that were run")),
    }
    return xr.Dataset(variables, {"part": list(PARTS)}, {"cells": cells})


def by_realizations(counts: list[int]) -> xr.Dataset:
    """Measure memory and time by the number of realisations, where statistics are kept."""
    found = [in_new_process(child.statistics, count) for count in counts]
    peak, before, seconds = ([each[name] for each in found] for name in ("peak", "before", "seconds"))
    variables = {
        "peak_memory": ("realizations", peak, named("resident memory at most", "byte")),
        "memory_before": ("realizations", before, named("before the first realisation", "byte")),
        "statistics_time": ("realizations", seconds, named("time of the batch, one worker", "s")),
    }
    return xr.Dataset(variables, {"realizations": counts})


def by_scheduler(tasks: int, repeats: int, workers: tuple[int, ...]) -> xr.Dataset:
    """Measure what a task costs that does next to nothing, for numbers of workers; medians."""
    found = [overheads(tasks, count, repeats) for count in workers]
    values = np.array([[each[scheduler] for scheduler in SCHEDULERS] for each in found])  # [workers, scheduler, field]
    about = dict(
        zip(
            ("task_overhead", "start", "task_caller", "task_scheduler"),
            ("overhead", "time until the first", "processor time of the caller", "processor time of the scheduler"),
            strict=True,
        )
    )
    variables = {
        name: (("workers", "scheduler"), values[:, :, field], named(f"{about[name]} of a task", "s"))
        for field, name in zip(range(len(Overhead._fields)), about, strict=True)
    }
    return xr.Dataset(variables, {"workers": list(workers), "scheduler": list(SCHEDULERS)}, {"tasks": tasks})


def by_workers(count: int, tasks: int, repeats: int) -> xr.Dataset:
    """Measure how much faster two workers are than one, each repeat."""
    found = speed_ups(count, tasks, repeats)
    ups = [figures["speed_up"] for figures in found.values()]
    inside = [[figures[f"inside_{workers}"] for workers in _WORKERS] for figures in found.values()]
    variables = {
        "speed_up": (("pool", "repeat"), ups, named("time with one worker over time with two")),
        "task_time": (("pool", "used", "repeat"), inside, named("time in the realisation of a task", "s")),
    }
    return xr.Dataset(variables, {"pool": list(found), "used": list(_WORKERS)})


def by_asperity(count: int, repeats: int) -> xr.Dataset:
    """Measure time and memory of an asperity in large ensembles, and of a task result."""
    few, many = (
        _medians([in_new_process(child.ensemble, number) for _ in range(repeats)]) for number in (count // 10, count)
    )
    seconds, size = writing()
    memory = (many["size"] - few["size"]) / (count - count // 10)
    variables = {
        "drawing_time": ((), many["drawing"] / count, named("time to draw and sort an asperity", "s")),
        "visiting_time": ((), many["visiting"] / count, named("time to visit an asperity, 200 steps each way", "s")),
        "asperity_memory": ((), memory, named("memory of one more asperity", "byte")),
        "writing_time": ((), seconds, named("time to keep a task result", "s")),
        "result_size": ((), size, named("a task result of one row of statistics, 400 steps", "byte")),
    }
    return xr.Dataset(variables, attrs={"asperities": count})


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
    return result.assign_attrs({_LARGE + name: value for name, value in capacity(_costs(result)).items()})


def _costs(result: xr.Dataset) -> Costs:
    task = result.sel(scheduler="distributed", workers=max(_WORKERS))
    names = "drawing_time", "visiting_time", "asperity_memory", "task_caller", "task_scheduler", "writing_time"
    return Costs(*(float(task[name]) for name in (*names, "result_size")))


def report(result: xr.Dataset) -> str:
    """Return the figures in tables."""
    cell, memory = 1e3 * result.cell_overhead.to_numpy(), 1e-6 * result.peak_memory.to_numpy()
    runs = zip(result.realizations.to_numpy(), memory, result.statistics_time.to_numpy(), strict=True)
    inside = 1e3 * result.task_time.sel(used=1).median("repeat").to_numpy()
    pools = zip(result.pool.to_numpy(), result.speed_up.to_numpy(), inside, strict=True)
    tasks = [
        [f"{name}, workers: {count}", *(f"{1e3 * each:.3f}" for each in result[name].sel(workers=count).to_numpy())]
        for name in ("task_overhead", "task_caller", "task_scheduler")
        for count in result.workers.to_numpy()
    ]
    costs = _costs(result)
    large = {name.removeprefix(_LARGE): value for name, value in result.attrs.items() if name.startswith(_LARGE)}
    return "\n\n".join(
        [
            f"A cell costs {cell.sum():.3f} ms (goal {CELL_GOAL}) beside its realisation, "
            f"{1e3 * float(result.cell_time):.3f} ms:",
            table([*PARTS], [[f"{each:.4f}" for each in cell]]),
            f"Memory, statistics kept (goal {MEMORY_GOAL:.0f} MB):",
            table(["realisations", "MB", "s"], [[f"{n:,}", f"{mb:.0f}", f"{s:.1f}"] for n, mb, s in runs]),
            f"Two workers for one (goal {SPEED_GOAL}):",
            table(
                ["pool", "median", "best", "ms a task"],
                [[str(name), f"{np.median(ups):.2f}", f"{ups.max():.2f}", f"{ms:.0f}"] for name, ups, ms in pools],
            ),
            table(["ms a task", *SCHEDULERS], tasks),
            f"An asperity is drawn in {1e9 * costs.drawing:.0f} ns, visited in {1e9 * costs.visiting:.0f} ns, takes "
            f"{costs.asperity:.0f} bytes; a task result {1e-3 * costs.task_result:.0f} kB and "
            f"{1e3 * costs.writer:.1f} ms.",
            table([f"{CELLS} cells of {ASPERITIES:,} asperities", f"{WORKERS} workers, extrapolated"], rows(large)),
        ]
    )

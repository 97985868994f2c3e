"""The costs of the batch engine: a cell, a task, memory, a second worker; extrapolated to a very large sweep."""

from collections.abc import Callable
from statistics import median

import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from studies.study import Study, named, table

from benchmarks import capacity, child
from benchmarks.process import in_new_process
from benchmarks.tasks import by_scheduler, by_workers

PARTS = ("reading", "planning", "running")
CELL_GOAL, MEMORY_GOAL, SPEED_GOAL = 0.3, 500.0, 1.85
"""[ms] a cell, [MB], times."""


def _medians(function: Callable[[int], dict[str, float]], count: int, repeats: int) -> dict[str, float]:
    found = [in_new_process(function, count) for _ in range(repeats)]
    return {name: median(each[name] for each in found) for name in found[0]}


def by_cell(cells: int, repeats: int) -> xr.Dataset:
    """Measure the overhead of a cell, by what it is spent on."""
    found = _medians(child.cells, cells, repeats)
    variables = {
        "cell_overhead": (
            "part",
            [found[name] / cells for name in PARTS],
            named("overhead of a cell, one worker", "s"),
        ),
        "cell_time": ((), found["realisations"] / cells, named("time in the realisation of a cell", "s")),
        "cell_runs": ((), found["runs"], named("cells that were run")),
    }
    return xr.Dataset(variables, {"part": list(PARTS)}, {"cells": cells})


def by_realizations(counts: list[int]) -> xr.Dataset:
    """Measure memory and time by the number of realisations, where statistics are kept."""
    found = [in_new_process(child.statistics, count) for count in counts]
    about = {
        "peak_memory": named("resident memory at most", "byte"),
        "memory_before": named("before the first realisation", "byte"),
        "statistics_time": named("time of the batch, one worker", "s"),
    }
    variables = {name: ("realizations", [each[name] for each in found], about[name]) for name in about}
    return xr.Dataset(variables, {"realizations": counts})


def by_asperity(count: int, repeats: int) -> xr.Dataset:
    """Measure time and memory of an asperity in large ensembles, and of a task result."""
    seconds, size = capacity.writing()
    found = {**_medians(child.ensemble, count, repeats), "writing_time": seconds, "result_size": size}
    about = {
        "drawing_time": named("time to draw and sort an asperity", "s"),
        "visiting_time": named("time to visit an asperity, 200 steps each way", "s"),
        "asperity_memory": named("memory of an asperity", "byte"),
        "writing_time": named("time to keep a task result", "s"),
        "result_size": named("a task result of one row of statistics, 400 steps", "byte"),
    }
    return xr.Dataset({name: ((), found[name], about[name]) for name in about}, attrs={"asperities": count})


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
    large = capacity.capacity(result)
    return result.assign_attrs({capacity.PREFIX + name: number for name, number in large.items()})


def draw(result: xr.Dataset) -> Figure:
    """Draw the overheads of a cell and of a task, memory, and the speed-up of two workers."""
    figure = Figure(figsize=(13, 3.9), layout="constrained")
    cells, memory, tasks, workers = figure.subplots(1, 4)
    for ax, values, title in (
        (cells, result.cell_overhead, "Overhead of a cell [ms]"),
        (tasks, result.task_overhead.isel(workers=-1), "Overhead of a task, two workers [ms]"),
    ):
        bars = ax.bar(values[values.dims[0]].to_numpy(), 1e3 * values.to_numpy())
        ax.bar_label(bars, fmt="%.3g")
        ax.set_title(title)
    for name in ("peak_memory", "memory_before"):
        memory.semilogx(result.realizations, result[name] / 1e6, "o-", label=result[name].attrs["long_name"])
    memory.set(title="Memory, statistics kept [MB]", xlabel="realisations", ylim=(0.0, MEMORY_GOAL))
    memory.legend(frameon=False)
    workers.plot(result.pool, result.speed_up, "C0o", alpha=0.5)
    workers.plot(result.pool, result.speed_up.median("repeat"), "C0_", ms=30)
    workers.set(title="Two workers for one, times as fast", xlim=(-0.5, 1.5))
    return figure


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


def report(result: xr.Dataset) -> str:
    """Return the figures in tables."""
    cell, memory, up = result.cell_overhead.sum(), result.peak_memory.max(), result.speed_up.median("repeat").to_numpy()
    goals = (
        f"A cell costs {1e3 * float(cell):.3f} ms (goal {CELL_GOAL}) beside its realisation; statistics take "
        f"{1e-6 * float(memory):.0f} MB at most (goal {MEMORY_GOAL:.0f}); two workers are {up[0]:.2f} times as fast as "
        f"one on threads, {up[1]:.2f} times on processes (goal {SPEED_GOAL})."
    )
    return f"{goals}\n\n{tables(result)}\n\n{capacity.report(result)}"


STUDY = Study(
    "batch", "What the batch engine costs", measure, draw, report,
    "few cells, tasks, asperities and realisations, each timed once",
)  # fmt: skip

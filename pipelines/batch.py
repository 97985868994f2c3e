"""What the batch engine costs: a cell, a task, memory, a second worker; and what a very large sweep would take.

    python pipelines/batch.py -o results/studies

Writes batch.nc and batch.png. Needs /proc and distributed; takes ten minutes or more, since it runs a million
realisations.
"""

from dataclasses import asdict
from pathlib import Path

import click
import numpy as np
import xarray as xr
from batch_child import swept, tiny
from batch_measured import SCHEDULERS, child, medians, overheads, speed_ups
from batch_pictures import CELL_GOAL, MEMORY_GOAL, SPEED_GOAL, draw
from capacity import ASPERITIES, CELLS, WORKERS, Capacity, capacity, writing

from roughmdr.batch.compile import prepare_all
from roughmdr.batch.plan import make_plan
from roughmdr.batch.rounds import Rounds
from roughmdr.storage.labelled import Labelled
from roughmdr.storage.netcdf_writing import write_netcdf

PARTS = ("loading", "reading", "planning", "keys", "tasks", "file")
_WORKERS = (1, 2)


def s(name: str) -> dict[str, str]:
    """The attributes of a time in seconds."""
    return {"units": "s", "long_name": name}


def size(name: str) -> dict[str, str]:
    """The attributes of a size."""
    return {"units": "byte", "long_name": name}


def by_cell(cells: int, repeats: int) -> xr.Dataset:
    """The overhead of a cell, by what it is spent on; medians."""
    found = medians(lambda: child("cells", cells), repeats)
    return xr.Dataset(
        {
            "cell_overhead": ("part", [found[name] / cells for name in PARTS], s("overhead of a cell, one worker")),
            "cell_time": ((), found["realisations"] / cells, s("time in the realisation of a cell")),
            "cell_size": ((), found["size"] / cells, size("a cell in the file")),
            "cell_runs": ((), found["runs"], {"units": "1", "long_name": "cells that were run"}),
        },
        coords={"part": list(PARTS)},
        attrs={"cells": cells},
    )


def by_realizations(counts: list[int]) -> xr.Dataset:
    """Memory and time by the number of realisations, where statistics are kept."""
    rows = [child("statistics", count) for count in counts]
    return xr.Dataset(
        {
            "peak_memory": ("realizations", [row["peak"] for row in rows], size("resident memory at most")),
            "memory_before": ("realizations", [row["before"] for row in rows], size("before the first realisation")),
            "statistics_time": ("realizations", [row["seconds"] for row in rows], s("time of the batch, one worker")),
        },
        coords={"realizations": counts},
    )


def by_scheduler(tasks: int, repeats: int, most: tuple[int, ...]) -> xr.Dataset:
    """What a task costs that does next to nothing, for numbers of workers; medians."""
    found = {workers: overheads(tasks, workers, repeats) for workers in most}
    names = {
        "task_overhead": ("each", "overhead of a task"),
        "start": ("start", "time until the first task is done"),
        "task_caller": ("caller", "processor time a task of the process that calls"),
        "task_scheduler": ("scheduler", "processor time a task of the scheduler of the cluster"),
    }
    return xr.Dataset(
        {
            name: (
                ("workers", "scheduler"),
                [[getattr(found[workers][scheduler], field) for scheduler in SCHEDULERS] for workers in most],
                s(text),
            )
            for name, (field, text) in names.items()
        },
        coords={"workers": list(most), "scheduler": list(SCHEDULERS)},
        attrs={"tasks": tasks},
    )


def by_workers(count: int, tasks: int, repeats: int) -> xr.Dataset:
    """What a second worker brings, each repeat."""
    found = speed_ups(count, tasks, repeats)
    inside = [[found[pool][f"inside_{workers}"] for workers in _WORKERS] for pool in found]
    return xr.Dataset(
        {
            "speed_up": (
                ("pool", "repeat"),
                [figures["speed_up"] for figures in found.values()],
                {"units": "1", "long_name": "time with one worker over time with two"},
            ),
            "task_time": (("pool", "used", "repeat"), inside, s("time in the realisation of a task")),
        },
        coords={"pool": list(found), "used": list(_WORKERS)},
    )


def by_asperity(count: int, repeats: int) -> xr.Dataset:
    """Time and memory of an asperity in ensembles of ``count`` and of a tenth of it, and what it takes to keep one."""
    counts = [count // 10, count]
    rows = [medians(lambda of=number: child("ensemble", of), repeats) for number in counts]  # type: ignore[misc]
    seconds, shard = writing(1)
    each = [[row[name] / number for number, row in zip(counts, rows, strict=True)] for name in ("making", "visiting")]
    more = (rows[1]["size"] - rows[0]["size"]) / (counts[1] - counts[0])
    return xr.Dataset(
        {
            "making_time": ("asperities", each[0], s("time to draw and sort an asperity")),
            "visiting_time": ("asperities", each[1], s("time to visit an asperity, 200 steps in and out")),
            "asperity_memory": ((), more, size("memory of one more asperity")),
            "writing_time": ((), seconds, s("time to keep a shard")),
            "shard_size": ((), shard, size("a shard of one row of statistics, 400 steps")),
        },
        coords={"asperities": counts},
    )


def large(result: xr.Dataset) -> Capacity:
    """What the large sweep would take."""
    task = result.sel(scheduler="distributed", workers=max(_WORKERS))
    return capacity(
        float(result["making_time"][-1]),
        float(result["visiting_time"][-1]),
        float(result["asperity_memory"]),
        {
            "caller": float(task["task_caller"]),
            "scheduler": float(task["task_scheduler"]),
            "writer": float(result["writing_time"]),
            "shard": float(result["shard_size"]),
        },
    )


def study(quick: bool, most: int) -> xr.Dataset:
    """All figures, up to ``most`` realisations; ``quick`` with few of everything, for a look that takes a minute."""
    for scene in (swept(4), tiny(unload=False)):
        plan = make_plan(scene)
        prepare_all(plan, Rounds(plan).begin())
    parts = [
        by_cell(200 if quick else 10_000, 1 if quick else 3),
        by_scheduler(*((60, 1, _WORKERS[1:]) if quick else (500, 3, _WORKERS))),
        by_workers(*((2_000, 24, 1) if quick else (100_000, 32, 5))),
        by_asperity(20_000 if quick else 1_000_000, 1 if quick else 3),
        by_realizations([1_000, 10_000] if quick else [max(1, most // part) for part in (100, 10, 1)]),
    ]
    result = xr.merge(parts, combine_attrs="no_conflicts")
    sweep = large(result)
    extrapolated = {f"large_{name}": value for name, value in asdict(sweep).items()}
    return result.assign_attrs(title="What the batch engine costs", **extrapolated, extrapolated=sweep.table())


def said(result: xr.Dataset) -> str:
    """The figures in words."""
    overhead, ups = 1e3 * result["cell_overhead"].to_pandas(), result["speed_up"]
    lines = [
        f"a cell: {overhead.sum():.3f} ms (goal {CELL_GOAL}), its realisation {1e3 * float(result['cell_time']):.3f}",
        overhead.round(4).to_string(),
        f"memory, statistics kept (goal {MEMORY_GOAL:.0f} MB)",
    ]
    for count in result["realizations"].to_numpy():
        row = result.sel(realizations=count)
        megabytes, seconds = float(row["peak_memory"]) / 1e6, float(row["statistics_time"])
        lines.append(f"{count:>10,} realisations: {megabytes:.0f} MB, {seconds:.1f} s")
    lines.append(f"two workers for one (goal {SPEED_GOAL})")
    for pool in ups["pool"].to_numpy():
        values, inside = ups.sel(pool=pool).to_numpy(), result["task_time"].sel(pool=pool, used=1)
        lines.append(
            f"{pool:>10}: median {np.median(values):.2f}, best {values.max():.2f}, "
            f"tasks of {1e3 * float(inside.median()):.0f} ms"
        )
    tables = {"task_overhead": "overhead of a task", "task_caller": "caller", "task_scheduler": "scheduler"}
    for name, text in tables.items():
        lines.append(f"{text}, ms\n{(1e3 * result[name]).to_pandas().round(3).to_string()}")
    making, visiting = (1e9 * float(result[name][-1]) for name in ("making_time", "visiting_time"))
    lines.append(
        f"an asperity: made in {making:.0f} ns, visited in {visiting:.0f} ns, {float(result['asperity_memory']):.0f} "
        f"bytes; a shard: {1e-3 * float(result['shard_size']):.0f} kB, {1e3 * float(result['writing_time']):.1f} ms"
    )
    lines.append(f"{CELLS} cells of {ASPERITIES:,} asperities on {WORKERS} workers, extrapolated")
    return "\n".join([*lines, result.attrs["extrapolated"]])


@click.command(help=(__doc__ or "").split("\n")[0])
@click.option("-o", "--output", type=click.Path(file_okay=False, path_type=Path), default=Path("results/studies"))
@click.option("--quick", is_flag=True, help="Few of everything: a minute, and rough figures.")
@click.option("--realizations", type=click.IntRange(100), default=1_000_000, help="For the memory; unless --quick.")
def main(output: Path, quick: bool, realizations: int) -> None:
    """Measure, print, write batch.nc and batch.png."""
    output.mkdir(parents=True, exist_ok=True)
    result = study(quick, realizations)
    write_netcdf(Labelled.of(result), output / "batch.nc")
    draw(result, output / "batch.png")
    click.echo(said(result))


if __name__ == "__main__":
    main()

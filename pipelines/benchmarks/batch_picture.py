"""The picture of what the batch engine costs: overhead of cells, memory, overhead of tasks, and a second worker."""

from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

if TYPE_CHECKING:
    from matplotlib.figure import Figure

CELL_GOAL, MEMORY_GOAL, SPEED_GOAL = 0.3, 500.0, 1.85
"""[ms] a cell, [MB], times."""


def draw(result: xr.Dataset) -> "Figure":
    """Draw four panels; dashed lines are the goals."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(13, 3.9), layout="constrained")
    cells, memory, tasks, workers = figure.subplots(1, 4, width_ratios=[1.25, 1, 1, 0.8])
    parts = 1e3 * result.cell_overhead.to_numpy()
    widths, lefts = [*parts, parts.sum()], [*np.cumsum(parts) - parts, 0.0]
    bars = cells.barh([*result.part.to_numpy(), "in all"], widths, left=lefts, color=["C0"] * parts.size + ["0.4"])
    cells.bar_label(bars, [f"{width:.3f}" for width in widths], padding=3, fontsize=8)
    cells.axvline(CELL_GOAL, color="C3", linestyle="--")
    cells.invert_yaxis()
    cells.set(title=f"Overhead of one of {result.attrs['cells']:,} cells", xlabel="ms")
    cells.set_xlim(right=1.3 * max(CELL_GOAL, parts.sum()))
    runs = result.realizations.to_numpy()
    memory.plot(runs, result.peak_memory / 1e6, "o-", label="at most")
    memory.plot(runs, result.memory_before / 1e6, "o:", color="0.5", label="before the first")
    memory.axhline(MEMORY_GOAL, color="C3", linestyle="--", label="goal")
    memory.set(title="Memory, statistics kept", xscale="log", xlabel="realisations", ylabel="MB")
    memory.set_ylim(0.0, 1.25 * MEMORY_GOAL)
    memory.legend(frameon=False, loc="lower right")
    for number, count in enumerate(result.workers.to_numpy()):
        values = 1e3 * result.task_overhead.sel(workers=count).to_numpy()
        bars = tasks.bar(np.arange(values.size) + 0.4 * number, values, 0.38, label=f"workers: {count}")
        tasks.bar_label(bars, [f"{value:.2f}" for value in values], fontsize=8)
    tasks.set_xticks(np.arange(result.sizes["scheduler"]) + 0.2, result.scheduler.to_numpy())
    tasks.set(title="Overhead of a task", ylabel="ms")
    tasks.legend(frameon=False, loc="upper left")
    for x, values in enumerate(result.speed_up.to_numpy()):
        workers.plot(np.full(values.size, x), values, "o", color="C0", alpha=0.5)
        workers.plot(x, np.median(values), "_", color="C0", ms=30, mew=2)
        workers.annotate(f"{np.median(values):.2f}", (x + 0.28, float(np.median(values))), va="center")
    workers.axhline(SPEED_GOAL, color="C3", linestyle="--", zorder=0)
    workers.set_xticks(range(result.sizes["pool"]), result.pool.to_numpy())
    workers.set(title="Two workers for one", ylabel="times as fast", xlim=(-0.5, 1.7))
    return figure

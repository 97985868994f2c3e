"""The picture of ``batch.py``: overhead of cells, memory, overhead of tasks, and what a second worker brings."""

from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

CELL_GOAL, MEMORY_GOAL, SPEED_GOAL = 0.3, 500.0, 1.85
"""[ms] a cell, [MB], times."""


def draw(result: xr.Dataset) -> "Figure":
    """Draw four panels."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(13, 3.9), layout="constrained")
    axes = figure.subplots(1, 4, width_ratios=[1.25, 1, 1, 0.8])
    _cells(axes[0], result)
    _memory(axes[1], result)
    _tasks(axes[2], result)
    _workers(axes[3], result)
    return figure


def _cells(ax: "Axes", result: xr.Dataset) -> None:
    """Draw the overhead of a cell, by what it is spent on and in all."""
    parts = result["cell_overhead"]
    values = 1e3 * parts.to_numpy()
    names = [*parts["part"].to_numpy().tolist(), "in all"]
    widths, lefts = [*values, values.sum()], [*np.cumsum(values) - values, 0.0]
    bars = ax.barh(names, widths, left=lefts, color=["C0"] * len(values) + ["0.4"])
    ax.bar_label(bars, [f"{width:.3f}" for width in widths], padding=3, fontsize=8)
    ax.axvline(CELL_GOAL, color="C3", linestyle="--")
    ax.annotate("goal ", (CELL_GOAL, -0.1), color="C3", va="center", ha="right")
    ax.invert_yaxis()
    ax.set_xlim(right=1.3 * max(CELL_GOAL, values.sum()))
    ax.set(title=f"Overhead of one of {result.attrs['cells']:,} cells", xlabel="ms")


def _memory(ax: "Axes", result: xr.Dataset) -> None:
    """Draw the memory at most, and before the first realisation."""
    runs = result["realizations"].to_numpy()
    ax.plot(runs, result["peak_memory"].to_numpy() / 1e6, "o-", label="at most")
    ax.plot(runs, result["memory_before"].to_numpy() / 1e6, "o:", color="0.5", label="before the first")
    ax.axhline(MEMORY_GOAL, color="C3", linestyle="--", label="goal")
    ax.set(xscale="log", ylim=(0.0, 1.25 * MEMORY_GOAL), xlabel="realisations", ylabel="MB")
    ax.set(title="Memory, statistics kept")
    ax.xaxis.set_minor_formatter("")
    ax.set_xticks(runs, [f"{run:,}" for run in runs])
    ax.legend(frameon=False, loc="lower right")


def _tasks(ax: "Axes", result: xr.Dataset) -> None:
    """Draw the overhead of each scheduler, with one worker and with two."""
    schedulers = result["scheduler"].to_numpy()
    for number, workers in enumerate(result["workers"].to_numpy()):
        values = 1e3 * result["task_overhead"].sel(workers=workers).to_numpy()
        label = f"{workers} worker{'s' if workers > 1 else ''}"
        bars = ax.bar(np.arange(len(schedulers)) + 0.4 * number, values, 0.38, label=label)
        ax.bar_label(bars, [f"{value:.2f}" for value in values], fontsize=8)
    ax.set_xticks(np.arange(len(schedulers)) + 0.2, schedulers)
    ax.set_ylim(bottom=0.0, top=1.3e3 * float(result["task_overhead"].max()))
    ax.set(title="Overhead of a task", ylabel="ms")
    ax.legend(frameon=False, loc="upper left")


def _workers(ax: "Axes", result: xr.Dataset) -> None:
    """Draw how much faster two workers are: each repeat, and the median."""
    ups = result["speed_up"]
    for x, values in enumerate(ups.to_numpy()):
        ax.plot(np.full(values.size, x), values, "o", color="C0", alpha=0.5)
        middle = float(np.median(values))
        ax.plot([x - 0.25, x + 0.25], [middle, middle], color="C0", linewidth=2)
        ax.annotate(f"{middle:.2f}", (x + 0.28, middle), va="center")
    ax.axhline(SPEED_GOAL, color="C3", linestyle="--", zorder=0)
    ax.annotate("goal", (-0.45, SPEED_GOAL), color="C3", va="bottom")
    ax.set_xticks(range(len(ups)), ups["pool"].to_numpy())
    ax.set(title="Two workers for one", ylabel="times as fast", xlim=(-0.5, 1.7))
    ax.set_ylim(min(0.9, float(ups.min()) - 0.1), max(2.1, float(ups.max()) + 0.1))

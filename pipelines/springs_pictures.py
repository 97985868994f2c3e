"""The pictures of ``springs.py``, drawn from its numbers."""

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

import roughmdr as rm

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_BODY, _LINE = "#e4e0d8", "#4a4a4a"
_COMPRESSED, _STRETCHED, _FREE = "#1b6ca8", "#c8553d", "#9a9a9a"
_COLORS = {"none": _COMPRESSED, "jkr": _STRETCHED}
_LABELS = {"none": "no adhesion", "jkr": "JKR"}


def draw_row(result: xr.Dataset) -> "Figure":
    """The row at three points of its path, and the path over the exact one; lengths in micrometres."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(15, 7.6), layout="constrained")
    grid = figure.add_gridspec(1, 2, width_ratios=[1.25, 1.0])
    rows, path = figure.add_subfigure(grid[0]), figure.add_subfigure(grid[1])
    axes = rows.subplots(3, 1, sharex=True)
    letters = dict(zip(result.stage.to_numpy(), "ABC", strict=True))
    titles = {
        "pressed": "pressed in: springs snap on up to a stretch u of Δℓ(x)",
        "pulled": "pulled back to first touch: all are stretched",
        "last contact": "the last contact under fixed grips",
    }
    for ax, (name, letter) in zip(axes, letters.items(), strict=True):
        _draw_stage(ax, result.sel(stage=name), result.attrs["radius"])
        ax.set_title(f"{letter}  {titles[name]}", fontsize=10.5, loc="left")
        stage = result.sel(stage=name)
        delta, a, force = (1e6 * float(stage[f"stage_{one}"]) for one in ("indentation", "contact_radius", "force"))
        ax.set_title(f"δ = {delta:+.3f} µm,  a = {a:.2f} µm,  P = {force:.2f} µN", fontsize=9, loc="right")
    axes[-1].set_xlabel("x [µm]")
    rows.supylabel("height above the undeformed surface [µm]", fontsize=10)
    _draw_path(path.subplots(), result, letters)
    return figure


def _draw_stage(ax: "Axes", stage: xr.Dataset, radius: float) -> None:
    """The tip's MDR profile, the springs between their base and their ends, and the surface that they make."""
    from matplotlib.collections import LineCollection

    position, ends = (1e6 * stage[name].to_numpy() for name in ("spring_position", "spring_end"))
    bottom, top = -0.95, 0.8
    half = 1.02 * float(position[-1])
    x = np.linspace(-half, half, 401)
    delta = 1e6 * float(stage.stage_indentation)
    profile = 1e6 * rm.Paraboloid(radius=radius).g(1e-6 * np.abs(x)) - delta
    ax.fill_between(x, profile, top, where=list(profile <= top), color=_BODY, lw=0)
    ax.plot(x, profile, color=_LINE, lw=1.3)
    ax.axhline(0.0, color="0.45", lw=0.8, ls=(0, (6, 4)), zorder=0)
    held = np.abs(position) < 1e6 * float(stage.stage_contact_radius)
    colors = np.where(held, np.where(ends > 0.0, _STRETCHED, _COMPRESSED), _FREE)
    width = 0.2 * float(position[1] - position[0])
    sideways = np.zeros(21)
    sideways[2:-2:2], sideways[3:-2:2] = width, -width
    lines = [
        np.column_stack([at + sideways, np.linspace(bottom, end, 21)]) for at, end in zip(position, ends, strict=True)
    ]
    ax.add_collection(LineCollection(lines, colors=list(colors), linewidths=0.9))
    ax.scatter(position, ends, s=9, c=list(colors), zorder=3)
    ax.axhline(bottom, color=_LINE, lw=2.5)
    outer = np.flatnonzero(held)[-1]
    ax.annotate(
        "",
        (position[outer], 0.0),
        (position[outer], ends[outer]),
        arrowprops={"arrowstyle": "<->", "lw": 1.1, "shrinkA": 0, "shrinkB": 0},
    )
    ax.text(position[outer] + 0.15, 0.5 * ends[outer], "u", va="center", fontsize=11)
    ax.set(xlim=(-half, half), ylim=(bottom - 0.02, top))


def _draw_path(ax: "Axes", result: xr.Dataset, letters: dict[str, str]) -> None:
    """Force against indentation, in and out."""
    depth = 1e6 * result.path_indentation.to_numpy()
    turn = int(np.argmax(depth))
    for way, color, label in ((slice(0, turn + 1), _COMPRESSED, "in"), (slice(turn, None), _STRETCHED, "out")):
        ax.plot(
            depth[way], 1e6 * result.path_force_exact[way], color=color, lw=5.0, alpha=0.25, label=f"{label}, exact"
        )
        springs = result.sizes["spring"] // 2 - 1
        ax.plot(
            depth[way], 1e6 * result.path_force[way], color=color, lw=1.1, label=f"{label}, {springs} springs a side"
        )
    for name, letter in letters.items():
        stage = result.sel(stage=name)
        at = 1e6 * float(stage.stage_indentation), 1e6 * float(stage.stage_force)
        ax.plot(*at, "ko", ms=5, zorder=4)
        ax.annotate(letter, at, (7, -12), textcoords="offset points", fontsize=12, weight="bold")
    ax.axhline(0.0, color="0.6", lw=0.8, zorder=0)
    ax.axvline(0.0, color="0.6", lw=0.8, zorder=0)
    ax.set(
        xlabel="indentation δ [µm]",
        ylabel="force P [µN]",
        title="Every tooth is a pair of springs that snaps on or lets go",
    )
    ax.title.set_fontsize(10.5)
    ax.legend(frameon=False, fontsize=9.5, loc="upper left")


def draw_errors(result: xr.Dataset) -> "Figure":
    """Error against the number of springs for each shape, and against run time for all."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(16, 11.5), layout="constrained")
    grid = figure.add_gridspec(2, 1, height_ratios=[2.0, 1.0])
    upper, lower = figure.add_subfigure(grid[0]), figure.add_subfigure(grid[1])
    axes = upper.subplots(3, 4, sharex=True, sharey=True)
    for ax, name in zip(axes.flat, result["shape"].to_numpy(), strict=False):
        _draw_shape(ax, result.sel(shape=name), str(name))
    for ax in axes[-1]:
        ax.set_xlabel("springs N")
    upper.supylabel("relative error, root mean square over 16 indentations", fontsize=10)
    times = lower.subplots(1, 2, sharey=True)
    for ax, model in zip(times, result.adhesion.to_numpy(), strict=True):
        _draw_times(ax, result.sel(adhesion=model))
        ax.set_title(f"What it costs, {_LABELS[model]}: error of the force against run time", fontsize=10.5)
    times[0].set_ylabel("relative error of the force")
    handles, labels = times[0].get_legend_handles_labels()
    lower.legend(handles, labels, loc="outside right center", frameon=False, fontsize=9)
    return figure


def _draw_shape(ax: "Axes", one: xr.Dataset, name: str) -> None:
    counts = one.springs.to_numpy()
    for model, color in _COLORS.items():
        for quantity, symbol, style in (("force", "P", "o-"), ("radius", "a", "s:")):
            errors = one[f"{quantity}_error"].sel(adhesion=model).to_numpy()
            slope = float(one[f"{quantity}_order"].sel(adhesion=model))
            text = "exact" if np.isnan(slope) else f"$N^{{-{slope:.2f}}}$"
            shown = np.where(np.isnan(slope), np.nan, errors)
            ax.plot(counts, shown, style, color=color, ms=3, lw=1.0, label=f"{symbol}, {_LABELS[model]}: {text}")
    ax.set(xscale="log", yscale="log", ylim=(1e-14, 0.1))
    ax.set_title(name, fontsize=10.5)
    ax.grid(color="0.92")
    ax.legend(frameon=False, fontsize=8, loc="lower left")


def _draw_times(ax: "Axes", result: xr.Dataset) -> None:
    from matplotlib import colormaps

    for number, name in enumerate(result["shape"].to_numpy()):
        one = result.sel(shape=name)
        if np.isnan(float(one.force_order)):
            continue
        color = colormaps["tab20"](number)
        ax.plot(1e3 * one.time, one.force_error, "o-", ms=3, lw=1.0, color=color, label=str(name))
    ax.axvline(1e3 * float(result.time_exact.median()), color="0.3", lw=1.0, ls="--", label="closed forms (median)")
    ax.set(xscale="log", yscale="log", xlabel="run time per contact [ms]")
    ax.grid(color="0.92")


PICTURES: dict[str, Callable[[xr.Dataset], "Figure"]] = {
    "springs_row.png": draw_row,
    "springs_error.png": draw_errors,
}

"""The pictures of the row of springs, drawn from its numbers."""

from typing import TYPE_CHECKING

import numpy as np
import xarray as xr
from studies.study import Draw

import roughmdr as rm
from figures.drawing import COMPRESSED, STRETCHED, draw_axes, draw_body, draw_length, draw_springs

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_COLORS = {"none": COMPRESSED, "jkr": STRETCHED}
_LABELS = {"none": "no adhesion", "jkr": "JKR"}
_STAGES = {
    "pressed": "A  loading: springs attach up to a stretch u of Δℓ(x)",
    "pulled": "B  back at first touch: all are stretched",
    "last contact": "C  the last contact under fixed grips",
}


def draw_row(result: xr.Dataset) -> "Figure":
    """Draw the row at three points of its path, and the path over the exact one; lengths in micrometres."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(15, 7.6), layout="constrained")
    grid = figure.add_gridspec(1, 2, width_ratios=[1.25, 1.0])
    rows, path = figure.add_subfigure(grid[0]), figure.add_subfigure(grid[1])
    axes = rows.subplots(3, 1, sharex=True)
    for ax, (name, title) in zip(axes, _STAGES.items(), strict=True):
        stage = result.sel(stage=name)
        _draw_stage(ax, stage, result.attrs["radius"])
        delta, a, force = (1e6 * float(stage[f"stage_{one}"]) for one in ("indentation", "contact_radius", "force"))
        ax.set_title(title, fontsize=10.5, loc="left")
        ax.set_title(f"δ = {delta:+.3f} µm,  a = {a:.2f} µm,  P = {force:.2f} µN", fontsize=9, loc="right")
    axes[-1].set_xlabel("x [µm]")
    rows.supylabel("height above the undeformed surface [µm]", fontsize=10)
    _draw_path(path.subplots(), result)
    return figure


def _draw_stage(ax: "Axes", stage: xr.Dataset, radius: float) -> None:
    """Draw the MDR profile of the tip, the springs and the stretch of the outermost one in contact."""
    positions, ends = (1e6 * stage[name].to_numpy() for name in ("spring_position", "spring_end"))
    bottom, top, half = -0.95, 0.8, 1.02 * float(positions[-1])
    x = np.linspace(-half, half, 401)
    g = 1e6 * rm.Paraboloid(radius=radius).g(1e-6 * np.abs(x))
    draw_body(ax, x, g - 1e6 * float(stage.stage_indentation), top)
    contact = np.abs(positions) < 1e6 * float(stage.stage_contact_radius)
    width = 0.2 * float(positions[1] - positions[0])
    draw_springs(ax, positions, ends, bottom, width=width, attached=contact)
    outer = np.flatnonzero(contact)[-1]
    x_outer, u = float(positions[outer]), float(ends[outer])
    draw_length(ax, (x_outer, 0.0), (x_outer, u), "u", (x_outer + 0.25, 0.5 * u))
    ax.set(xlim=(-half, half), ylim=(bottom - 0.02, top))


def _draw_path(ax: "Axes", result: xr.Dataset) -> None:
    """Draw force against indentation, loading and unloading."""
    depth = 1e6 * result.path_indentation.to_numpy()
    turning, springs = int(np.argmax(depth)), result.sizes["spring"] // 2 - 1
    for part, color, label in (
        (slice(0, turning + 1), COMPRESSED, "loading"), (slice(turning, None), STRETCHED, "unloading")
    ):  # fmt: skip
        exact, row = (1e6 * result[name][part] for name in ("path_force_exact", "path_force"))
        ax.plot(depth[part], exact, color=color, lw=5.0, alpha=0.25, label=f"{label}, exact")
        ax.plot(depth[part], row, color=color, lw=1.1, label=f"{label}, {springs} springs a side")
    for name, title in _STAGES.items():
        stage = result.sel(stage=name)
        at = 1e6 * float(stage.stage_indentation), 1e6 * float(stage.stage_force)
        ax.plot(*at, "ko", ms=5, zorder=4)
        ax.annotate(title[0], at, (7, -12), textcoords="offset points", fontsize=12, weight="bold")
    draw_axes(ax)
    ax.set(xlabel="indentation δ [µm]", ylabel="force P [µN]")
    ax.set_title("Every tooth is a pair of springs that attaches or detaches", fontsize=10.5)
    ax.legend(frameon=False, fontsize=9.5, loc="upper left")


def draw_errors(result: xr.Dataset) -> "Figure":
    """Draw the error against the number of springs for each shape, and against run time for all."""
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
        ax.set_title(f"{_LABELS[model]}: error of the force against run time", fontsize=10.5)
    times[0].set_ylabel("relative error of the force")
    lower.legend(*times[0].get_legend_handles_labels(), loc="outside right center", frameon=False, fontsize=9)
    return figure


def _draw_shape(ax: "Axes", one: xr.Dataset, name: str) -> None:
    for model, color in _COLORS.items():
        for quantity, symbol, style in (("force", "P", "o-"), ("radius", "a", "s:")):
            order = float(one[f"{quantity}_order"].sel(adhesion=model))
            text = "exact" if np.isnan(order) else f"$N^{{-{order:.2f}}}$"
            errors = one[f"{quantity}_error"].sel(adhesion=model).where(not np.isnan(order))
            ax.plot(one.springs, errors, style, color=color, ms=3, lw=1.0, label=f"{symbol}, {_LABELS[model]}: {text}")
    ax.set(xscale="log", yscale="log", ylim=(1e-14, 0.1))
    ax.set_title(name, fontsize=10.5)
    ax.grid(color="0.92")
    ax.legend(frameon=False, fontsize=8, loc="lower left")


def _draw_times(ax: "Axes", result: xr.Dataset) -> None:
    from matplotlib import colormaps

    for number, name in enumerate(result["shape"].to_numpy()):
        one = result.sel(shape=name)
        if not np.isnan(float(one.force_order)):
            color = colormaps["tab20"](number)
            ax.plot(1e3 * one.time, one.force_error, "o-", ms=3, lw=1.0, color=color, label=str(name))
    ax.axvline(1e3 * float(result.time_exact.median()), color="0.3", lw=1.0, ls="--", label="closed forms (median)")
    ax.set(xscale="log", yscale="log", xlabel="run time per contact [ms]")
    ax.grid(color="0.92")


PICTURES: dict[str, Draw] = {"springs_row": draw_row, "springs_error": draw_errors}

"""The pictures of ``one_asperity.py``, drawn from its numbers."""

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

import roughmdr as rm

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_BODY, _LINE = "#e4e0d8", "#4a4a4a"
_COMPRESSED, _STRETCHED, _FREE = "#1b6ca8", "#c8553d", "#9a9a9a"


def draw_two_steps(result: xr.Dataset) -> "Figure":
    """Profile, springs and surface of each stage, in units of the contact at first touch."""
    from matplotlib.figure import Figure

    a0, d0 = float(result.touch_radius), float(result.touch_depth)
    cone, inside, springs = (
        rm.Cone(slope=result.attrs["slope"]),
        int(result.attrs["springs_inside"]),
        int(result.spring.max()),
    )
    figure = Figure(figsize=(13, 4.6), layout="constrained")
    titles = (
        "1  pressed by g(a), without adhesion",
        "2  lifted by Δℓ(a) at fixed a:  δ = g(a) − Δℓ(a)",
        "the last contact under fixed grips (magnified)",
    )
    for ax, name, title in zip(figure.subplots(1, 3), result.stage.to_numpy(), titles, strict=True):
        stage = result.sel(stage=name)
        a, depth = float(stage.stage_contact_radius) / a0, float(stage.stage_indentation) / d0
        g, dl = float(stage.stage_depth) / d0, float(stage.stage_stretch) / d0 * (name != "pressed")
        size = g if name != "pull-off" else 0.5  # what is small beside the picture scales with it
        half = springs / inside * a * 1.06
        x = np.linspace(-half, half, 801)
        profile = cone.g(np.abs(x) * a0) / d0 - depth
        bottom, top = -1.75 * size, max(1.25 * size, dl + 0.5 * size)
        ax.fill_between(x, profile, top, where=list(profile <= top), color=_BODY, lw=0)
        ax.plot(x, profile, color=_LINE, lw=1.4)
        ax.axhline(0.0, color="0.45", lw=0.9, ls=(0, (6, 4)))
        ends = stage.spring_end.to_numpy() / d0
        for at, end in zip(stage.spring_position.to_numpy() / a0, ends, strict=True):
            _spring(ax, at, bottom, end, 0.036 * half)
        # The surface is torn at the edge once springs hang there.
        number = stage.spring.to_numpy()
        torn = [-springs, -inside, inside + 1] if dl else [-springs]
        for first, end in zip(torn, [*torn[1:], springs + 1], strict=True):
            part = (number >= first) & (number < end)
            ax.plot(stage.spring_position[part] / a0, ends[part], color="k", lw=1.1)
        ax.axhline(bottom, color=_LINE, lw=2.5)
        _labels(ax, str(name), a, g, dl, size)
        ax.set(xlim=(-half, half), ylim=(bottom - 0.02 * size, top), xlabel="x / a₀", title=title)
        ax.title.set_fontsize(11)
    figure.axes[0].set_ylabel("height above the undeformed surface / δ₀")
    figure.suptitle(
        "Cone on a row of springs, JKR adhesion.  a₀, δ₀: contact radius and Δℓ at first touch.  "
        "Blue: compressed; red: stretched; dashed: undeformed surface",
        fontsize=10,
    )
    return figure


def _spring(ax: "Axes", x: float, bottom: float, end: float, width: float) -> None:
    """A zigzag from the base to the end of a spring, its colour by its sign."""
    color = _FREE if abs(end) < 1e-9 else _STRETCHED if end > 0.0 else _COMPRESSED
    sideways = np.zeros(25)
    sideways[2:-2:2], sideways[3:-2:2] = width, -width
    ax.plot(x + 0.5 * sideways, np.linspace(bottom, end, sideways.size), color=color, lw=0.9, solid_joinstyle="round")
    ax.plot(x, end, "o", color=color, ms=2.8)


def _labels(ax: "Axes", name: str, a: float, g: float, dl: float, size: float) -> None:
    """The lengths a, g(a), dl(a) and delta, with arrows; guide lines to where they are taken from."""
    delta = g - dl
    guide: dict[str, Any] = {"color": "0.35", "lw": 0.7, "ls": ":"}
    paper = {"facecolor": "white", "edgecolor": "none", "alpha": 0.75, "pad": 0.8}

    def arrow(start: tuple[float, float], end: tuple[float, float], text: str, shift: tuple[float, float]) -> None:
        ax.annotate("", end, start, arrowprops={"arrowstyle": "<->", "lw": 1.2, "shrinkA": 0, "shrinkB": 0})
        middle = (0.5 * (start[0] + end[0]) + shift[0] * a, 0.5 * (start[1] + end[1]) + shift[1] * size)
        ax.text(*middle, text, ha="center", va="center", fontsize=12, bbox=paper if "<" in text else None)

    above = dl + (0.25 if name == "pressed" else 0.12) * size
    arrow((0.0, above), (a, above), "a", (0.0, 0.09))
    ax.plot([a, a], [dl, above], **guide)
    if name == "pressed":
        arrow((0.0, 0.0), (0.0, -g), "g(a)", (-0.2, 0.22))
        return
    right, left = 1.2 * a, -1.25 * a
    ax.plot([a, right], [dl, dl], **guide)
    arrow((right, 0.0), (right, dl), "Δℓ(a)", (0.21, 0.0))
    ax.plot([left, -a], [dl, dl], **guide)
    ax.plot([left, 0.0], [-delta, -delta], **guide)
    arrow((left, -delta), (left, dl), "g(a)", (-0.17, 0.1))
    arrow(
        (0.0, 0.0),
        (0.0, -delta),
        *(("δ", (0.0, 0.5 * delta / size + 0.08)) if delta > 0.0 else ("δ < 0", (0.27, 0.04))),
    )


_KNOWN = {  # as KNOWN has them, under fixed grips and dead load
    "cone": (r"$-\frac{6\,w^2}{\pi E^* S^3}$", r"$-\frac{54\,w^2}{\pi E^* S^3}$  (Maugis)"),
    "paraboloid": (r"$-\frac{5}{6}\,\pi w R$", r"$-\frac{3}{2}\,\pi w R$  (JKR)"),
    "flat punch": ("", r"$-\sqrt{8\pi E^* w b^3}$  (Kendall)"),
}


def draw_pull_off_curves(result: xr.Dataset) -> "Figure":
    """Each shape in a panel: force over its pull-off force under dead load, depth over that of the last contact."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(13, 4.8), layout="constrained")
    for ax, name in zip(figure.subplots(1, 3, sharey=True), result["shape"].to_numpy(), strict=True):
        shape = result.sel(shape=name)
        grips, dead = (shape.sel(control=control) for control in ("displacement", "force"))
        force = -float(dead.pull_off_force)
        depth = -float(grips.pull_off_indentation)
        curve = {
            course: (one.curve_indentation.to_numpy() / depth, one.curve_force.to_numpy() / force)
            for course, one in ((course, shape.sel(course=course)) for course in result.course.to_numpy())
        }
        widest = float(curve["loading"][0].max())
        low = -1.0 - 0.16 * (widest + 1.0)
        x, y = curve["loading"]
        ax.axhline(0.0, color="0.7", lw=0.7, zorder=0)
        ax.axvline(0.0, color="0.7", lw=0.7, zorder=0)
        ax.plot([low, 0.0], [0.0, 0.0], color=_COMPRESSED, lw=4, alpha=0.45)
        ax.plot(x, y, color=_COMPRESSED, lw=4, alpha=0.45, label="loading, with its jump at first touch")
        if y[0] < -1e-9:
            _jump(ax, (0.0, 0.0), (0.0, float(y[0])), _COMPRESSED)
        ax.plot(*curve["unloading"], color=_STRETCHED, lw=1.8, label="unloading, fixed grips")
        x_grips, y_grips = -1.0, float(grips.pull_off_force) / force
        _jump(ax, (x_grips, y_grips), (x_grips, 0.0), _STRETCHED)
        if np.isfinite(curve["unstable"][0]).all():
            ax.plot(*curve["unstable"], color="k", lw=1.2, ls="--", label="unstable")
        ax.plot(x_grips, y_grips, "o", color=_STRETCHED, ms=7, label="lets go under fixed grips")
        x_dead = float(dead.pull_off_indentation) / depth
        ax.plot(x_dead, -1.0, "o", mec="k", mfc="none", mew=1.5, ms=11, label="lets go under dead load")
        for j, text in enumerate(_KNOWN[str(name)]):
            value = float(shape.known_force[j]) / force
            if text:
                ax.axhline(value, color="0.4", lw=0.8, ls=":", zorder=0)
                ax.text(widest, value - 0.02, text, ha="right", va="top", fontsize=11)
        ax.set(xlim=(low, widest), ylim=(-1.3, 1.0), title=name, xlabel="δ / |δ at pull-off under fixed grips|")
    figure.axes[0].set_ylabel("P / |P at pull-off under dead load|")
    figure.axes[1].legend(frameon=False, fontsize=9, loc="upper left")
    return figure


def _jump(ax: "Axes", start: tuple[float, float], end: tuple[float, float], color: str) -> None:
    """A jump at fixed indentation."""
    arrow = {"arrowstyle": "-|>", "color": color, "lw": 1.4, "ls": ":", "shrinkA": 0, "shrinkB": 0}
    ax.annotate("", end, start, arrowprops=arrow)


def draw_shape_and_pull_off(result: xr.Dataset) -> "Figure":
    """Pull-off force over that of a flat face of the same width, against the exponent; the worst exponents marked."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.6, 5.0), layout="constrained")
    ax = figure.subplots()
    flat = float(result.flat_force)
    for color, ratio in zip((_COMPRESSED, _STRETCHED, "#3b7a57"), result.relative_stretch.to_numpy(), strict=True):
        for control, style in (("force", "-"), ("displacement", "--")):
            one = result.sel(relative_stretch=ratio, control=control)
            label = f"Δℓ(width)/rise = {ratio:g}" if control == "force" else None
            ax.plot(one.exponent, one.held_force / flat, color=color, ls=style, lw=1.8, label=label)
            ax.plot(one.worst_exponent, one.worst_force / flat, "v", color=color, ms=8, clip_on=False, zorder=3)
            at_rim = one.held_radius.to_numpy() == result.attrs["width"]
            ax.plot(one.exponent[at_rim], one.held_force[at_rim] / flat, color=color, lw=5, alpha=0.35)
    ax.axhline(1.0, color="0.3", lw=1.0)
    sharpest, flattest = float(result.exponent.min()), float(result.exponent.max())
    ax.text(flattest, 1.01, "flat face, n → ∞ (Kendall): best for every rise ▸", ha="right", va="bottom", fontsize=9)
    ax.plot([], [], "k-", label="dead load")
    ax.plot([], [], "k--", label="fixed grips")
    ax.plot([], [], "kv", label="worst exponent")
    ax.plot([], [], "k-", lw=5, alpha=0.35, label="contact as wide as the asperity")
    ax.set(xscale="log", xlim=(sharpest, flattest), ylim=(0.0, 1.08))
    ax.set_xticks([1, 2, 3, 5, 10, 20, 50, 100], ["1\ncone", "2\nparaboloid", "3", "5", "10", "20", "50", "100"])
    ax.set(xlabel="exponent n of f = rise (r/width)ⁿ", ylabel="pull-off force / that of a flat face of that width")
    ax.legend(frameon=False, fontsize=9, loc="lower right")
    return figure


PICTURES: dict[str, Callable[[xr.Dataset], "Figure"]] = {
    "two_steps.png": draw_two_steps,
    "pull_off_curves.png": draw_pull_off_curves,
    "shape_and_pull_off.png": draw_shape_and_pull_off,
}

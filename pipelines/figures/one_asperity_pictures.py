"""The pictures of one asperity under JKR adhesion, drawn from its numbers."""

import numpy as np
import xarray as xr
from studies.study import Axes, Draw, Figure, Study, blank

import roughmdr as rm
from figures.drawing import COMPRESSED, STRETCHED, draw_axes, draw_body, draw_jump, draw_length, draw_springs
from figures.one_asperity import POINTS, QUICK, measure, report

_STEPS = {
    "pressed": "1  pressed by g(a), without adhesion",
    "lifted": "2  lifted by Δℓ(a) at fixed a:  δ = g(a) − Δℓ(a)",
    "pull-off": "the last contact under fixed grips (magnified)",
}


def draw_two_steps(result: xr.Dataset) -> Figure:
    """Draw profile, springs and surface of each stage, in units of the contact at first touch."""
    a0, d0 = float(result.touch_radius), float(result.touch_depth)
    cone, inside = rm.Cone(slope=result.attrs["slope"]), int(result.attrs["springs_inside"])
    number = result.spring.to_numpy()
    figure = blank(13, 4.6)
    for ax, (name, title) in zip(figure.subplots(1, 3), _STEPS.items(), strict=True):
        stage = result.sel(stage=name)
        a, delta = float(stage.stage_contact_radius) / a0, float(stage.stage_indentation) / d0
        g, dl = float(stage.stage_depth) / d0, float(stage.stage_stretch) / d0 * (name != "pressed")
        size = g if name != "pull-off" else 0.5  # the size of labels
        half = number.max() / inside * a * 1.06
        x = np.linspace(-half, half, 801)
        bottom, top = -1.75 * size, max(1.25 * size, dl + 0.5 * size)
        draw_body(ax, x, cone.g(np.abs(x) * a0) / d0 - delta, top)
        positions, ends = stage.spring_position.to_numpy() / a0, stage.spring_end.to_numpy() / d0
        draw_springs(ax, positions, ends, bottom, width=0.018 * half, attached=np.abs(ends) >= 1e-9)
        contact = np.abs(number) <= inside
        for part in (contact, number < -inside, number > inside) if dl else (number >= number[0],):
            ax.plot(positions[part], ends[part], color="k", lw=1.1)  # the surface, torn at the edge of the contact
        _label(ax, (a, g, dl), size, pressed=name == "pressed")
        ax.set(xlim=(-half, half), ylim=(bottom - 0.02 * size, top), xlabel="x / a₀")
        ax.set_title(title, fontsize=11)
    figure.axes[0].set_ylabel("height above the undeformed surface / δ₀")
    figure.suptitle("Cone on a row of springs, JKR adhesion.  a₀, δ₀: contact radius and Δℓ at first touch.  "
                    "Blue: compressed; red: stretched; dashed: undeformed surface", fontsize=10)  # fmt: skip
    return figure


def _label(ax: Axes, lengths: tuple[float, float, float], size: float, *, pressed: bool) -> None:
    """Draw the lengths a, g(a), dl(a) and delta, with guide lines to where they are taken from."""
    a, g, dl = lengths
    delta, above = g - dl, dl + (0.25 if pressed else 0.12) * size
    draw_length(ax, (0.0, above), (a, above), "a", (0.5 * a, above + 0.09 * size))
    guides = [([a, a], [dl, above])]
    if pressed:
        draw_length(ax, (0.0, 0.0), (0.0, -g), "g(a)", (-0.2 * a, -0.28 * size))
    else:
        right, left = 1.2 * a, -1.25 * a
        guides += [([a, right], [dl, dl]), ([left, -a], [dl, dl]), ([left, 0.0], [-delta, -delta])]
        draw_length(ax, (right, 0.0), (right, dl), "Δℓ(a)", (1.41 * a, 0.5 * dl))
        draw_length(ax, (left, -delta), (left, dl), "g(a)", (-1.42 * a, 0.5 * (dl - delta) + 0.1 * size))
        at = (0.0, 0.08 * size) if delta > 0.0 else (0.27 * a, 0.04 * size - 0.5 * delta)
        draw_length(ax, (0.0, 0.0), (0.0, -delta), "δ" if delta > 0.0 else "δ < 0", at)
    for x, y in guides:
        ax.plot(x, y, color="0.35", lw=0.7, ls=":")


_KNOWN = {  # under fixed grips and under dead load
    "cone": (r"$-\frac{6\,w^2}{\pi E^* S^3}$", r"$-\frac{54\,w^2}{\pi E^* S^3}$  (Maugis)"),
    "paraboloid": (r"$-\frac{5}{6}\,\pi w R$", r"$-\frac{3}{2}\,\pi w R$  (JKR)"),
    "flat punch": ("", r"$-\sqrt{8\pi E^* w b^3}$  (Kendall)"),
}


def draw_pull_off_curves(result: xr.Dataset) -> Figure:
    """Draw for each shape the force over its pull-off force under dead load, against depth over that at pull-off."""
    figure = blank(13, 4.8)
    for ax, name in zip(figure.subplots(1, 3, sharey=True), result["shape"].to_numpy(), strict=True):
        shape = result.sel(shape=name)
        grips, dead_load = (shape.sel(control=control) for control in ("displacement", "force"))
        force, depth = -float(dead_load.pull_off_force), -float(grips.pull_off_indentation)
        x, y = shape.curve_indentation / depth, shape.curve_force / force
        last, touch = float(grips.pull_off_force) / force, float(y.sel(course="loading")[0])
        widest = float(x.sel(course="loading").max())
        low = -1.0 - 0.16 * (widest + 1.0)
        draw_axes(ax)
        ax.plot([low, 0.0], [0.0, 0.0], color=COMPRESSED, lw=4, alpha=0.45)
        for course, style, label in (
            ("loading", {"color": COMPRESSED, "lw": 4, "alpha": 0.45}, "loading, with its jump at first touch"),
            ("unloading", {"color": STRETCHED, "lw": 1.8}, "unloading, fixed grips"),
            ("unstable", {"color": "k", "lw": 1.2, "ls": "--"}, "unstable"),
        ):
            if np.isfinite(x.sel(course=course)).all():
                ax.plot(x.sel(course=course), y.sel(course=course), label=label, **style)
        if touch < -1e-9:
            draw_jump(ax, 0.0, 0.0, touch, COMPRESSED)
        draw_jump(ax, -1.0, last, 0.0, STRETCHED)
        ax.plot(-1.0, last, "o", color=STRETCHED, ms=7, label="pull-off under fixed grips")
        at = float(dead_load.pull_off_indentation) / depth
        ax.plot(at, -1.0, "o", mec="k", mfc="none", mew=1.5, ms=11, label="pull-off under dead load")
        for text, known in zip(_KNOWN[str(name)], shape.known_force.to_numpy() / force, strict=True):
            if text:
                ax.axhline(known, color="0.4", lw=0.8, ls=":", zorder=0)
                ax.text(widest, known - 0.02, text, ha="right", va="top", fontsize=11)
        ax.set(xlim=(low, widest), ylim=(-1.3, 1.0), title=name, xlabel="δ / |δ at pull-off under fixed grips|")
    figure.axes[0].set_ylabel("P / |P at pull-off under dead load|")
    figure.axes[1].legend(frameon=False, fontsize=9, loc="upper left")
    return figure


def draw_shape_and_pull_off(result: xr.Dataset) -> Figure:
    """Draw the pull-off force over that of a flat face of the same width, against the exponent, with the worst ones."""
    figure = blank(7.6, 5.0)
    ax = figure.subplots()
    for color, ratio in zip((COMPRESSED, STRETCHED, "#3b7a57"), result.relative_stretch.to_numpy(), strict=True):
        for control, style in (("force", "-"), ("displacement", "--")):
            one = result.sel(relative_stretch=ratio, control=control)
            force = one.held_force / result.flat_force
            label = f"Δℓ(width)/rise = {ratio:g}" if control == "force" else None
            ax.plot(one.exponent, force, color=color, ls=style, lw=1.8, label=label)
            worst = one.worst_force / result.flat_force
            ax.plot(one.worst_exponent, worst, "v", color=color, ms=8, clip_on=False, zorder=3)
            at_rim = one.held_radius.to_numpy() == result.attrs["width"]
            ax.plot(one.exponent[at_rim], force[at_rim], color=color, lw=5, alpha=0.35)
    ax.axhline(1.0, color="0.3", lw=1.0)
    sharpest, flattest = float(result.exponent.min()), float(result.exponent.max())
    ax.text(flattest, 1.01, "flat face, n → ∞ (Kendall): best for every rise ▸", ha="right", va="bottom", fontsize=9)
    for style, label in (("k-", "dead load"), ("k--", "fixed grips"), ("kv", "worst exponent")):
        ax.plot([], [], style, label=label)
    ax.plot([], [], "k-", lw=5, alpha=0.35, label="contact as wide as the asperity")
    ax.set(xscale="log", xlim=(sharpest, flattest), ylim=(0.0, 1.08))
    ax.set_xticks([1, 2, 3, 5, 10, 20, 50, 100], ["1\ncone", "2\nparaboloid", "3", "5", "10", "20", "50", "100"])
    ax.set(xlabel="exponent n of f = rise (r/width)ⁿ", ylabel="pull-off force / that of a flat face of that width")
    ax.legend(frameon=False, fontsize=9, loc="lower right")
    return figure


PICTURES: dict[str, Draw] = {
    "two_steps": draw_two_steps, "pull_off_curves": draw_pull_off_curves, "shape_and_pull_off": draw_shape_and_pull_off
}  # fmt: skip
STUDY = Study(
    "one_asperity", "One asperity under JKR adhesion", measure, PICTURES, report, f"{QUICK} of {POINTS} shapes"
)

"""The study of the stated error: its picture and its words."""

from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from studies.stated_error.scenes import scene
from studies.study import table

if TYPE_CHECKING:
    from matplotlib.figure import Figure

HONEST = 0.99
"""The share of scenes whose true error is to be below the stated one."""
_COLOURS = {"sampled": "#1b6ca8", "stratified": "#2e8b57", "expected": "#c8553d"}
_MARKS = {"none": ("o", "no adhesion"), "jkr": ("s", "JKR"), "dugdale": ("^", "Dugdale")}
_MIN_ERROR = 1e-17  # where errors of 0 are drawn


def draw(result: xr.Dataset) -> "Figure":
    """Draw the true error of each scene over the stated one, and a histogram of their ratios."""
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D

    figure = Figure(figsize=(12, 5.4), layout="constrained")
    left, right = figure.subplots(1, 2)
    ends = np.array([_MIN_ERROR, 1.0])
    left.fill_between(ends, ends, 10.0, color="#c8553d", alpha=0.08, lw=0)
    left.loglog(ends, ends, color="k", lw=1)
    for estimator, colour in _COLOURS.items():
        own = result.isel(scene=np.flatnonzero(result.estimator == estimator))
        for adhesion, (mark, _) in _MARKS.items():
            part = own.isel(scene=np.flatnonzero(own.adhesion == adhesion))
            true, stated = (np.maximum(part[name].to_numpy(), _MIN_ERROR) for name in ("true_error", "stated_error"))
            left.plot(stated, true, mark, color=colour, ms=5, mec="w", mew=0.4, alpha=0.8)
        pressed = own.isel(scene=np.flatnonzero(own.true_error > 0.0))
        ratio, label = pressed.stated_error / pressed.true_error, f"{estimator}, {own.sizes['scene']} scenes"
        right.hist(ratio, np.logspace(-1, 8, 37), color=colour, histtype="step", lw=1.8, label=label)
    left.text(2e-9, 1e-5, "not honest", color="#c8553d", fontsize=11)
    left.set(xlim=(0.5 * _MIN_ERROR, 1.0), ylim=(0.5 * _MIN_ERROR, 1.0), title="Is the stated error a bound?")
    left.set(xlabel="stated: numerical_error", ylabel="true error of the force over its largest magnitude")
    right.axvline(1.0, color="k", lw=1)
    right.set(xscale="log", xlabel="stated over true error", ylabel="scenes", title="How pessimistic is it?")
    right.legend(fontsize=9)
    colours = [Line2D([], [], color=colour, lw=5, label=name) for name, colour in _COLOURS.items()]
    marks = [Line2D([], [], color="0.4", marker=mark, ls="", label=label) for mark, label in _MARKS.values()]
    left.legend(handles=[*colours, *marks], loc="upper left", fontsize=9)
    for panel in (left, right):
        panel.grid(color="0.92")
        panel.set_axisbelow(True)
    return figure


def report(result: xr.Dataset) -> str:
    """Return the share of honest scenes, those that are not, and how pessimistic the bound is."""
    rows = []
    for name in (each for each in _COLOURS if each in result.estimator):
        own = result.isel(scene=np.flatnonzero(result.estimator == name))
        true, stated = own.true_error.to_numpy(), own.stated_error.to_numpy()
        worst = float(np.max(true[stated > 0.0] / stated[stated > 0.0], initial=0.0))
        cells = [name, f"{own.sizes['scene']}", f"{int(own.honest.sum())}"]
        for values in (stated, stated[true > 0.0] / true[true > 0.0]):
            cells += [f"{q:.1g}" for q in np.quantile(values, [0.5, 0.95])] if values.size else ["", ""]
        rows.append([*cells, f"{worst:.2g}"])
    head = "estimator, scenes, honest, stated: median, 95 %, stated/true: median, 95 %, true/stated: at most"
    false = [f"- scene {n}: `{scene(n).table}`" for n in result.scene[result.honest == 0].to_numpy().tolist()]
    share = f"{100.0 * float(result.honest.mean()):.1f} % of {result.sizes['scene']} random scenes"
    asked = f"(at least {100 * HONEST:.0f} % are asked for; {result.attrs['refused']} more were refused)"
    parts = [f"The true error is within the stated one in {share} {asked}.", table(head.split(", "), rows)]
    return "\n\n".join([*parts, *(["Not within it:", "\n".join(false)] if false else [])])

"""The picture of ``stated_error.py``, drawn from its numbers."""

from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_COLOURS = {"sampled": "#1b6ca8", "stratified": "#2e8b57", "expected": "#c8553d"}
_MARKS = {"none": "o", "jkr": "s", "dugdale": "^"}
_ADHESIONS = {"none": "no adhesion", "jkr": "JKR", "dugdale": "Dugdale"}
_LEAST = 1e-17  # where errors of 0 are drawn


def draw(result: xr.Dataset) -> "Figure":
    """The true error of each scene over the stated one; and how far apart they are."""
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D

    figure = Figure(figsize=(12, 5.4), layout="constrained")
    left, right = figure.subplots(1, 2)
    ends = np.array([_LEAST, 1.0])
    left.fill_between(ends, ends, 10.0, color="#c8553d", alpha=0.08, lw=0)
    left.loglog(ends, ends, color="k", lw=1)
    bins = np.logspace(-1, 8, 37)
    for estimator, colour in _COLOURS.items():
        own = result.isel(scene=np.flatnonzero(result.estimator == estimator))
        for adhesion, mark in _MARKS.items():
            part = own.isel(scene=np.flatnonzero(own.adhesion == adhesion))
            true, stated = (np.maximum(part[name].to_numpy(), _LEAST) for name in ("true_error", "stated_error"))
            left.plot(stated, true, mark, color=colour, ms=5, mec="w", mew=0.4, alpha=0.8)
        pressed = own.isel(scene=np.flatnonzero(own.true_error > 0.0))
        label = f"{estimator}, {own.sizes['scene']} scenes"
        right.hist(pressed.stated_error / pressed.true_error, bins, color=colour, histtype="step", lw=1.8, label=label)
    left.text(2e-9, 1e-5, "not honest", color="#c8553d", fontsize=11)
    left.set(xlim=(0.5 * _LEAST, 1.0), ylim=(0.5 * _LEAST, 1.0))
    left.set(xlabel="stated: numerical_error", ylabel="true error of the force over its largest magnitude")
    left.set_title("Is the stated error a bound?")
    right.axvline(1.0, color="k", lw=1)
    right.set_xscale("log")
    right.set(xlabel="stated over true error", ylabel="scenes")
    right.set_title("How pessimistic is it?")
    right.legend(fontsize=9)
    colours = [Line2D([], [], color=colour, lw=5, label=name) for name, colour in _COLOURS.items()]
    marks = [Line2D([], [], color="0.4", marker=mark, ls="", label=_ADHESIONS[name]) for name, mark in _MARKS.items()]
    left.legend(handles=[*colours, *marks], loc="upper left", fontsize=9)
    for panel in (left, right):
        panel.grid(color="0.92")
        panel.set_axisbelow(True)
    return figure

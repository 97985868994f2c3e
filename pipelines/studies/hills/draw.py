"""The pictures of the study of hills: errors of each method, and what the force of hills hangs on."""

from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from roughmdr.ensemble.maps.hills.find import SCALES
from roughmdr.numerics.arguments import Floats
from studies.hills.convergence import FINEST
from studies.hills.errors import errors_of, groups, rms
from studies.hills.measure import METHODS, PERSSON
from studies.hills.report_convergence import by_noise, by_points, by_scales

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_COLOURS = dict(
    zip(METHODS, ("0.45", "#0072b2", "#d55e00", "#009e73", "#66c2a5", "#e5b8d4", "#cc79a7", "#7b3f61"), strict=True)
)
_MARKERS = dict(zip(METHODS, "vso^PDDD", strict=True))
_THEORY = next(iter(PERSSON))
_CURVES = (*METHODS[:3], _THEORY)
_LIMITS = (-50.0, 50.0)


def draw(result: xr.Dataset) -> "Figure":
    """Draw the errors of the force over the contact fraction, and over the run time."""
    from matplotlib.figure import Figure
    from matplotlib.layout_engine import ConstrainedLayoutEngine
    from matplotlib.lines import Line2D

    parts = groups(result)
    figure = Figure(figsize=(4.6 * (len(parts) + 1), 5.0), layout=ConstrainedLayoutEngine(w_pad=0.12, h_pad=0.06))
    panels = figure.subplots(1, len(parts) + 1)
    for panel, (name, own) in zip(panels, parts.items(), strict=False):
        _draw_errors(panel, own)
        panel.set_title(f"{name} maps: median, 10 to 90 %")
    own, panel = parts["isotropic"], panels[-1]
    for method in METHODS:
        seconds = own["seconds"].sel(solver=method).to_numpy()
        by_case = [100.0 * rms(case) for case in errors_of(own).sel(solver=method).to_numpy()]
        panel.loglog(1e3 * seconds, by_case, _MARKERS[method], color=_COLOURS[method], ms=5)
    panel.set(
        xlabel="run time of nine separations [ms]",
        ylabel="r.m.s. error of the force [%]",
        title="isotropic maps, one point each",
    )
    handles = [
        Line2D([], [], color=_COLOURS[method], marker=_MARKERS[method], lw=2.0 * (method in _CURVES), ms=5)
        for method in METHODS
    ]
    figure.legend(handles, METHODS, loc="outside lower center", ncols=4, fontsize=9)
    return figure


def _draw_errors(panel: "Axes", own: xr.Dataset) -> None:
    """Draw the errors of the force on maps of a kind over the contact fraction."""
    errors, fraction = errors_of(own), 100.0 * own["fraction"].to_numpy()
    for method in _CURVES:
        each = 100.0 * errors.sel(solver=method).to_numpy()
        if np.isfinite(each).any():
            low, middle, high = np.nanquantile(each, [0.1, 0.5, 0.9], axis=0)
            panel.fill_between(fraction, low, high, color=_COLOURS[method], alpha=0.18, lw=0.0)
            panel.semilogx(fraction, middle, _MARKERS[method] + "-", color=_COLOURS[method], lw=2.0, ms=5)
    panel.axhline(0.0, color="k", lw=0.8)
    panel.set(xlabel="contact fraction [%]", ylabel="error of the force [%]", ylim=_LIMITS)
    panel.set_xticks([0.3, 1, 3, 10, 20], ["0.3", "1", "3", "10", "20"], minor=False)
    panel.minorticks_off()


def draw_convergence(result: xr.Dataset) -> "Figure":
    """Draw the force of hills over points a wave and contact radii, and what noise moves it by."""
    from matplotlib.figure import Figure
    from matplotlib.layout_engine import ConstrainedLayoutEngine

    figure = Figure(figsize=(13.8, 4.6), layout=ConstrainedLayoutEngine(w_pad=0.12, h_pad=0.06))
    of_points, of_scales, of_noise = figure.subplots(1, 3)
    points, hills = by_points(result), _COLOURS["hills"]
    for values, style, label in (
        (points["error"], "o-", "error, r.m.s."),
        (points["lacking"], "s--", f"too low, mean, against {FINEST} points"),
        (points["stated"], "^:", "stated: resolution_error"),
    ):
        colour = {"o-": hills, "s--": "#0072b2", "^:": "k"}[style]
        of_points.loglog(result["points"], 100.0 * values, style, color=colour, label=label)
    _finish(of_points, result["points"].to_numpy(), "points of the map a shortest wave")
    of_points.set(ylabel="force of hills [%]", ylim=(0.02, 300.0))
    scales = by_scales(result)
    of_scales.semilogx(scales["scales"], 100.0 * scales, "o-", color=hills, label="error, r.m.s.")
    _finish(of_scales, scales["scales"].to_numpy(), f"contact radii of a hill ({SCALES} unless told)")
    of_scales.set(ylabel="force of hills [%]", ylim=(0.0, 1.6 * 100.0 * float(scales.max())))
    noise = by_noise(result)
    for name in noise["asperities"].to_numpy():
        of_noise.loglog(
            100.0 * noise["noise"],
            100.0 * noise.sel(asperities=name),
            _MARKERS[name] + "-",
            color=_COLOURS[name],
            label=str(name),
        )
    _finish(of_noise, 100.0 * noise["noise"].to_numpy(), "white noise, r.m.s. over that of the heights [%]")
    of_noise.set(ylabel="change of the force, r.m.s. [%]", ylim=(0.3, 60.0))
    return figure


def _finish(panel: "Axes", ticks: Floats, words: str) -> None:
    """Label the abscissa of a panel at its points, and its curves above them."""
    panel.minorticks_off()
    panel.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
    panel.set_xlabel(words)
    panel.legend(fontsize=9, loc="upper right" if "points" in words else "upper left")

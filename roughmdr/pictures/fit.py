"""The picture of a fit: the measured points, the fitted law, and the residuals below."""

from typing import TYPE_CHECKING, Any

import numpy as np

from roughmdr.fitting.words import describe_parameters, describe_shifts, load_of, parameter_names, typical
from roughmdr.pictures.style import BRANCH_COLOURS, Scale, new_figure, set_title
from roughmdr.storage.labelled import Labelled

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_POINTS: dict[str, Any] = {"fmt": "o", "ms": 3.0, "mfc": "none", "elinewidth": 0.6}  # circles that hide no law
_CONTROLS = {"separation": "measured separation", "remote": "measured position of the far end of the spring"}


def draw_fits(fits: Labelled) -> "Figure":
    """Draw how each parameter, and the size of the residuals, are distributed over many curves."""
    names = parameter_names(fits) | {"residual over largest load": "residual_rms"}
    drawn = {key: array for key, name in names.items() if (array := fits.variables[name]).dims}
    figure = new_figure(6.4, 2.1 * len(drawn))
    for ax, (key, array) in zip(figure.subplots(len(drawn), 1, squeeze=False).flat, drawn.items(), strict=True):
        values = array.values[np.isfinite(array.values)]
        scale = Scale.of(values, key, array.attrs["units"])
        ax.hist(scale(values), bins="auto")
        ax.set(xlabel=scale.label, ylabel="curves")
    set_title(figure, str(fits.attrs["title"]), [" ".join(line.split()) for line in describe_parameters(typical(fits))])
    return figure


def draw_fit(fit: Labelled) -> "Figure":
    """Draw the measured points over the fitted law, loading and unloading in their colours, and the residuals below."""
    from matplotlib import rcParams

    control, load = next(name for name in _CONTROLS if name in fit.coordinates), load_of(fit)
    figure = new_figure(6.4, 5.6)
    law, residual = figure.subplots(2, 1, sharex=True, height_ratios=(3.0, 1.0))
    x = Scale.of(fit.coordinates[control].values, _CONTROLS[control], "m")
    y = Scale.of(fit.variables[load].values, load, fit.variables[load].attrs["units"])
    r = Scale.of(fit.variables["residual"].values, "residual", fit.variables[load].attrs["units"])
    error = f"{load}_error"
    _draw_points(law, fit, (control, load, error), (x, y))
    fitted = x(fit.coordinates[control].values), y(fit.variables[f"{load}_fitted"].values)
    law.plot(*fitted, color=rcParams["text.color"], lw=1.0, label="fitted law")
    _draw_points(residual, fit, (control, "residual", error), (x, r))
    for ax in (law, residual):
        ax.axhline(0.0, color="0.6", lw=0.6, zorder=0)
    law.set_ylabel(y.label)
    figure.legend(*law.get_legend_handles_labels(), loc="outside lower center", frameon=False, fontsize=8, ncols=3)
    residual.set(xlabel=x.label, ylabel=r.label)
    notes = [" ".join(line.split()) for line in describe_parameters(fit)]
    if shifts := describe_shifts(fit):
        notes.append(f"model error {shifts}")
    set_title(figure, str(fit.attrs["title"]), notes)
    return figure


def _draw_points(ax: "Axes", fit: Labelled, names: tuple[str, str, str], scales: tuple[Scale, Scale]) -> None:
    """Draw points by branch, with bars where their errors are known."""
    (control, name, error), (x, y) = names, scales
    for branch, colour in BRANCH_COLOURS.items():
        at = fit.coordinates["branch"].values == branch
        if at.any():
            bars = y(fit.variables[error].values[at]) if error in fit.variables else None
            points = x(fit.coordinates[control].values[at]), y(fit.variables[name].values[at]), bars
            ax.errorbar(*points, **_POINTS, color=colour, label=f"measured, {branch}")

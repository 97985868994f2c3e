"""The study of conductance: its picture and its words."""

from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from roughmdr.numerics.arguments import Floats
from studies.conductance.measure import FRACTIONS
from studies.study import table

if TYPE_CHECKING:
    from matplotlib.figure import Figure

GROUPS = ("random", "separated", "hills", "summits")
_COLOURS = {"independent": "0.6", "mean field": "#8a5fb0", "order 1": "#1b6ca8", "order 2": "#c8553d"}
_GRID, _UNKNOWN = 0.5, 5e-3
"""Error of boundary elements over what every other point of their grid changes, of the first to the second order; at
least that of a stiffness by differences, as cells touch one by one.
"""


def errors(result: xr.Dataset, name: str = "conductance") -> xr.DataArray:
    """Return the relative error of a conductance, over cases, models and steps."""
    return result[name] / result["conductance_bem"] - 1.0


def grid_errors(result: xr.Dataset) -> xr.DataArray:
    """Return about the error of boundary elements, over cases and steps."""
    off = _GRID * abs(result["conductance_coarse"] / result["conductance_bem"] - 1.0)
    return off.where(~(off < _UNKNOWN), _UNKNOWN)


def bounded(result: xr.Dataset, under_load: bool = False) -> xr.DataArray:
    """Return whether the stated error holds, to the error of the grid, over cases, models and steps; NaN of none."""
    suffix = "_under_load" if under_load else ""
    error, stated = abs(errors(result, f"conductance{suffix}")), result[f"stated{suffix}"]
    return (error <= stated + grid_errors(result)).where(np.isfinite(error) & np.isfinite(stated))


def draw(result: xr.Dataset) -> "Figure":
    """Draw the error at given separation and under given load over the contact fraction."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(14, 4.8), layout="constrained")
    panels = dict(zip(("conductance", "conductance_under_load"), figure.subplots(1, 2, sharey=True), strict=True))
    titles = ("At given separation", "Under given load")
    marks = dict(zip(GROUPS, "os^x", strict=True))
    for title, (name, panel) in zip(titles, panels.items(), strict=True):
        error = abs(errors(result, name))
        for model, colour in _COLOURS.items():
            for group, mark in marks.items():
                own = result.isel(case=np.flatnonzero(result["group"].to_numpy() == group))
                each = error.isel(case=np.flatnonzero(result["group"].to_numpy() == group)).sel(model=model)
                label = f"{model}, {group}" if name == "conductance" else None
                panel.loglog(own["contact_fraction_bem"].to_numpy().ravel(), each.to_numpy().ravel(), mark,
                             color=colour, ms=4, label=label)  # fmt: skip
        panel.set(
            xlabel="contact fraction", ylabel="error of the conductance (relative)", title=title, ylim=(1e-4, 1.0)
        )
        panel.grid(color="0.92")
    figure.legend(loc="outside right center", fontsize=8)
    return figure


def _percent(values: Floats) -> str:
    known = np.abs(values[np.isfinite(values)])
    return f"{100.0 * np.median(known):.2g} % ({100.0 * known.max():.2g})" if known.size else ""


def report(result: xr.Dataset) -> str:
    """Return the errors by group and model, and how often the stated error holds."""
    rows, held = [], []
    groups = result["group"].to_numpy()
    for group in GROUPS:
        own = result.isel(case=np.flatnonzero(groups == group))
        if not own.sizes["case"]:
            continue
        for model in own["model"].to_numpy():
            one = own.sel(model=model)
            if not np.isfinite(one["conductance"]).any():
                continue
            for name, where in (("conductance", "separation"), ("conductance_under_load", "load")):
                cells = [_percent(errors(one, name).isel(step=i).to_numpy()) for i in range(FRACTIONS.size)]
                rows.append([group, str(model), where, *cells])
            shares = [float(bounded(own, under_load).sel(model=model).mean()) for under_load in (False, True)]
            held.append([group, str(model), *(f"{100.0 * share:.0f} %" for share in shares)])
    head = ["surfaces", "model", "at given", *(f"{100.0 * each:g} %" for each in FRACTIONS)]
    grid = _percent(grid_errors(result).to_numpy())
    return f"""Errors of the conductance by contact fraction, median of the magnitude (largest):

{table(head, rows)}

The stated error of the conductance holds, with that of the grid:

{table(["surfaces", "model", "at given separation", "at given load"], held)}

The grids of boundary elements are right to about {grid}.
"""

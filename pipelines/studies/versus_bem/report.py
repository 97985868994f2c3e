"""The study of independent asperities against boundary elements: its picture and its words."""

from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from roughmdr.model_error.interaction import ASPERITIES, SUMMITS, interaction_error
from studies.study import table
from studies.versus_bem.coupled import draw_models, report_coupled
from studies.versus_bem.judge import FACTOR, GROUPS, errors, estimates, grid_errors, groups, judge

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_COLOURS = dict(zip(GROUPS, ("0.6", "#1b6ca8", "#2e8b57", "#c8553d", "#c9a227", "#8a5fb0", "k"), strict=True))
_BINS = ((0.0, 0.004), (0.004, 0.03), (0.03, 0.15), (0.15, 1.0))
"""Contact fractions from above the first to the second."""


def draw(result: xr.Dataset) -> "Figure":
    """Draw the error over the contact fraction with its estimate, and overlaps over the estimate by Poisson."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(17, 5.2), layout="constrained")
    left, right, models = figure.subplots(1, 3)
    fraction, error, group = result["contact_fraction"].to_numpy(), errors(result), groups(result)
    along = np.geomspace(5e-4, 1.0, 200)
    for name, kind, style in (("estimate", ASPERITIES, "-"), ("estimate for maps", SUMMITS, "--")):
        left.loglog(along, interaction_error(along, kind), color="k", lw=1.2, ls=style, label=name)
    for name, colour in _COLOURS.items():
        own = group == name
        left.plot(fraction[own], np.abs(error[own]), "o", color=colour, ms=4, mec="w", mew=0.3, label=name)
        overlap, expected = (result[part].to_numpy()[own] for part in ("overlap", "overlap_poisson"))
        right.plot(expected, overlap, "o", color=colour, ms=4, mec="w", mew=0.3)
    left.set(xlim=(5e-4, 1.0), ylim=(0.005, 1.3), title="Asperities that do not feel each other")
    left.set(xlabel="summed contact area over nominal area", ylabel="force too low, of crowds too high, by (relative)")
    left.legend(fontsize=9)
    right.plot([0.0, 1.0], [0.0, 1.0], color="k", lw=1)
    right.set(xlabel="1 - exp(-n pi <(a_i + a_j)^2>)", ylabel="share of contacts that meet another", title="Overlap")
    draw_models(models, result)
    for panel in (left, right, models):
        panel.grid(color="0.92")
        panel.set_axisbelow(True)
    return figure


def report(result: xr.Dataset) -> str:
    """Return the errors over sqrt(f) by group and contact fraction, and how the estimate does."""
    fraction, error, group = result["contact_fraction"].to_numpy(), errors(result), groups(result)
    known = np.isfinite(error)
    coefficients, shares = [], []
    for name in GROUPS:
        own = known & (group == name)
        cells = [name]
        for low, high in _BINS:
            part = own & (fraction > low) & (fraction <= high)
            ratio = error[part] / np.sqrt(fraction[part])
            middle = "{1:.2f} ({0:.2f} to {2:.2f})".format(*np.quantile(ratio, [0.05, 0.5, 0.95])) if part.any() else ""
            cells.append(middle)
        coefficients.append(cells)
        if own.any():
            told = result["stated_alone"].to_numpy() if name == "crowd" else estimates(fraction, group)
            judged = judge(np.abs(error[own]), told[own])
            percent = (f"{100.0 * share:.0f} %" for share in (judged.bounded, judged.within))
            shares.append([name, str(judged.number), *percent])
    grid = grid_errors(result)
    grid = grid[np.isfinite(grid)]
    bins = [f"f from {low:g} to {high:g}" for low, high in _BINS]
    head = ["placement", "errors", "below the estimate", f"within a factor of {FACTOR:g}"]
    return f"""e over sqrt(f), median (5 to 95 %), f the summed contact fraction of independent asperities:

{table(["placement", *bins], coefficients)}

{table(head, shares)}

Forces of boundary elements on half as many points differ by {100.0 * float(np.median(grid)):.2g} % (median), at most
{100.0 * float(grid.max()):.2g} %.

{report_coupled(result)}"""

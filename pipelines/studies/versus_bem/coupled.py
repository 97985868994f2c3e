"""Coupled asperities against boundary elements: errors by interaction, of the finest grids, and those stated."""

import itertools
from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from studies.study import table
from studies.versus_bem.judge import FACTOR, GROUPS, grid_errors, groups, signed_errors, without_grid

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_NAMES = {
    "force": "independent",
    "force_mean": "mean field",
    "force_first": "order 1",
    "force_second": "order 2",
}
_COLOURS = dict(zip(_NAMES, ("0.6", "#8a5fb0", "#1b6ca8", "#c8553d"), strict=True))
_BINS = (0.0, 0.004, 0.03, 0.06, 0.15, 1.0)
_NEGLIGIBLE = 1e-4
"""An error below, or below that of the grid, is right where less than so many times ``FACTOR`` is stated."""
_FINE_SEED = 11  # and above, of the cases on the finest grids


def draw_models(panel: "Axes", result: xr.Dataset) -> None:
    """Draw the error of the force over the contact fraction for each interaction; maps as crosses."""
    fraction, on_map = result["contact_fraction"].to_numpy(), groups(result) == "map"
    for name, label in _NAMES.items():
        error = np.abs(signed_errors(result, name))
        panel.loglog(fraction[~on_map], error[~on_map], "o", color=_COLOURS[name], ms=3, label=label)
        panel.loglog(fraction[on_map], error[on_map], "x", color=_COLOURS[name], ms=4)
    panel.set(xlim=(5e-4, 1.0), ylim=(1e-6, 1.3), xlabel="summed contact area over nominal area")
    panel.set(ylabel="error of the force (relative)", title="By interaction (crosses: maps)")
    panel.legend(fontsize=9)


def report_coupled(result: xr.Dataset) -> str:
    """Return errors by interaction, those on the finest grids, those stated, and run times."""
    fraction, group = result["contact_fraction"].to_numpy(), groups(result)
    by_model = [
        [name, f"{low:g} to {high:g}", *(_median(signed_errors(result, model), own) for model in _NAMES)]
        for name in GROUPS
        for low, high in itertools.pairwise(_BINS)
        if (own := (group == name) & (fraction > low) & (fraction <= high)).any()
    ]
    fine = result.isel(case=np.flatnonzero(result["seed"].to_numpy() >= _FINE_SEED))
    finest = [_fine(fine.isel(step=i)) for i in range(fine.sizes["step"]) if fine["force_bem"][:, i].notnull().any()]
    unknown = np.fmax(grid_errors(result), _NEGLIGIBLE)
    judged = []
    for order, name in itertools.product((1, 2), GROUPS):
        force, told = ("force_first", "stated_first") if order == 1 else ("force_second", "stated")
        error, stated = np.abs(signed_errors(result, force)), result[told].to_numpy()
        own = np.isfinite(error) & np.isfinite(stated) & (group == name)
        if own.any():
            e, s, least = error[own], stated[own], unknown[own]
            near = (s <= FACTOR * np.maximum(e, least)) & (e <= FACTOR * np.maximum(s, least))
            bounded = f"{100.0 * np.mean(e <= np.maximum(s, least)):.0f} %"
            judged.append([str(order), name, str(e.size), bounded, f"{100.0 * np.mean(near):.0f} %"])
    seconds = " and ".join(f"{1e3 * float(result[name].median()):.3g} ms" for name in ("seconds_second", "seconds_bem"))
    head = ["placement", "f", *_NAMES.values()]
    fine_head = ["f", *_NAMES.values(), "of the grid", "area", "contacts"]
    return f"""Errors of the force by interaction, median of the magnitude (largest):

{table(head, by_model)}

Separated paraboloids of lognormal radii on the finest grid, largest errors of all seeds:

{table(fine_head, finest)}

The error that each order states (not told apart: {_NEGLIGIBLE:g} and less, and errors of the grid):

{table(["order", "placement", "errors", "below the estimate", f"within a factor of {FACTOR:g}"], judged)}

A load to second order and by boundary elements takes {seconds} (median).
"""


def _median(error: np.ndarray, own: np.ndarray) -> str:
    values = np.abs(error[own & np.isfinite(error)])
    return f"{100.0 * np.median(values):.2g} % ({100.0 * values.max():.2g})" if values.size else ""


def _fine(step: xr.Dataset) -> list[str]:
    """Return a row of the largest errors at a step; force held against the limit of both grids."""
    exact = without_grid(step["force_bem"], step["force_coarse"])
    errors = [abs(step[name] / exact - 1.0) for name in (*_NAMES, "force_bem")]
    area = abs(step["contact_fraction_second"] / step["contact_fraction_bem"] - 1.0)
    off = abs(step["contact_count_second"] - step["contact_count_bem"])
    cells = (f"{100.0 * float(error.max()):.2g} %" for error in (*errors, area))
    return [f"{float(step['contact_fraction_second'].median()):.2g}", *cells, f"{float(off.max()):.0f} off"]

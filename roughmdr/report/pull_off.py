"""The pull-off of a result in words."""

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from roughmdr.result import layout
from roughmdr.result.means import holds, mean_of, pull_off_counts
from roughmdr.schema.units import format_quantity
from roughmdr.storage.labelled import Labelled
from roughmdr.variables import LATERAL, TRAVEL

_FEW = 10.0
"""Contacts: the number of fewer that carry the tension of a patch scatters by more than a third of itself."""
_MAX_CELLS = 30


def describe_pull_off(result: Labelled, not_known: str) -> Iterator[tuple[str, str]]:
    """Yield the pull-off of each cell, and how it is defined; ``not_known`` stands for cells that were not computed."""
    if layout.control_of(result) == LATERAL.name:
        return
    if "unloading" not in result.coordinates["branch"].values:
        yield "pull-off", "none: the path has no unloading"
        return
    if "pull_off_count" not in result.variables:
        yield "pull-off", "not stored: the result was made before pull-offs were"
        return
    cells = layout.cells_of(result)
    lines = [_describe_cell(result, cell) or not_known for cell in cells[:_MAX_CELLS]]
    width = max(map(len, lines))
    for number, (line, cell) in enumerate(zip(lines, cells, strict=False)):
        yield "" if number else "pull-off", f"{line:<{width}}  {layout.cell_label(result, cell)}".rstrip()
    if len(cells) > _MAX_CELLS:
        yield "", f"... and {len(cells) - _MAX_CELLS} more cells"
    contacts = mean_of(result, "pull_off_contacts")[0].ravel()
    if (few := contacts[contacts < _FEW]).size:
        counted = f"{few.min():.2g}" if few.size == 1 else f"{few.min():.2g} to {few.max():.2g}"
        share = f" in {few.size} of {len(cells)} cells" if len(cells) > 1 else ""
        verb = "carries" if few.max() == few.min() == 1.0 else "carry"
        noun = "contact" if verb == "carries" else "contacts"
        small = "a patch this small" if "nominal" not in result.attrs else "a body on so few"
        yield "", f"{counted} {noun} {verb} it{share}: {small} does not show the pull-off of a surface"
    yield "", f"({_definition(result)})"


def _definition(result: Labelled) -> str:
    if layout.estimator_of(result) == "expected":
        return "largest tension of the expected law; realisations detach contact by contact and go deeper"
    if layout.realizations_of(result) == 1:
        return "largest tension during unloading; one realisation has no standard error"
    mean = "" if layout.control_of(result) == TRAVEL.name else "; that of the mean law is less"
    return f"largest tension of each realisation during unloading: mean ± standard error{mean}"


def _describe_cell(result: Labelled, cell: tuple[int, ...]) -> str:
    """Describe the pull-off of a cell; empty where no run was computed."""
    runs = _runs(result)[cell]
    having = int(pull_off_counts(result)[cell])
    if not runs:
        return ""
    if not having:
        return f"none: {'the unloading ends' if runs == 1 else f'all {runs} unloadings end'} in contact"
    force, error = (float(values[cell]) for values in mean_of(result, "pull_off_force"))
    without = f"; {runs - having} of {runs} unloadings end in contact and have none" if having < runs else ""
    if force == 0.0:
        return f"0 N: contacts part without tension{without}"
    text = format_quantity(force, "N", error=error)
    if holds(result, "pull_off_pressure") and math.isfinite(pressure := mean_of(result, "pull_off_pressure")[0][cell]):
        text += f", {format_quantity(float(pressure), 'Pa')}"
    of_mean = float(result.variables["pull_off_force_of_mean"].values[cell])
    if runs > 1 and layout.control_of(result) != TRAVEL.name:  # at equal travel realisations stand at different places
        text += (
            "; the mean law has none" if math.isnan(of_mean) else f"; of the mean law {format_quantity(of_mean, 'N')}"
        )
    return text + without


def _runs(result: Labelled) -> NDArray[np.int64]:
    """Return the number of realisations of each cell that were computed."""
    done = layout.done_of(result)
    if "realization" in result.variables["status"].dims:
        return np.asarray(done.sum(axis=-1))
    return np.where(done, result.variables["realization_count"].values, 0).astype(np.int64)

"""The pull-off of a result in words."""

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from roughmdr.result.view import ResultView
from roughmdr.schema.units import format_quantity
from roughmdr.variables import LATERAL, TRAVEL

_FEW = 10.0
"""Contacts: the number of fewer that carry the tension of a patch scatters by more than a third of itself."""
_MAX_CELLS = 30


def describe_pull_off(result: ResultView, not_known: str) -> Iterator[tuple[str, str]]:
    """Yield the pull-off of each cell, and how it is defined; ``not_known`` stands for cells that were not computed."""
    if result.control == LATERAL.name:
        return
    if "unloading" not in result.branches:
        yield "pull-off", "none: the path has no unloading"
        return
    if "pull_off_count" not in result.variables:
        yield "pull-off", "not stored: the result was made before pull-offs were"
        return
    cells = result.cells
    lines = [_describe_cell(result, cell) or not_known for cell in cells[:_MAX_CELLS]]
    width = max(map(len, lines))
    for number, (line, cell) in enumerate(zip(lines, cells, strict=False)):
        yield "" if number else "pull-off", f"{line:<{width}}  {result.label(cell)}".rstrip()
    if len(cells) > _MAX_CELLS:
        yield "", f"... and {len(cells) - _MAX_CELLS} more cells"
    contacts = result.mean("pull_off_contacts")[0].ravel()
    if (few := contacts[contacts < _FEW]).size:
        counted = f"{few.min():.2g}" if few.size == 1 else f"{few.min():.2g} to {few.max():.2g}"
        share = f" in {few.size} of {len(cells)} cells" if len(cells) > 1 else ""
        verb = "carries" if few.max() == few.min() == 1.0 else "carry"
        noun = "contact" if verb == "carries" else "contacts"
        small = "a patch this small" if result.flat else "a body on so few"
        yield "", f"{counted} {noun} {verb} it{share}: {small} does not show the pull-off of a surface"
    yield "", f"({_definition(result)})"


def _definition(result: ResultView) -> str:
    if result.estimator == "expected":
        return "largest tension of the expected law; realisations detach contact by contact and go deeper"
    if result.realizations == 1:
        return "largest tension during unloading; one realisation has no standard error"
    mean = "" if result.control == TRAVEL.name else "; that of the mean law is less"
    return f"largest tension of each realisation during unloading: mean ± standard error{mean}"


def _describe_cell(result: ResultView, cell: tuple[int, ...]) -> str:
    """Describe the pull-off of a cell; empty where no run was computed."""
    runs = _runs(result)[cell]
    having = int(result.pull_off_counts[cell])
    if not runs:
        return ""
    if not having:
        return f"none: {'the unloading ends' if runs == 1 else f'all {runs} unloadings end'} in contact"
    force, error = (float(values[cell]) for values in result.mean("pull_off_force"))
    without = f"; {runs - having} of {runs} unloadings end in contact and have none" if having < runs else ""
    if force == 0.0:
        return f"0 N: contacts part without tension{without}"
    text = format_quantity(force, "N", error=error)
    if result.holds("pull_off_pressure") and math.isfinite(pressure := result.mean("pull_off_pressure")[0][cell]):
        text += f", {format_quantity(float(pressure), 'Pa')}"
    of_mean = float(result.variables["pull_off_force_of_mean"].values[cell])
    if runs > 1 and result.control != TRAVEL.name:  # at equal travel realisations stand at different places
        text += (
            "; the mean law has none" if math.isnan(of_mean) else f"; of the mean law {format_quantity(of_mean, 'N')}"
        )
    return text + without


def _runs(result: ResultView) -> NDArray[np.int64]:
    """Return the number of realisations of each cell that were computed."""
    done = result.done
    if result.keeps_runs:
        return np.asarray(done.sum(axis=-1))
    return np.where(done, result.variables["realization_count"].values, 0).astype(np.int64)

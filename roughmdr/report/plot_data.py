"""Data of a picture: mean and standard error of a variable for each cell and each loading or unloading."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from roughmdr.batch.moments import mean_and_error
from roughmdr.numerics.arguments import Floats
from roughmdr.result.layout import done_of, swept_sizes
from roughmdr.storage.labelled import Labelled


class Curve(NamedTuple):
    """A variable in one cell of a result, over one loading or unloading."""

    cell: int
    pass_number: int
    """Counts the loadings and unloadings of the path, from 0."""
    branch: str
    """"loading" or "unloading"."""
    separation: Floats
    mean: Floats
    error: Floats
    """Standard error of the mean; NaN if there is none."""
    runs: Floats
    """[realization, step]; computed realisations, none if only statistics were kept."""


EXPECTED = "expected"


class OverlayLine(NamedTuple):
    """A curve drawn over a result: a variable in one cell, over the whole path."""

    label: str
    """Name of the theory curve; ``EXPECTED`` for the expected law of the scene."""
    variable: str
    cell: int
    separation: Floats
    values: Floats
    """NaN where the theory gives none."""


def result_curves(result: Labelled, name: str) -> Iterator[Curve]:
    """Yield the curves of a variable, cell by cell."""
    branches = result.coordinates["branch"].values
    passes = np.split(np.arange(branches.size), np.flatnonzero(branches[1:] != branches[:-1]) + 1)
    if name in result.variables:
        runs = result.variables[name].values
        done = done_of(result)
        mean, error = mean_and_error(runs, done)
    else:
        mean, error = (result.variables[f"{name}_{statistic}"].values for statistic in ("mean", "sem"))
        runs, done = np.empty((*mean.shape[:-1], 0, branches.size)), np.empty((*mean.shape[:-1], 0), dtype=bool)
    separation = separations(result)
    for number, cell in enumerate(np.ndindex(mean.shape[:-1])):
        for pass_number, steps in enumerate(passes):
            columns = separation[cell][steps], mean[cell][steps], error[cell][steps], runs[cell][done[cell]][:, steps]
            yield Curve(number, pass_number, str(branches[steps[0]]), *columns)


def separations(result: Labelled) -> Floats:
    """Return the separation [m] of every cell, over the swept keys and step."""
    separation = result.coordinates["separation"]
    sizes = swept_sizes(result)
    shape = [size if name in separation.dims else 1 for name, size in sizes.items()]
    return np.broadcast_to(separation.values.reshape(*shape, -1), (*sizes.values(), separation.values.shape[-1]))

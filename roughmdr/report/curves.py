"""What a picture shows of a variable: for each cell, mean and standard error along each way of the flat."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from roughmdr.numerics.arguments import Floats
from roughmdr.result.layout import done_of, swept_sizes
from roughmdr.result.statistics import mean_and_error
from roughmdr.storage.labelled import Labelled


class Curve(NamedTuple):
    """One cell of a result on one way of the flat, in or out."""

    cell: int
    way: int
    branch: str
    separation: Floats
    mean: Floats
    error: Floats
    """Standard error of the mean; NaN where there is none."""
    runs: Floats
    """[realization, step]; those that were computed, none where they were not kept."""


EXPECTED = "expected"


class Line(NamedTuple):
    """What a law says of a variable in one cell of a result, over the whole way of the flat."""

    law: str
    """Its name; ``EXPECTED`` for the expected law of the scene."""
    variable: str
    cell: int
    separation: Floats
    values: Floats
    """NaN where the law says nothing."""


def curves(result: Labelled, name: str) -> Iterator[Curve]:
    """The curves of a variable, cell by cell."""
    branches = result.coordinates["branch"].values
    ways = np.split(np.arange(branches.size), np.flatnonzero(branches[1:] != branches[:-1]) + 1)
    if name in result.variables:
        runs = result.variables[name].values
        done = done_of(result)
        mean, error = mean_and_error(runs, done)
    else:
        mean, error = (result.variables[f"{name}_{what}"].values for what in ("mean", "sem"))
        runs, done = np.empty((*mean.shape[:-1], 0, branches.size)), np.empty((*mean.shape[:-1], 0), dtype=bool)
    separation = separations(result)
    for number, cell in enumerate(np.ndindex(mean.shape[:-1])):
        for way, steps in enumerate(ways):
            own = runs[cell][done[cell]][:, steps]
            columns = separation[cell][steps], mean[cell][steps], error[cell][steps], own
            yield Curve(number, way, str(branches[steps[0]]), *columns)


def separations(result: Labelled) -> Floats:
    """The separation [m] of every cell, over the swept keys and step."""
    separation = result.coordinates["separation"]
    sizes = swept_sizes(result)
    shape = [size if name in separation.dims else 1 for name, size in sizes.items()]
    return np.broadcast_to(separation.values.reshape(*shape, -1), (*sizes.values(), separation.values.shape[-1]))

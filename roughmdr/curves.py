"""What a picture shows of a variable: for each cell, mean and standard error along each way of the flat."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from roughmdr.arguments import Floats
from roughmdr.labelled import Labelled
from roughmdr.statistics import summarise


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
    """[realization, step]; no realisations where they were not kept."""


def held_variables(result: Labelled) -> list[str]:
    """The variables whose curves a result holds."""
    return [
        name.removesuffix("_mean")
        for name, array in result.variables.items()
        if array.dims[-1:] == ("step",) and not name.endswith(("_sem", "_min", "_max"))
    ]


def curves(result: Labelled, name: str) -> Iterator[Curve]:
    """The curves of a variable, cell by cell."""
    branches = result.coordinates["branch"].values
    ways = np.split(np.arange(branches.size), np.flatnonzero(branches[1:] != branches[:-1]) + 1)
    statistics, runs = result.variables, np.empty((*_shape(result), 0, branches.size))
    if name in result.variables:
        runs = result.variables[name].values
        statistics = summarise(name, (), runs, branches == "unloading")
    mean, error = statistics[f"{name}_mean"].values, statistics[f"{name}_sem"].values
    separation = _over_cells(result)
    for number, cell in enumerate(np.ndindex(mean.shape[:-1])):
        for way, steps in enumerate(ways):
            columns = separation[cell][steps], mean[cell][steps], error[cell][steps], runs[cell][:, steps]
            yield Curve(number, way, str(branches[steps[0]]), *columns)


def _shape(result: Labelled) -> tuple[int, ...]:
    return tuple(result.sizes[name] for name in swept_dimensions(result))


def swept_dimensions(result: Labelled) -> list[str]:
    """The dimensions of a result's cells."""
    return [name for name in result.variables["status"].dims if name != "realization"]


def _over_cells(result: Labelled) -> Floats:
    """The separation [..., step] of every cell."""
    separation = result.coordinates["separation"]
    shape = [result.sizes[name] if name in separation.dims else 1 for name in swept_dimensions(result)]
    return np.broadcast_to(separation.values.reshape(*shape, -1), (*_shape(result), separation.values.shape[-1]))

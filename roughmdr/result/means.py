"""Means over the realisations of a result, whether it holds these or their statistics."""

import numpy as np

from roughmdr.batch.moments import mean_and_error
from roughmdr.numerics.arguments import Floats
from roughmdr.result.layout import done_of
from roughmdr.storage.labelled import Labelled


def holds(result: Labelled, name: str) -> bool:
    """Return whether a result has a variable, or its statistics."""
    return name in result.variables or f"{name}_mean" in result.variables


def pull_off_counts(result: Labelled) -> Floats:
    """Return how many realisations of each cell have a pull-off, in a part of a result those that it holds."""
    if "pull_off_force" in result.variables:
        having: Floats = np.isfinite(result.variables["pull_off_force"].values).sum(axis=-1, dtype=np.float64)
        return having
    return np.asarray(result.variables["pull_off_count"].values)


def mean_of(result: Labelled, name: str) -> tuple[Floats, Floats]:
    """Return the mean of a variable and its standard error, over the swept keys, and over step for a curve.

    NaN for the error of a single realisation, and for both where none was computed. Of the numbers of pull-offs those
    that there are count.
    """
    if f"{name}_mean" in result.variables:
        return result.variables[f"{name}_mean"].values, result.variables[f"{name}_sem"].values
    array = result.variables[name]
    return mean_and_error(array.values, done_of(result) if "step" in array.dims else np.isfinite(array.values))

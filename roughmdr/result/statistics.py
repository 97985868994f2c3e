"""Statistics of realisations: mean, standard error, minimum and maximum."""

import math

import numpy as np
from numpy.typing import NDArray

from roughmdr.batch.moments import Moments, moments_of
from roughmdr.numerics.arguments import Floats
from roughmdr.storage.labelled import Array
from roughmdr.variables import CURVE_VARIABLES

_INFINITE_VARIANCE = "not computed where contacts detach: there k goes to minus infinity and has no finite variance"


def summarise(
    name: str, dims: tuple[str, ...], moments: Moments, sem: Floats, at_detachment: NDArray[np.bool_]
) -> dict[str, Array]:
    """Return ``NAME_mean``, ``_sem``, ``_min``, ``_max`` of a variable over dims, from its moments and standard error.

    ``at_detachment`` [..., step] tells where contacts may be at the point of detachment. NaN stands for a standard
    error that is not computed: that of a single realisation, and of the stiffness there, since its variance is
    infinite.
    """
    variable = CURVE_VARIABLES[name]
    comment = {}
    if name == "stiffness" and at_detachment.any():
        sem[at_detachment] = math.nan
        comment = {"comment": _INFINITE_VARIANCE}

    def array(numbers: Floats, statistic: str, attrs: dict[str, str]) -> Array:
        return Array(
            dims, numbers, {"units": variable.units, "long_name": f"{statistic} of {variable.long_name}", **attrs}
        )

    return {
        f"{name}_mean": array(moments.mean, "mean", {"ancillary_variables": f"{name}_sem"}),
        f"{name}_sem": array(sem, "standard error of the mean", comment),
        f"{name}_min": array(moments.minimum, "least", {}),
        f"{name}_max": array(moments.maximum, "greatest", {}),
    }


def mean_and_error(values: Floats, done: NDArray[np.bool_]) -> tuple[Floats, Floats]:
    """Return the mean and its standard error over the realisations that are ``done`` [..., realization], cell by cell.

    ``values`` lie over the same and, where there are more dimensions, over those too. NaN for the error of a single
    realisation, and for both where none is done.
    """
    cells = done.shape[:-1]
    values = np.moveaxis(values, len(cells), 0)
    if done.all():
        moments = moments_of(values)
        return moments.mean, moments.standard_error
    mean, error = (np.full(values.shape[1:], math.nan) for _ in range(2))
    for cell in np.ndindex(cells):
        kept = values[(done[cell], *cell)]
        if len(kept):
            moments = moments_of(kept)
            mean[cell], error[cell] = moments.mean, moments.standard_error
    return mean, error

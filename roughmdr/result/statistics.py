"""What a result holds of many realisations instead of their curves: mean, standard error, least and greatest."""

import math

import numpy as np
from numpy.typing import NDArray

from roughmdr.batch.moments import Moments, moments_of
from roughmdr.numerics.arguments import Floats
from roughmdr.storage.labelled import Array
from roughmdr.variables import CURVE_VARIABLES

_INFINITE_VARIANCE = "not computed where contacts let go: there k runs off to minus infinity and has no finite variance"


def summarise(
    name: str, dims: tuple[str, ...], tally: Moments, sem: Floats, snaps: NDArray[np.bool_]
) -> dict[str, Array]:
    """``NAME_mean``, ``_sem``, ``_min``, ``_max`` of a variable over dims, from its tally and standard error.

    ``snaps`` [..., step] says where contacts may be at the point of letting go. NaN stands for a standard error that is
    not computed: that of a single realisation, and of the stiffness there, since its variance is infinite.
    """
    variable = CURVE_VARIABLES[name]
    remark = {}
    if name == "stiffness" and snaps.any():
        sem[snaps] = math.nan
        remark = {"comment": _INFINITE_VARIANCE}

    def array(numbers: Floats, what: str, attrs: dict[str, str]) -> Array:
        return Array(dims, numbers, {"units": variable.units, "long_name": f"{what} of {variable.long_name}", **attrs})

    return {
        f"{name}_mean": array(tally.mean, "mean", {"ancillary_variables": f"{name}_sem"}),
        f"{name}_sem": array(sem, "standard error of the mean", remark),
        f"{name}_min": array(tally.minimum, "least", {}),
        f"{name}_max": array(tally.maximum, "greatest", {}),
    }


def mean_and_error(values: Floats, done: NDArray[np.bool_]) -> tuple[Floats, Floats]:
    """Mean and its standard error over the realisations that are ``done`` [..., realization], cell by cell.

    ``values`` lie over the same and, where there are more dimensions, over those too. NaN for the error of a single
    realisation, and for both where none is done.
    """
    cells = done.shape[:-1]
    values = np.moveaxis(values, len(cells), 0)
    if done.all():
        whole = moments_of(values)
        return whole.mean, whole.standard_error
    mean, error = (np.full(values.shape[1:], math.nan) for _ in range(2))
    for cell in np.ndindex(cells):
        kept = values[(done[cell], *cell)]
        if len(kept):
            whole = moments_of(kept)
            mean[cell], error[cell] = whole.mean, whole.standard_error
    return mean, error

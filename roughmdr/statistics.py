"""What is kept of many realisations instead of their curves: mean, standard error, least and greatest."""

import math

import numpy as np
from numpy.typing import NDArray

from roughmdr.arguments import Floats
from roughmdr.labelled import Array
from roughmdr.variables import LAW

_INFINITE_VARIANCE = "not computed where contacts let go: there k runs off to minus infinity and has no finite variance"


def mean_and_error(values: Floats, axis: int) -> tuple[Floats, Floats]:
    """Mean and its standard error over the realisations on an axis; the error of a single one is NaN."""
    count = values.shape[axis]
    _, powers = np.frexp(np.max(np.abs(values), axis=axis, keepdims=True))  # no square may leave the range of a float
    scaled, power = np.ldexp(values, -powers), powers.squeeze(axis)
    mean = np.asarray(np.ldexp(scaled.mean(axis=axis), power))
    if count < 2:
        return mean, np.full_like(mean, math.nan)
    return mean, np.asarray(np.ldexp(scaled.std(axis=axis, ddof=1) / math.sqrt(count), power))


def summarise(name: str, dims: tuple[str, ...], values: Floats, snaps: NDArray[np.bool_]) -> dict[str, Array]:
    """``NAME_mean``, ``_sem``, ``_min``, ``_max`` of a variable [..., realization, step] over dims without realization.

    ``snaps`` [..., step] says where contacts may be at the point of letting go. NaN stands for a standard error that is
    not computed: that of a single realisation, and of the stiffness there, since its variance is infinite.
    """
    variable = LAW[name]
    mean, sem = mean_and_error(values, axis=-2)
    remark = {}
    if name == "stiffness" and snaps.any():
        sem[snaps] = math.nan
        remark = {"comment": _INFINITE_VARIANCE}

    def array(numbers: Floats, what: str, attrs: dict[str, str]) -> Array:
        return Array(dims, numbers, {"units": variable.units, "long_name": f"{what} of {variable.long_name}", **attrs})

    return {
        f"{name}_mean": array(mean, "mean", {"ancillary_variables": f"{name}_sem"}),
        f"{name}_sem": array(sem, "standard error of the mean", remark),
        f"{name}_min": array(values.min(axis=-2), "least", {}),
        f"{name}_max": array(values.max(axis=-2), "greatest", {}),
    }

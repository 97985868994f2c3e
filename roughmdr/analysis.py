"""What a result says in a few numbers."""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from roughmdr.arguments import Floats
from roughmdr.errors import StoreError
from roughmdr.labelled import Labelled
from roughmdr.statistics import mean_and_error

if TYPE_CHECKING:
    import xarray as xr


class PullOff(NamedTuple):
    """The pull-off force [N] of each cell of a result: the largest tension along the path, 0 where there is none."""

    mean: Floats
    """Over the realisations."""
    standard_error: Floats
    """NaN for a single realisation, which has none."""
    of_the_mean: bool
    """Whether it is the lowest point of the mean curve, since the realisations were not kept."""


def pull_off_force(result: "Labelled | xr.Dataset") -> PullOff:
    """The pull-off force of a result, over its swept dimensions. StoreError without a force."""
    arrays = result.variables
    if "force" in arrays:
        lowest = np.minimum(np.min(arrays["force"].values, axis=-1), 0.0)
        return PullOff(*mean_and_error(lowest, axis=-1), of_the_mean=False)
    if "force_mean" in arrays:
        mean, error = arrays["force_mean"].values, arrays["force_sem"].values
        where = np.argmin(mean, axis=-1)[..., None]
        lowest, at = (np.take_along_axis(values, where, axis=-1)[..., 0] for values in (mean, error))
        return PullOff(np.minimum(lowest, 0.0), np.where(lowest < 0.0, at, 0.0), of_the_mean=True)
    raise StoreError("the result holds no force: add it to output.variables")

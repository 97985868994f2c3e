"""What a result says in a few numbers."""

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from roughmdr.errors import StoreError

if TYPE_CHECKING:
    import xarray as xr


class PullOff(NamedTuple):
    """The pull-off force [N]: the largest tension along the path, mean over the realisations."""

    mean: float
    standard_error: float
    """NaN for a single realisation, which has none."""


def pull_off_force(result: "xr.Dataset") -> PullOff:
    """The pull-off force of a result, below 0; 0 where the path has no tension. StoreError without a force."""
    if "force" not in result:
        raise StoreError("the result holds no force: add it to output.variables")
    lowest = np.minimum(result["force"].min("step").to_numpy(), 0.0)
    count = lowest.size
    error = float(np.std(lowest, ddof=1)) / math.sqrt(count) if count > 1 else math.nan
    return PullOff(float(np.mean(lowest)), error)


def standard_error(values: "xr.DataArray") -> "xr.DataArray":
    """Standard error of the mean over ``realization``; NaN for a single one."""
    count = values.sizes["realization"]
    if count < 2:
        return values.isel(realization=0) * math.nan
    return values.std("realization", ddof=1) / math.sqrt(count)

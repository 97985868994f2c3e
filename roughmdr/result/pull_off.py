"""The pull-off force of a result."""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from roughmdr.batch.moments import mean_and_error
from roughmdr.errors import StoreError
from roughmdr.numerics.arguments import Floats
from roughmdr.storage.labelled import Labelled
from roughmdr.variables import DONE

if TYPE_CHECKING:
    import xarray as xr


class PullOff(NamedTuple):
    """The pull-off force [N] of each cell of a result: the largest tension while the flat retracts, 0 where none is."""

    mean: Floats  # over the realisations; of the mean curve, where the realisations were not kept
    standard_error: Floats  # NaN for a single realisation, which has none
    change: Floats  # mean change of the force there from step to step of the path: how well the path resolves it
    tensile: NDArray[np.int64]  # number of curves that are tensile at all
    curves: NDArray[np.int64]  # number of curves: the realisations that were computed, or one


def pull_off_force(result: "Labelled | xr.Dataset") -> PullOff:
    """Return the pull-off force of a result, over its swept dimensions.

    StoreError where the result holds no force, or where its flat never retracts.
    """
    data = result if isinstance(result, Labelled) else Labelled.of(result)
    arrays = data.coordinates | data.variables
    retracting = np.flatnonzero(arrays["branch"].values == "unloading")
    if not retracting.size:
        raise StoreError("the flat never retracts, so that nothing is pulled off: add path.unload = true")
    if "force" in arrays:
        curves = arrays["force"].values
    elif "force_mean" in arrays:
        curves = arrays["force_mean"].values[..., None, :]
    else:
        raise StoreError("the result holds no force: add it to output.variables")
    force = curves[..., retracting]
    step = np.argmin(force, axis=-1)[..., None]
    lowest = np.take_along_axis(force, step, axis=-1)[..., 0]
    done = arrays["status"].values == DONE
    done = done if "force" in arrays else done[..., None]
    mean, error = mean_and_error(np.minimum(lowest, 0.0), done)
    if "force" not in arrays:
        at_lowest = np.take_along_axis(arrays["force_sem"].values[..., None, retracting], step, axis=-1)
        error = np.where(mean < 0.0, at_lowest[..., 0, 0], np.where(np.isnan(mean), np.nan, 0.0))
    steps = np.abs(np.diff(curves, axis=-1, append=curves[..., -1:], prepend=curves[..., :1]))
    neighbours = np.maximum(*(np.take_along_axis(steps, retracting[step] + i, axis=-1)[..., 0] for i in (0, 1)))
    change, _ = mean_and_error(neighbours, done)
    return PullOff(mean, error, change, (lowest < 0.0).sum(axis=-1), done.sum(axis=-1))

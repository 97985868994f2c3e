"""A function of numbers applied to every cell of a result, lazily where the result is in chunks."""

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    import xarray as xr


def over(
    dimension: str, function: Callable[..., Any], *arrays: "xr.DataArray", parts: int, **keywords: object
) -> "tuple[xr.DataArray, ...]":
    """Return the ``parts`` results of a function that takes arrays [..., dimension] and gives one number a cell."""
    import xarray as xr

    found: tuple[xr.DataArray, ...] = xr.apply_ufunc(
        function,
        *(in_one_chunk(each, dimension) for each in arrays),
        kwargs=keywords,
        input_core_dims=[[dimension]] * len(arrays),
        output_core_dims=[[]] * parts,
        keep_attrs=False,
        dask="parallelized",
        output_dtypes=[np.float64] * parts,
    )
    return found


def in_one_chunk(array: "xr.DataArray", dimension: str) -> "xr.DataArray":
    """Return an array whose chunks, if it has any, hold all of a dimension."""
    return array if array.chunks is None else array.chunk({dimension: -1})

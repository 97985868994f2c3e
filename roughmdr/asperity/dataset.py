"""Results of one asperity as a dataset."""

from __future__ import annotations

from typing import TYPE_CHECKING

from roughmdr.asperity.contact import Results
from roughmdr.variables import ASPERITY

if TYPE_CHECKING:
    import xarray as xr


def dataset_of(results: Results, control: str | None, attrs: dict[str, str]) -> xr.Dataset:
    """Return results over a control, or without dimension."""
    import xarray as xr

    arrays = {name: ((control,) if n.ndim else (), n, ASPERITY[name].attrs) for name, n in results.items()}
    coords = {} if control is None else {control: arrays.pop(control)}
    return xr.Dataset(arrays, coords=coords, attrs=attrs)

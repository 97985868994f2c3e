"""Numbers that follow from the scene of a result, cell by cell of its sweep."""

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from roughmdr.errors import StoreError
from roughmdr.scene import Scene, read
from roughmdr.schema.toml_text import parse_toml

if TYPE_CHECKING:
    import xarray as xr


def of_cells(dataset: "xr.Dataset", number: Callable[[Scene], float], method: str) -> "xr.DataArray":
    """Return a number of the scene of each cell, over those swept keys that change it, for the cells of a dataset.

    StoreError, which names the method that asks, where the dataset has no scene, or cells that are not in it.
    """
    import xarray as xr

    if "scene" not in dataset.attrs:
        raise StoreError(f"{method} needs the attribute scene, which a result of roughmdr.run has; this one has none")
    scene = read(parse_toml(dataset.attrs["scene"]))
    sizes, coordinates = scene.sweep.sizes, scene.sweep.coordinates()
    numbers = np.array([number(cell) for cell in scene.cells], dtype=np.float64).reshape(tuple(sizes.values()))
    found = xr.DataArray(
        numbers, dims=tuple(sizes), coords={name: coordinates[name] for name in sizes if name in coordinates}
    )
    for name, size in sizes.items():
        if name in coordinates and name in dataset.coords:
            try:
                found = found.sel({name: dataset[name]})
            except KeyError:
                raise StoreError(f"{method} needs {name} as in the scene; this result has other values") from None
        elif dataset.sizes.get(name) != size:
            raise StoreError(f"{method} needs all {size} cells of the sweep along {name}; select some of them after it")
    for dim in found.dims:
        first = found.isel({dim: [0]})
        if bool((found.values == first.values).all()):
            found = first.squeeze(dim)
    return found.drop_vars([name for name in found.coords if name not in found.dims])

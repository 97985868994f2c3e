"""How a result is laid out: its variables, its cells, its realisations."""

import tomllib
from collections.abc import Iterable

import numpy as np

from roughmdr.errors import StoreError
from roughmdr.labelled import Labelled
from roughmdr.variables import LAW


def held_variables(result: Labelled) -> list[str]:
    """The variables whose curves, or their statistics, a result holds."""
    return [
        name.removesuffix("_mean")
        for name, array in result.variables.items()
        if array.dims[-1:] == ("step",) and name.removesuffix("_mean") in LAW
    ]


def estimator_of(result: Labelled) -> str:
    """How the realisations were made."""
    estimator = tomllib.loads(result.attrs["scene"]).get("batch", {}).get("estimator", "sampled")
    return str(estimator)


def asked_variables(result: Labelled, asked: Iterable[str]) -> list[str]:
    """The variables ``asked`` for, or else all that the result holds; StoreError for one that it lacks."""
    held = held_variables(result)
    names = list(asked) or held
    for name in names:
        if name not in held:
            raise StoreError(f"variable {name!r} is not in the result; it holds {', '.join(held)}")
    return names


def realizations_of(result: Labelled) -> int:
    """How many realisations a result is made from."""
    if "realization_count" in result.variables:
        return int(result.variables["realization_count"].values.max())
    return result.sizes["realization"]


def swept_sizes(result: Labelled) -> dict[str, int]:
    """The dimensions of a result's cells."""
    return {name: result.sizes[name] for name in result.variables["status"].dims if name != "realization"}


def cells_of(result: Labelled) -> list[tuple[int, ...]]:
    """The indices of each cell, the last swept dimension fastest; one, empty, without a sweep."""
    return list(np.ndindex(*swept_sizes(result).values()))


def cell_label(result: Labelled, cell: tuple[int, ...]) -> str:
    """The swept values of a cell."""
    names = list(swept_sizes(result))
    parts = []
    for name, array in result.coordinates.items():
        if name not in ("separation", "branch"):
            value = array.values[tuple(cell[names.index(dim)] for dim in array.dims)]
            unit = array.attrs.get("units", "1")
            shown = f"{value:.6g}" if array.values.dtype.kind == "f" else str(value)
            parts.append(f"{name} = {shown}{'' if unit == '1' else f' {unit}'}")
    return ", ".join(parts)

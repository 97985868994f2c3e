"""How a result is laid out: its variables, its cells, its realisations."""

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from roughmdr.errors import StoreError
from roughmdr.schema.toml_text import parse_toml
from roughmdr.storage.labelled import Labelled
from roughmdr.variables import AUXILIARY_COORDINATES, CURVE_VARIABLES, DONE


def held_variables(result: Labelled) -> list[str]:
    """The variables whose curves, or their statistics, a result holds."""
    return [
        name.removesuffix("_mean")
        for name, array in result.variables.items()
        if array.dims[-1:] == ("step",) and name.removesuffix("_mean") in CURVE_VARIABLES
    ]


def estimator_of(result: Labelled) -> str:
    """How the realisations were made; where not all alike, drawn."""
    if "accuracy_method" in result.variables:
        method = result.variables["accuracy_method"]
        taken = {str(method.attrs["flag_meanings"]).split()[number] for number in np.unique(method.values)}
        return taken.pop() if len(taken) == 1 else "sampled"
    return str(parse_toml(result.attrs["scene"]).get("batch", {}).get("estimator", "sampled"))


def method_of(result: Labelled, cell: tuple[int, ...]) -> str:
    """How a cell was computed, where that was for the run to find out; else empty."""
    if "accuracy_method" not in result.variables:
        return ""
    method = result.variables["accuracy_method"]
    return str(method.attrs["flag_meanings"].split()[int(method.values[cell])])


def asked_variables(result: Labelled, asked: Iterable[str]) -> list[str]:
    """The variables ``asked`` for, or else all that the result holds; StoreError for one that it lacks."""
    held = held_variables(result)
    names = list(asked) or held
    for name in names:
        if name not in held:
            raise StoreError(f"variable {name!r} is not in the result; it holds {', '.join(held)}")
    return names


def done_of(result: Labelled) -> NDArray[np.bool_]:
    """Which runs, or cells where the runs were not kept, were computed."""
    return np.asarray(result.variables["status"].values == DONE)


def realizations_of(result: Labelled) -> int:
    """How many realisations a result is made from."""
    if "realization_count" in result.variables:
        return int(result.variables["realization_count"].values.max())
    return result.sizes["realization"]


def realizations_in_words(result: Labelled) -> str:
    """How many realisations a picture is of, and what it shows of them."""
    if estimator_of(result) == "expected":
        return "expected law"
    most = least = realizations_of(result)
    if "realization_count" in result.variables:
        least = int(result.variables["realization_count"].values.min())
    if most == 1:
        return "one realisation"
    return f"{most if most == least else f'{least} to {most}'} realisations, mean ± 2 standard errors"


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
        if name not in AUXILIARY_COORDINATES and array.dims and set(array.dims) <= set(names):
            value = array.values[tuple(cell[names.index(dim)] for dim in array.dims)]
            unit = array.attrs.get("units", "1")
            shown = f"{value:.6g}" if array.values.dtype.kind == "f" else str(value)
            parts.append(f"{name} = {shown}{'' if unit == '1' else f' {unit}'}")
    return ", ".join(parts)

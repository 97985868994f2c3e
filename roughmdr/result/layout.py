"""The layout of a result: its variables, its cells, its realisations."""

from collections.abc import Iterable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from roughmdr.errors import StoreError
from roughmdr.numerics.arguments import Floats
from roughmdr.schema.toml_text import parse_toml
from roughmdr.schema.units import format_quantity
from roughmdr.storage.labelled import Array, Labelled
from roughmdr.variables import (
    AUXILIARY_COORDINATES,
    DONE,
    LATERAL,
    LAW_VARIABLES,
    REFERENCE_VARIABLES,
    REMOTE,
    SEPARATION,
    STEP_COORDINATES,
    TANGENTIAL_VARIABLES,
    TRAVEL,
)

OVER_AREA = {
    "force": "pressure",
    "contact_area": "contact_fraction",
    "pull_off_force": "pull_off_pressure",
    "pull_off_force_of_mean": "pull_off_pressure_of_mean",
    "pull_off_contact_area": "pull_off_contact_fraction",
}
"""Variables that are others over the nominal area."""


def stored_variables(result: Labelled) -> list[str]:
    """Return the variables whose curves, or their statistics, a result holds."""
    return [
        name.removesuffix("_mean")
        for name, array in result.variables.items()
        if array.dims[-1:] == ("step",)
        and name.removesuffix("_mean") in LAW_VARIABLES
        and name.removesuffix("_mean") not in REFERENCE_VARIABLES
    ]


def control_of(result: Labelled) -> str:
    """Return the quantity that the path of a result controls."""
    return next(name for name in STEP_COORDINATES if name in result.coordinates)


def abscissa_of(result: Labelled) -> str:
    """Return what curves are drawn against: the controlled quantity, or what moves as the travel to a preload says."""
    control = control_of(result)
    if control != TRAVEL.name:
        return control
    return REMOTE.name if REMOTE.name in stored_variables(result) else SEPARATION.name


def controlled_values(result: Labelled) -> Floats:
    """Return the controlled quantity of every cell in SI, over the swept keys and step."""
    return coordinate_values(result, control_of(result))


def coordinate_values(result: Labelled, name: str) -> Floats:
    """Return a coordinate over the steps of every cell in SI, over the swept keys and step."""
    values, sizes = result.coordinates[name], swept_sizes(result)
    shape = [size if name in values.dims else 1 for name, size in sizes.items()]
    return np.broadcast_to(values.values.reshape(*shape, -1), (*sizes.values(), values.values.shape[-1]))


def estimator_of(result: Labelled) -> str:
    """Return how the realisations were made; "sampled" where not all alike."""
    if "accuracy_method" in result.variables:
        method = result.variables["accuracy_method"]
        used = {str(method.attrs["flag_meanings"]).split()[number] for number in np.unique(method.values)}
        return used.pop() if len(used) == 1 else "sampled"
    return str(parse_toml(result.attrs["scene"]).get("batch", {}).get("estimator", "sampled"))


def method_of(result: Labelled, cell: tuple[int, ...]) -> str:
    """Return how a cell was computed, where the run chose that; else an empty text."""
    if "accuracy_method" not in result.variables:
        return ""
    method = result.variables["accuracy_method"]
    return str(method.attrs["flag_meanings"].split()[int(method.values[cell])])


def asked_variables(result: Labelled, asked: Iterable[str]) -> list[str]:
    """Return the variables ``asked`` for, or else all that the result holds; StoreError for one that it lacks.

    Of a lateral path those are all that change along it.
    """
    available = stored_variables(result)
    names = list(asked) or [name for name in available if name in TANGENTIAL_VARIABLES]
    names = names if asked or (names and control_of(result) == LATERAL.name) else available
    for name in names:
        if name not in available:
            raise StoreError(f"variable {name!r} is not in the result; it holds {', '.join(available)}")
    return names


def done_of(result: Labelled) -> NDArray[np.bool_]:
    """Return which runs, or cells where the runs were not kept, were computed."""
    return np.asarray(result.variables["status"].values == DONE)


def realizations_of(result: Labelled) -> int:
    """Return the number of realisations that a result is made from, at most of a cell."""
    if "realization_count" in result.variables:
        return int(result.variables["realization_count"].values.max())
    return result.sizes["realization"]


def realizations_in_words(result: Labelled) -> str:
    """Describe how many realisations a picture is of, and what it shows of them."""
    if estimator_of(result) == "expected":
        return "expected law"
    most = fewest = realizations_of(result)
    if "realization_count" in result.variables:
        fewest = int(result.variables["realization_count"].values.min())
    if most == 1:
        return "one realisation"
    return f"{most if most == fewest else f'{fewest} to {most}'} realisations, mean ± 2 standard errors"


def swept_sizes(result: Labelled) -> dict[str, int]:
    """Return the swept dimensions of a result with their sizes."""
    return {name: result.sizes[name] for name in result.variables["status"].dims if name != "realization"}


def cells_of(result: Labelled) -> list[tuple[int, ...]]:
    """Return the indices of each cell, the last swept dimension fastest; one, empty, without a sweep."""
    return list(np.ndindex(*swept_sizes(result).values()))


def swept_values(coordinates: Mapping[str, Array], dims: Sequence[str], cell: tuple[int, ...]) -> dict[str, Array]:
    """Return the value of each swept key, as an array without dimensions, in a cell over the swept dimensions."""
    values = {}
    for name, array in coordinates.items():
        if name not in AUXILIARY_COORDINATES and array.dims and set(array.dims) <= set(dims):
            value = array.values[tuple(cell[dims.index(dim)] for dim in array.dims)]
            values[name] = Array((), np.asarray(value), array.attrs)
    return values


def cell_label(result: Labelled, cell: tuple[int, ...]) -> str:
    """Describe a cell by its swept values."""
    parts = []
    for name, (_, value, attrs) in swept_values(result.coordinates, list(swept_sizes(result)), cell).items():
        is_number = value.dtype.kind in "if"
        shown = format_quantity(float(value), attrs.get("units", "1")) if is_number else str(value)
        parts.append(f"{name} = {shown}")
    return ", ".join(parts)

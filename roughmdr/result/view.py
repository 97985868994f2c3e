"""The reader of results: cells, legs of the path, curves, and means over the realisations."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple, cast

import numpy as np
from numpy.typing import NDArray

from roughmdr.batch.moments import mean_and_error
from roughmdr.errors import StoreError
from roughmdr.numerics.arguments import Floats, Ints
from roughmdr.schema.quantities import adheres
from roughmdr.schema.toml_text import parse_toml
from roughmdr.schema.units import format_quantity
from roughmdr.stages import stages_in
from roughmdr.storage.labelled import Array, Labelled, texts_as_objects
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

if TYPE_CHECKING:
    import xarray as xr


AT_ONCE = 2**26
"""Most bytes of curves that are copied at once: few beside the 1 GB of them that stays in memory."""


class Leg(NamedTuple):
    """A loading or an unloading: neighbouring steps of a path on one branch."""

    branch: str
    steps: Ints


class ResultView:
    """Reads a result, from its arrays or from a Dataset; of one in chunks only the arrays asked for are loaded.

    Properties of a whole result, and means, are computed once, when they are first asked for.
    """

    def __init__(self, data: "Labelled | xr.Dataset") -> None:
        self.data = data
        variables, coordinates = (
            (data.variables, data.coordinates) if isinstance(data, Labelled) else (data.data_vars, data.coords)
        )
        self.variables = cast("Mapping[str, Array]", variables)
        self.coordinates = cast("Mapping[str, Array]", coordinates)
        self.attrs: dict[str, Any] = data.attrs
        self.sizes = cast("Mapping[str, int]", data.sizes)
        self._means: dict[str, tuple[Floats, Floats]] = {}

    @property
    def labelled(self) -> Labelled:
        """The result as arrays."""
        return self.data if isinstance(self.data, Labelled) else Labelled.of(self.data)

    @property
    def dataset(self) -> "xr.Dataset":
        """The result as a Dataset."""
        return self.data.to_xarray() if isinstance(self.data, Labelled) else self.data

    @property
    def doubt(self) -> str:
        """Why the numbers cannot be trusted; empty if they are those that were written."""
        return self.labelled.integrity_fault()

    @cached_property
    def scene(self) -> dict[str, Any]:
        """The scene as a table; empty of a law of one ensemble, which has none."""
        return parse_toml(self.attrs.get("scene", ""))

    @property
    def flat(self) -> bool:
        """Whether a flat presses all asperities alike."""
        return all(stage.flat for stage in stages_in(self.scene))

    @cached_property
    def adheres(self) -> bool:
        """Whether the asperities adhere, in any cell."""
        return adheres(self.scene)

    # the path

    @cached_property
    def control(self) -> str:
        """The quantity that the path controls."""
        return next(name for name in STEP_COORDINATES if self._over_steps(self.coordinates, name))

    @property
    def abscissa(self) -> str:
        """The axis of curves: the controlled quantity; to a preload the remote position or the separation."""
        if self.control != TRAVEL.name:
            return self.control
        return REMOTE.name if REMOTE.name in self.curves else SEPARATION.name

    @property
    def path(self) -> Floats:
        """The controlled quantity in SI: [swept..., step]."""
        return self.over_steps(self.control)

    def over_steps(self, name: str) -> Floats:
        """Return a coordinate over the steps in SI: [swept..., step]."""
        values = self.coordinates[name]
        shape = [size if key in values.dims else 1 for key, size in self.sweep.items()]
        return np.broadcast_to(values.values.reshape(*shape, -1), (*self.sweep.values(), self.sizes["step"]))

    @cached_property
    def branches(self) -> NDArray[np.str_]:
        """The branch of each step."""
        return texts_as_objects(self.coordinates["branch"].values).astype(str)

    @cached_property
    def legs(self) -> list[Leg]:
        """The loadings and unloadings of the path."""
        turns = np.flatnonzero(self.branches[1:] != self.branches[:-1]) + 1
        steps = np.split(np.arange(self.branches.size), turns)
        return [Leg(str(self.branches[each[0]]), each) for each in steps]

    # the cells of the sweep

    @cached_property
    def sweep(self) -> dict[str, int]:
        """The swept dimensions with their sizes."""
        over = [self.variables[name] for name in ("status", *self.variables) if name in self.variables]
        arrays = over[:1] if "status" in self.variables else [each for each in over if "step" in each.dims]
        dims = dict.fromkeys(dim for each in arrays for dim in each.dims)
        return {name: self.sizes[name] for name in dims if name not in ("realization", "step")}

    @cached_property
    def cells(self) -> list[tuple[int, ...]]:
        """The indices of each cell, the last swept dimension fastest; one, empty, without a sweep."""
        return list(np.ndindex(*self.sweep.values()))

    def swept(self, cell: tuple[int, ...]) -> dict[str, Array]:
        """Return the value of each swept key in a cell, as arrays without dimensions."""
        return swept_values(self.coordinates, list(self.sweep), cell)

    def label(self, cell: tuple[int, ...]) -> str:
        """Describe a cell by its swept values."""
        parts = []
        for name, (_, value, attrs) in self.swept(cell).items():
            is_number = value.dtype.kind in "if"
            shown = format_quantity(float(value), attrs.get("units", "1")) if is_number else str(value)
            parts.append(f"{name} = {shown}")
        return ", ".join(parts)

    # the realisations, and their estimators

    @property
    def done(self) -> NDArray[np.bool_]:
        """Which runs, or cells where the runs were not kept, were computed."""
        return np.asarray(self.variables["status"].values == DONE)

    @property
    def keeps_runs(self) -> bool:
        """Whether the result holds each realisation, not statistics over them."""
        return "realization" in self.variables["status"].dims

    @property
    def realizations(self) -> int:
        """The largest number of realisations of a cell."""
        if "realization_count" in self.variables:
            return int(self.variables["realization_count"].values.max())
        return self.sizes.get("realization", 1)

    @cached_property
    def estimator(self) -> str:
        """The estimator of the realisations; "sampled" where they differ."""
        if "accuracy_method" in self.variables:
            used = {self.method(cell) for cell in self.cells}
            return used.pop() if len(used) == 1 else "sampled"
        return str(self.scene.get("batch", {}).get("estimator", "sampled"))

    def method(self, cell: tuple[int, ...]) -> str:
        """Return how a cell was computed, where the run chose that; else an empty text."""
        if "accuracy_method" not in self.variables:
            return ""
        method = self.variables["accuracy_method"]
        return str(method.attrs["flag_meanings"].split()[int(method.values[cell])])

    # variables

    @cached_property
    def keeps_statistics(self) -> bool:
        """Whether the result holds statistics over the realisations in place of their curves."""
        return any(self._over_steps(self.variables, f"{name}_mean") for name in LAW_VARIABLES)

    @cached_property
    def curves(self) -> list[str]:
        """The variables whose curves, or their statistics, the result holds, but for the reference."""
        names = (name.removesuffix("_mean") for name in self.variables if self._over_steps(self.variables, name))
        return [name for name in names if name in LAW_VARIABLES and name not in REFERENCE_VARIABLES]

    def asked(self, names: Iterable[str]) -> list[str]:
        """Return the curves of these ``names``, or else all; StoreError for one that the result lacks.

        On a lateral path, all are those that change along it.
        """
        found = list(names)
        if not found:
            along = [name for name in self.curves if name in TANGENTIAL_VARIABLES]
            return along if along and self.control == LATERAL.name else self.curves
        for name in found:
            if name not in self.curves:
                raise StoreError(f"variable {name!r} is not in the result; it holds {', '.join(self.curves)}")
        return found

    def holds(self, name: str) -> bool:
        """Return whether the result has a variable, or its statistics."""
        return name in self.variables or f"{name}_mean" in self.variables

    def mean(self, name: str) -> tuple[Floats, Floats]:
        """Return the mean of a variable and its standard error, over the swept keys, and over step for a curve.

        NaN for the error of a single realisation, and for both where none was computed. Numbers of pull-offs are
        averaged over the realisations that have one.
        """
        if f"{name}_mean" in self.variables:
            return self.variables[f"{name}_mean"].values, self.variables[f"{name}_sem"].values
        if name not in self._means:
            array = self.variables[name]
            known = self.done if "step" in array.dims else np.isfinite(array.values)
            if known.all() or "step" not in array.dims:
                self._means[name] = mean_and_error(array.values, known)
            else:  # known values of each cell are copied
                blocks = step_blocks(known.shape[-1], self.sizes["step"])
                parts = [mean_and_error(array.values[..., block], known) for block in blocks]
                mean, error = (np.concatenate(each, axis=-1) for each in zip(*parts, strict=True))
                self._means[name] = mean, error
        return self._means[name]

    def known(self, name: str) -> Floats:
        """Return the finite values of a diagnostic, of all runs one after the other; none where it is not stored."""
        values = self.variables[name].values if name in self.variables else np.zeros(0)
        return np.asarray(values[np.isfinite(values)], dtype=np.float64)

    def largest(self, name: str) -> float:
        """Return the largest known value of a diagnostic over all runs; 0 where it is not known or not stored."""
        return float(self.known(name).max(initial=0.0))

    @cached_property
    def pull_off_counts(self) -> Floats:
        """The number of realisations of each cell with a pull-off; a part of a result counts its own."""
        if "pull_off_force" in self.variables:
            having: Floats = np.isfinite(self.variables["pull_off_force"].values).sum(axis=-1, dtype=np.float64)
            return having
        return np.asarray(self.variables["pull_off_count"].values)

    @staticmethod
    def _over_steps(arrays: Mapping[str, Array], name: str) -> bool:
        return name in arrays and "step" in arrays[name].dims


def step_blocks(rows: int, steps: int) -> list[slice]:
    """Return blocks of steps of which that many rows are copied at once."""
    width = max(1, AT_ONCE // (8 * max(rows, 1)))
    return [slice(first, first + width) for first in range(0, steps, width)]


def parts_of(result: ResultView, share: float) -> Iterator[ResultView]:
    """Yield parts of a result, each with some realisations, whose curves are a ``share`` of what is copied at once."""
    count, size = result.sizes.get("realization", 1), sum(each.values.nbytes for each in result.variables.values())
    some = max(1, int(share * AT_ONCE * count / size))
    if some >= count:
        yield result
    else:
        for first in range(0, count, some):
            yield ResultView(result.dataset.isel(realization=slice(first, first + some)))


def swept_values(coordinates: Mapping[str, Array], dims: Sequence[str], cell: tuple[int, ...]) -> dict[str, Array]:
    """Return the value of each swept key, as an array without dimensions, in a cell over the swept dimensions."""
    values = {}
    for name, array in coordinates.items():
        if name not in AUXILIARY_COORDINATES and array.dims and set(array.dims) <= set(dims):
            value = array.values[tuple(cell[dims.index(dim)] for dim in array.dims)]
            values[name] = Array((), np.asarray(value), array.attrs)
    return values

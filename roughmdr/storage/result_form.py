"""The arrays that a result can hold, from the declarations of its variables: dimensions, types, units, companions."""

from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from roughmdr.errors import StoreError
from roughmdr.storage.labelled import Array, Labelled, is_text
from roughmdr.variables import (
    CELL_VARIABLES,
    COORDINATES,
    DERIVATIVE,
    DERIVATIVE_ERROR,
    LAW_VARIABLES,
    MODEL_ERROR,
    PULL_OFF_NUMBERS,
    PULL_OFF_OF_CELLS,
    PULL_OFF_PER_AREA,
    RUN_DIAGNOSTICS,
    STATISTICS,
    STEP_COORDINATES,
    WITH_MODEL_ERROR,
    Attribute,
    Variable,
)

_TYPES = {"f": "floating-point numbers", "i": "whole numbers", "text": "texts"}
_NAMES_OF_TYPES = {str: "text", int: "whole number"}


class Form(NamedTuple):
    """Dimensions, type and unit that an array of a file must have."""

    dims: tuple[str, ...]
    kind: str
    """NumPy's kind of its numbers, or "text"."""
    units: str
    """Empty where it has none."""

    @classmethod
    def of(cls, variable: Variable, dims: tuple[str, ...]) -> "Form":
        """Return the form of a declared variable over dimensions."""
        if variable.codes:
            return cls(dims, "i", "")
        return cls(dims, "f" if variable.units else "text", variable.units)

    def mismatches(self, name: str, array: Array) -> Iterator[str]:
        """Yield how an array differs."""
        if array.dims != self.dims:
            actual, expected = (", ".join(each) or "none" for each in (array.dims, self.dims))
            yield f"{name} has the dimensions {actual}; it must have {expected}"
        found = array.values.dtype.kind
        texts = found in "OU" and self.kind == "text" and all(map(is_text, array.values.flat))
        if not texts and (self.kind == "text" or found != self.kind):
            yield f"{name} is of type {array.values.dtype}; it must be {_TYPES[self.kind]}"
        units = array.attrs.get("units", self.units)
        if self.units and not (is_text(units) and units == self.units):
            shown = repr(units) if is_text(units) else "no text"
            yield f"the units of {name} are {shown}; they must be {self.units!r}"


def forms_of(runs: tuple[str, ...]) -> dict[str, Form]:
    """Return the forms of all variables that a result over the dimensions ``runs`` can hold, by their names."""
    cells = tuple(dim for dim in runs if dim != "realization")
    over_runs = {**LAW_VARIABLES, **PULL_OFF_NUMBERS, **PULL_OFF_PER_AREA}
    dims = {name: (*runs, "step") if name in LAW_VARIABLES else runs for name in over_runs}
    forms = {
        each: Form.of(variable, dims[name])
        for name, variable in over_runs.items()
        for each in (name, *statistics_of(name))
    }
    forms |= {
        f"{name}{statistic}{MODEL_ERROR}": Form.of(LAW_VARIABLES[name], (*runs, "step"))
        for name in WITH_MODEL_ERROR
        for statistic in ("", "_mean")
    }
    forms |= {name: Form.of(variable, runs) for name, variable in RUN_DIAGNOSTICS.items()}
    for ending in (DERIVATIVE, DERIVATIVE_ERROR):
        forms |= {f"{name}{ending}": Form((*cells, "parameter", "step"), "f", "") for name in LAW_VARIABLES}
        forms |= {f"{name}{ending}": Form((*cells, "parameter"), "f", "") for name in PULL_OFF_NUMBERS}
    return forms | {name: Form.of(each, cells) for name, each in (PULL_OFF_OF_CELLS | CELL_VARIABLES).items()}


def control_forms(data: Labelled) -> dict[str, Form]:
    """Return the forms of the coordinates that a result has: over the steps and those swept keys that change them, and
    of its derivatives.
    """
    declared = STEP_COORDINATES | {name: each.units for name, each in COORDINATES.items() if name in ("time", "branch")}
    cells = [dim for dim in data.variables["status"].dims if dim != "realization"]
    forms = {}
    for name, units in declared.items():
        if name in data.coordinates:
            own = () if name == "branch" else tuple(dim for dim in cells if dim in data.coordinates[name].dims)
            forms[name] = Form((*own, "step"), "f" if units else "text", units)
    of_derivatives = {name for name in ("parameter", "parameter_unit") if name in data.coordinates}
    return forms | {name: Form(("parameter",), "text", "") for name in of_derivatives}


def statistics_of(name: str) -> list[str]:
    """Return the names of the statistics of a variable over realisations."""
    return [f"{name}_{statistic}" for statistic in STATISTICS]


def companions(data: Labelled) -> Iterator[list[str]]:
    """Yield lists of variables of which a result has all or none."""
    yield from (statistics_of(name) for name in LAW_VARIABLES)
    yield ["accuracy_method", "accuracy_reached"]
    numbers = {name: each.in_result for name, each in RUN_DIAGNOSTICS.items() if each.dtype is not str}
    for condition in set(numbers.values()) - {numbers["status"]}:  # earlier versions had fewer that all results have
        yield [name for name, own in numbers.items() if own is condition]
    kept = "realization" in data.variables["status"].dims
    for names, of_cells in (
        (PULL_OFF_NUMBERS, ["pull_off_force_of_mean", "pull_off_count"]),
        (PULL_OFF_PER_AREA, ["pull_off_pressure_of_mean"]),
    ):
        yield [each for name in names for each in ([name] if kept else statistics_of(name))] + of_cells


def attribute_faults(attrs: dict[str, Any], declared: dict[str, Attribute]) -> Iterator[str]:
    """Find attributes of a file that are missing or of another type."""
    if missing := [name for name, each in declared.items() if each.required and name not in attrs]:
        yield f"it has no {', '.join(missing)}"
    for name, each in declared.items():
        if name in attrs:
            whole = isinstance(attrs[name], int | np.integer) and not isinstance(attrs[name], bool)
            if not (is_text(attrs[name]) if each.dtype is str else whole):
                yield f"the attribute {name} is no {_NAMES_OF_TYPES[each.dtype]}"
            elif each.names and attrs[name] not in each.names:
                yield f"the attribute {name} is none of {', '.join(each.names)}"


def refuse(faults: Iterable[str], function: str, kind: str, file: Path | None) -> None:
    """Raise StoreError with the first fault of the result of a ``function``, in a ``file`` or in memory."""
    for fault in faults:
        what = f"{kind}: not as roughmdr.{function} returns it"
        raise StoreError(f"{what if file is None else f'{file}: not a {kind} as roughmdr writes it'}: {fault}")


def with_units(data: Labelled, forms: dict[str, Form]) -> Labelled:
    """Return the data with the declared units where an array has none, as after arithmetic of xarray."""

    def completed(arrays: dict[str, Array]) -> dict[str, Array]:
        units = {name: form.units for name, form in forms.items() if form.units}
        return {
            name: array._replace(attrs={"units": units[name], **array.attrs}) if name in units else array
            for name, array in arrays.items()
        }

    return data._replace(variables=completed(data.variables), coordinates=completed(data.coordinates))

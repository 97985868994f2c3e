"""A result, an ensemble or a fit in a few lines."""

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from roughmdr.analysis.pull_off import pull_off
from roughmdr.errors import StoreError
from roughmdr.fitting.words import fit_lines
from roughmdr.result.curves import is_ensemble, is_result
from roughmdr.result.trust import trust_of_result
from roughmdr.result.view import ResultView
from roughmdr.schema.units import format_quantity
from roughmdr.schema.wording import printable
from roughmdr.storage.labelled import Labelled
from roughmdr.storage.result_file import FIT
from roughmdr.variables import AUXILIARY_COORDINATES, BRANCHES, LATERAL, STEP_COORDINATES

if TYPE_CHECKING:
    import xarray as xr

_FEW_CELLS = 3
_MANY_AXES = 3


def describe(dataset: "xr.Dataset") -> Iterator[tuple[str, str]]:
    """Yield the lines on a result, an ensemble or a fit; one line for any other dataset. No curve is loaded."""
    if is_ensemble(dataset):
        yield from _describe_ensemble(dataset)
    elif is_result(dataset):
        yield from _describe_result(ResultView(dataset))
    elif dataset.attrs.get("kind") == FIT and "parameter_name" in dataset.coords:
        yield from fit_lines(Labelled.of(dataset))
    else:
        yield "dataset", "neither a result of roughmdr, nor an ensemble of asperities, nor a fit"


def _describe_result(result: ResultView) -> Iterator[tuple[str, str]]:
    dataset = result.dataset
    yield "result", printable(str(dataset.attrs.get("title", "load-separation law")))
    axes = _axes(result)
    for name, text in axes[:_MANY_AXES]:
        yield "sweep", f"{name} {text}"
    if len(axes) > _MANY_AXES:
        yield "", f"and {len(axes) - _MANY_AXES} more swept keys"
    yield "runs", f"{_runs(result)}, {dataset.sizes['step']} steps"
    branches = [branch for branch in BRANCHES if branch in result.branches]
    yield "path", f"{result.control} {_range(dataset[result.control])}, {' and '.join(branches)}"
    yield "curves", ", ".join(result.curves)
    if result.control != LATERAL.name:
        yield "pull-off", _pull_off(dataset)
    if "model_error" in dataset:
        yield "trust", next((text for name, text in trust_of_result(result) if name == "trust"), "not known")
    if warnings := str(dataset.attrs.get("warnings", "")).splitlines():
        more = f" (and {len(warnings) - 1} more)" if len(warnings) > 1 else ""
        yield "warning", warnings[0] + more


def _axes(result: ResultView) -> list[tuple[str, str]]:
    """Return the swept keys with their ranges."""
    dataset, swept = result.dataset, {*result.sweep}
    others = (*AUXILIARY_COORDINATES, *STEP_COORDINATES)
    names = [str(name) for name, each in dataset.coords.items() if name not in others and {*each.dims} <= swept]
    return [(name, _range(dataset[name])) for name in names]


def _range(array: "xr.DataArray") -> str:
    """Return the range of a coordinate with its unit (a path from its begin), or its names."""
    values = np.atleast_1d(array.to_numpy()).ravel()
    if values.dtype.kind not in "iuf":
        return ", ".join(printable(str(name)) for name in dict.fromkeys(values))
    low, high, unit = float(values.min()), float(values.max()), array.attrs.get("units", "1")
    if "step" in array.dims and values[0] == values[: array.sizes["step"]].max():
        low, high = high, low
    number = "" if "step" in array.dims or values.size == 1 else f" ({values.size} values)"
    return format_quantity(low, unit, to=high) + number


def _runs(result: ResultView) -> str:
    count, kept = result.realizations, "statistics of " if result.keeps_statistics else ""
    if "realization" not in result.sizes and not kept:
        return "one realisation"
    return f"{kept}{count} realisation{'s' * (count > 1)}"


def _pull_off(dataset: "xr.Dataset") -> str:
    """Return the pull-off force of each of a few cells, or its range over many."""
    try:
        found = pull_off(dataset)
    except StoreError:
        return "none: no unloading" if not (dataset["branch"] == "unloading").any() else "not stored"
    force, error = (found[name].to_numpy().ravel() for name in ("force", "force_sem"))
    known, unit = np.isfinite(force), found["force"].attrs["units"]
    if not known.any():
        return "none: the unloading ends in contact"
    if force.size <= _FEW_CELLS:
        return "; ".join(
            format_quantity(float(each), unit, error=float(off)) if np.isfinite(each) else "none"
            for each, off in zip(force, error, strict=True)
        )
    low, high = float(force[known].max()), float(force[known].min())
    return f"{format_quantity(low, unit, to=high)}, in {int(known.sum())} of {force.size} cells"


def _describe_ensemble(dataset: "xr.Dataset") -> Iterator[tuple[str, str]]:
    attrs = dataset.attrs
    yield "ensemble", f"{dataset.sizes['asperity']} asperities of shape {printable(str(attrs['shape']))}"
    if "nominal_area" in attrs:
        yield "area", format_quantity(float(attrs["nominal_area"]), "m2")
    numbers = [str(name) for name, each in dataset.data_vars.items() if each.dims == ("asperity",)]
    for name in [each for each in numbers if each not in ("x", "y")][:6]:
        unit = dataset[name].attrs.get("units", "1")
        mean, low, high = (float(getattr(dataset[name], part)()) for part in ("mean", "min", "max"))
        yield name, f"mean {format_quantity(mean, unit)}, {format_quantity(low, unit, to=high)}"
    if "x" in numbers:
        yield "positions", "x and y"
    if "seed" in attrs:
        yield "seed", str(attrs["seed"])
    if warnings := str(attrs.get("warnings", "")).splitlines():
        yield "warning", warnings[0]

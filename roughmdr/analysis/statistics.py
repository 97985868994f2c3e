"""The statistics over the realisations of a result, as a run with keep = "statistics" stores them."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
import tomli_w
from numpy.typing import NDArray

from roughmdr.batch.moments import statistics_of
from roughmdr.errors import StoreError
from roughmdr.loading.path import LoadingPath
from roughmdr.model_error.at_given import FORCES
from roughmdr.numerics.arguments import Floats
from roughmdr.result.cells import of_cells
from roughmdr.result.curves import apply, result_of, stored_curves
from roughmdr.result.model_errors import errors_along
from roughmdr.result.view import ResultView
from roughmdr.schema.toml_text import parse_toml
from roughmdr.storage.labelled import Labelled
from roughmdr.variables import (
    DONE,
    INFINITE_VARIANCE,
    MODEL_ERROR,
    PULL_OFF,
    REMOTE,
    RUN_DIAGNOSTICS,
    RUN_VARIABLES,
    SEPARATION,
    STATISTICS,
    TRAVEL,
)

if TYPE_CHECKING:
    import xarray as xr

_OVER_CELLS = ("pull_off_count", "pull_off_force_of_mean", "pull_off_pressure_of_mean", "nominal_area")
_ERROR = "_interpolation_error"
_ERRORS = (_ERROR, MODEL_ERROR)
"""Endings of the names of errors, whose statistic is the largest."""
_OF_CURVES = ("cell_key", "remark")
"""Coordinates that describe the runs whose curves were kept."""


def statistics(dataset: "xr.Dataset") -> "xr.Dataset":
    """Return mean, standard error, least and greatest over the realisations of each curve, and the rest merged.

    Of values that were found on curves likewise, over the realisations that have them, with the largest of their
    interpolation errors.
    """
    import xarray as xr

    if "realization" in dataset.dims and any(str(name).endswith(_ERROR) for name in dataset.data_vars):
        return _of_found(dataset)
    result = result_of(dataset)
    if result.keeps_statistics:
        raise StoreError("statistics needs the curves of realisations; this result has their statistics already")
    if "status" not in dataset or "realization" not in dataset["status"].dims:
        raise StoreError("statistics needs the dimension realization, and status; this result has none")
    done = (dataset["status"] == DONE).compute()
    found: dict[str, xr.DataArray] = {}
    for name in stored_curves(result):
        found |= _statistics(dataset, name, done)
    for name in PULL_OFF:
        if name in dataset and "realization" in dataset[name].dims:
            found |= _statistics(dataset, name, dataset[name].notnull())
    found |= {name: dataset[name] for name in _OVER_CELLS if name in dataset}
    counted = xr.full_like(done.any("realization"), dataset.sizes["realization"], dtype=np.float64)
    counted.attrs = RUN_VARIABLES["realization_count"].attrs
    found["realization_count"] = dataset.get("realization_count", counted)
    for name, declared in RUN_DIAGNOSTICS.items():
        if name in dataset.data_vars:
            found[name] = _reduced(dataset[name], declared.merge)
    attrs = {name: value for name, value in dataset.attrs.items() if name != "checksum"}
    if "scene" in attrs:
        table: dict[str, Any] = parse_toml(attrs["scene"])
        table["output"] = {**table.get("output", {}), "keep": "statistics"}
        attrs["scene"] = tomli_w.dumps(table)
    if "remark" in dataset.coords and "realization" in dataset["remark"].dims:
        found["remark"] = _first_text(dataset["remark"])
    kept = [name for name in dataset.coords if name not in _OF_CURVES and "realization" not in dataset[name].dims]
    bare = {name: array.reset_coords(drop=True) for name, array in found.items()}
    coordinates = {name: dataset[name].variable for name in kept}
    reduced = xr.Dataset(bare, coords=coordinates, attrs=attrs)
    if result.control in FORCES:
        reduced = reduced.assign(_model_errors(reduced))
    return reduced.set_coords("remark") if "remark" in bare else reduced


def _model_errors(reduced: "xr.Dataset") -> "Mapping[Any, xr.DataArray]":
    """Return the errors of the model in means along a path on which the force is given; not computed of chunks."""
    import xarray as xr

    def along(loaded: xr.Dataset) -> xr.Dataset:
        errors = errors_along(ResultView(Labelled.of(loaded)))
        return xr.Dataset({name: each[:] for name, each in errors.items()}, loaded.coords).reset_coords(drop=True)

    if not reduced.chunks:
        return along(reduced).data_vars
    return xr.map_blocks(along, reduced.chunk(-1), template=along(xr.ones_like(reduced)).chunk(-1)).data_vars


def _of_found(dataset: "xr.Dataset") -> "xr.Dataset":
    """Return the statistics of values that were interpolated on curves."""
    import xarray as xr

    found: dict[str, xr.DataArray] = {}
    for name in map(str, dataset.data_vars):
        array = dataset[name]
        if name.endswith(_ERRORS):
            found[name] = array.max("realization", keep_attrs=True) if "realization" in array.dims else array
        else:
            found |= _statistics(dataset, name, array.notnull())
    coordinates = {name: array for name, array in dataset.coords.items() if "realization" not in array.dims}
    return xr.Dataset(found, coords=coordinates, attrs=dataset.attrs)


def _statistics(dataset: "xr.Dataset", name: str, counted: "xr.DataArray") -> "dict[str, xr.DataArray]":
    """Return the statistics of a variable over the realisations that are counted."""
    array = dataset[name]
    if array.chunks is not None and "step" in array.dims:
        array = array.chunk({"realization": -1, "step": "auto"})
    found = apply(_counted, array, counted, core=[["realization"]] * 2, out=[[]] * len(STATISTICS))
    parts = dict(zip(STATISTICS, found, strict=True))
    the = "the " if name in PULL_OFF else ""
    attrs = {
        statistic: {**array.attrs, "long_name": f"{said} of {the}{array.attrs['long_name']}"}
        for statistic, said in STATISTICS.items()
    }
    if name not in PULL_OFF:
        attrs["mean"]["ancillary_variables"] = f"{name}_sem"
    if name == "stiffness" and "step" in dataset.dims and (known := _has_variance(dataset)) is not None:
        parts["sem"] = parts["sem"].where(known)
        attrs["sem"]["comment"] = INFINITE_VARIANCE
    return {f"{name}_{statistic}": part.assign_attrs(attrs[statistic]) for statistic, part in parts.items()}


def _counted(values: Floats, counted: NDArray[np.bool_]) -> tuple[Floats, ...]:
    """Return the statistics of those values [..., realization] that are counted in each cell."""
    return statistics_of(values, np.broadcast_to(counted, values.shape))


def _has_variance(dataset: "xr.Dataset") -> "xr.DataArray | None":
    """Return the steps at which the stiffness has a finite variance; None for all.

    It has none where adhesive contacts may be at their detachment, unless the flat is on a spring or under a load.
    """
    import xarray as xr

    control = ResultView(dataset).control
    if control not in (SEPARATION.name, TRAVEL.name) or REMOTE.name in dataset:
        return None
    sign = 1.0 if control == SEPARATION.name else -1.0

    def at_detachment(values: Floats) -> NDArray[np.bool_]:
        return LoadingPath.along(sign * values, unload=False, adhesive=True).at_detachment()

    at = xr.apply_ufunc(
        at_detachment,
        dataset[control].compute(),
        input_core_dims=[["step"]],
        output_core_dims=[["step"]],
        vectorize=True,
    )
    without = at & (of_cells(dataset, lambda scene: scene.work, "statistics") > 0.0)
    return ~without if bool(without.any()) else None


def _reduced(array: "xr.DataArray", rule: str) -> "xr.DataArray":
    """Return a diagnostic merged over the realisations."""
    (merged,) = apply(getattr(np, rule).reduce, array, core=[["realization"]], out=[[]], axis=-1)
    return merged.assign_attrs(array.attrs)


def _first_text(remark: "xr.DataArray") -> "xr.DataArray":
    """Return the first text over the realisations of each cell that is not empty."""
    import xarray as xr

    merged: xr.DataArray = xr.apply_ufunc(
        lambda texts: next(filter(None, map(str, texts)), ""),
        remark.compute(),
        input_core_dims=[["realization"]],
        keep_attrs=True,
        vectorize=True,
        output_dtypes=[object],
    )
    return merged

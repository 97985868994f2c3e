"""All variables of a result where its curves first reach a force, a pressure, a contact fraction or a separation."""

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from roughmdr.errors import OutOfRange
from roughmdr.model_error.parts import PLASTIC
from roughmdr.result.between import CONFIDENCE
from roughmdr.result.brackets import find_brackets, interpolate
from roughmdr.result.curves import (
    PER_AREA,
    Branch,
    Read,
    apply,
    curve,
    is_reference,
    result_of,
    separation_of,
    stored_curves,
)
from roughmdr.result.grid_errors import grid_errors
from roughmdr.result.model_errors import LOADS, errors_there, lowest_so_far
from roughmdr.result.view import ResultView
from roughmdr.schema.arguments import check_values
from roughmdr.variables import LAW_VARIABLES, MODEL_ERROR, SEPARATION

if TYPE_CHECKING:
    import xarray as xr

_IN_JUMPS = ("contact_count", "dissipated_energy", "machine_dissipated_energy")
"""Curves that are constant between jumps."""


def at_value(dataset: "xr.Dataset", name: str, values: ArrayLike, branch: str) -> "xr.Dataset":
    """Return all curves, and the separation, where that of ``name`` first reaches ``values`` on a branch."""
    import xarray as xr

    result = result_of(dataset)
    units = (LAW_VARIABLES | {SEPARATION.name: SEPARATION})[name].units
    wanted = check_values(name, values, units)
    if not np.size(wanted):
        raise OutOfRange(f"{name} is empty; give at least one value")
    if name.endswith("contact_fraction") and np.max(wanted) > 1.0:
        raise OutOfRange(f"{name} is {np.max(wanted):g}; it must be at most 1")
    on = Branch(result, branch)
    own, beside = name.removeprefix("reference_"), " with reference=True" if is_reference(name) else ""
    reached = curve(result, name, f"at_{own}{beside} needs")
    path = curve(result, result.control, "ds.roughmdr needs")
    points = xr.DataArray(np.atleast_1d(wanted), dims=name)
    brackets = apply(find_brackets, reached, points, core=[["step"], [name]], out=[[name]] * 3, branch=on)
    found, read = dict[str, xr.DataArray](), dict[str, Read]()
    curves = {name: reached} | _curves(result, name)
    if PLASTIC in result.variables:
        curves[LOADS] = lowest_so_far(separation_of(result))
    for label, array in curves.items():
        value, error, rise = apply(
            interpolate,
            *(array, reached, path, *brackets),
            core=[["step"]] * 3 + [[name]] * 3,
            out=[[name]] * 3,
            branch=on,
            in_jumps=label.removesuffix("_mean") in _IN_JUMPS,
        )
        read[label.removesuffix("_mean")] = Read(label, value, rise)
        if label in (name, LOADS):
            continue
        attrs = {key: array.attrs[key] for key in ("units", "long_name") if key in array.attrs}
        about = {"long_name": f"interpolation error of the {attrs['long_name']}"}
        found[label] = value.assign_attrs(attrs | {"ancillary_variables": f"{label}_interpolation_error"})
        found[f"{label}_interpolation_error"] = error.assign_attrs(attrs | about)
    for label, error in errors_there(result, name, curves, read).items():
        found[label].attrs["ancillary_variables"] += f" {label}{MODEL_ERROR}"
        found[f"{label}{MODEL_ERROR}"] = error
    found |= grid_errors(read, name)
    coordinate = (name, points.values, {"units": units, "long_name": LAW_VARIABLES[name].long_name})
    points_found = xr.Dataset(found, attrs=_attributes(dataset, name, branch)).assign_coords({name: coordinate})
    return points_found if np.ndim(wanted) else points_found.isel({name: 0})


def _curves(result: ResultView, name: str) -> "dict[str, xr.DataArray]":
    """Return the separation, all curves, and those that follow from them, but those of ``name`` itself."""
    dataset = result.dataset
    curves = {each: curve(result, each, "") for each in stored_curves(result)}
    suffix = "_mean" if result.keeps_statistics else ""
    for derived, total in PER_AREA.items():
        if f"{total}{suffix}" in curves and f"{derived}{suffix}" not in curves and "nominal_area" in dataset:
            curves[f"{derived}{suffix}"] = curve(result, derived, "ds.roughmdr needs")
    control = result.control
    if control in dataset.coords:
        curves = {control: curve(result, control, "ds.roughmdr needs"), **curves}
    if SEPARATION.name not in curves and f"{SEPARATION.name}_mean" not in curves:
        curves = {SEPARATION.name: separation_of(result), **curves}
    return {each: array for each, array in curves.items() if each.removesuffix("_mean") != name}


def _attributes(dataset: "xr.Dataset", name: str, branch: str) -> dict[str, str]:
    """Return the attributes of the interpolated values."""
    missing = f"no value where the {branch} never reaches the {name.replace('_', ' ')}, or from steps without a value"
    about = {
        "branch": branch,
        "comment": f"where it is first reached, by linear interpolation between steps; {missing}; "
        f"interpolation errors, jumps between steps included, hold in {100 * CONFIDENCE:g} % of cases",
    }
    return {key: dataset.attrs[key] for key in ("title",) if key in dataset.attrs} | about

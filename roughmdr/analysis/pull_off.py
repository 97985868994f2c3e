"""The pull-off of each cell of a result, with its standard error."""

from typing import TYPE_CHECKING

import numpy as np

from roughmdr.batch.moments import mean_and_error
from roughmdr.errors import StoreError
from roughmdr.model_error.at_force import pull_off_error
from roughmdr.model_error.parts import PLASTIC
from roughmdr.result.curves import apply, result_of
from roughmdr.variables import ADHESION_CODES

if TYPE_CHECKING:
    import xarray as xr

_MEANS = {
    "force": "pull_off_force",
    "separation": "pull_off_separation",
    "contacts": "pull_off_contacts",
    "pressure": "pull_off_pressure",
    "contact_fraction": "pull_off_contact_fraction",
}
_AS_THEY_ARE = {"count": "pull_off_count", "force_of_mean": "pull_off_force_of_mean"}
_COMMENT = (
    "over the realisations whose unloading does not end in contact: count; no value where there is none, and no "
    "standard error of one"
)


def pull_off(dataset: "xr.Dataset") -> "xr.Dataset":
    """Return the pull-off over the swept keys; StoreError where the path has no unloading."""
    import xarray as xr

    result = result_of(dataset)
    if not (result.branches == "unloading").any():
        raise StoreError("this result has no pull-off: its path has no unloading")
    if not result.holds("pull_off_force"):
        raise StoreError("this result has no pull-off: it was made by a version that did not store any")
    found: dict[str, xr.DataArray] = {}
    for name, stored in _MEANS.items():
        if result.holds(stored):
            mean, error = _mean_and_error(dataset, stored)
            found[name] = mean
            if name == "force":
                about = {"units": "N", "long_name": "standard error of the mean pull-off force"}
                found["force_sem"] = error.assign_attrs(about)
    found |= {name: dataset[stored] for name, stored in _AS_THEY_ARE.items() if stored in dataset}
    if "contact_fraction" in found and "asperity_origin" in dataset and PLASTIC not in dataset:
        found["force_model_error"] = _model_error(dataset, found["force"], found["contact_fraction"])
    return xr.Dataset(found, attrs={"comment": _COMMENT})


def _mean_and_error(dataset: "xr.Dataset", name: str) -> "tuple[xr.DataArray, xr.DataArray]":
    """Return the mean of a number over the realisations that have it, and its standard error."""
    import xarray as xr

    if f"{name}_mean" in dataset:
        return dataset[f"{name}_mean"], dataset[f"{name}_sem"]
    each = dataset[name]
    if "realization" not in each.dims:
        return each, xr.full_like(each, np.nan)
    mean, error = apply(lambda of: mean_and_error(of, np.isfinite(of)), each, core=[["realization"]], out=[[]] * 2)
    attrs = each.attrs | {"long_name": f"mean of the {each.attrs['long_name']}"}
    return mean.assign_attrs(attrs), error


def _model_error(dataset: "xr.Dataset", force: "xr.DataArray", fraction: "xr.DataArray") -> "xr.DataArray":
    """Return the error of the pull-off force by the assumptions of the model [N]."""
    unknown = np.nan * dataset["interaction_error"]
    over_runs = [dim for dim in unknown.dims if dim == "realization"]
    names = ("interaction_error", "slope_error", "asperity_origin", "grid_points")
    others = [dataset.get(name, unknown).max(over_runs) for name in names]
    tabor = dataset.get("tabor_number", unknown)
    if "adhesion_law" in dataset:
        tabor = tabor.where(dataset["adhesion_law"] == ADHESION_CODES.index("jkr"))
    numbers = fraction, tabor.min(over_runs), *others
    (relative,) = apply(pull_off_error, *numbers, core=[[]] * len(numbers), out=[[]])
    about = "estimated error of the pull-off force by the assumptions of the model"
    return (relative * abs(force)).assign_attrs(units="N", long_name=about)

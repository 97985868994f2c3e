"""The energies of a loop: the work of loading, that regained on unloading, and the loss."""

from typing import TYPE_CHECKING

from roughmdr.result.curves import Branch, apply, curve, result_of
from roughmdr.result.loops import loop_energies
from roughmdr.variables import BRANCHES, LATERAL, SEPARATION

if TYPE_CHECKING:
    import xarray as xr

_NAMES = {
    "work_of_loading": "work done on the asperities while loading, from -force d(separation)",
    "work_of_unloading": "work regained from the asperities while unloading, from force d(separation)",
    "energy_lost": "work of loading less that of unloading: what the loop loses where the path ends as it began",
}
_LATERAL_NAMES = {
    "work_of_loading": "work done on the contacts by forward motion, from tangential_force d(lateral)",
    "work_of_unloading": "work regained from the contacts by backward motion, from -tangential_force d(lateral)",
    "energy_lost": "work of loading less that of unloading: what slip loses where the path ends as it began",
}
_HELD = ("dissipated_energy", "machine_dissipated_energy", "friction_energy")
_MISSING = "no value where a step has no force or no separation, as where a dead load has pulled the flat off"


def hysteresis(dataset: "xr.Dataset") -> "xr.Dataset":
    """Return the energies [J] of the loop with their errors; the errors of the mean loop for statistics.

    Of a lateral path they are those of the tangential force over the lateral displacement.
    """
    import xarray as xr

    result = result_of(dataset)
    lateral = result.control == LATERAL.name
    force = curve(result, "tangential_force" if lateral else "force", "hysteresis needs")
    separation = -curve(result, LATERAL.name) if lateral else curve(result, SEPARATION.name)
    loading, unloading = (Branch(result, branch).wanted[1:] for branch in BRANCHES)
    energies = apply(
        loop_energies, force, separation, core=[["step"]] * 2, out=[[]] * 6, loading=loading, unloading=unloading
    )
    found: dict[str, xr.DataArray] = {}
    names = _LATERAL_NAMES if lateral else _NAMES
    for (name, long_name), value, error in zip(names.items(), energies[::2], energies[1::2], strict=True):
        attrs = {"units": "J", "long_name": long_name, "ancillary_variables": f"{name}_interpolation_error"}
        found[name] = value.assign_attrs(attrs)
        about = {"units": "J", "long_name": f"interpolation error of the {name.replace('_', ' ')}"}
        found[f"{name}_interpolation_error"] = error.assign_attrs(about)
    for name in (*_HELD, *(f"{each}_mean" for each in _HELD)):
        if name in dataset:
            found[name] = curve(result, name).isel(step=-1)
    titled = {"title": dataset.attrs["title"]} if "title" in dataset.attrs else {}
    return xr.Dataset(found, attrs=titled | {"comment": _MISSING})

"""The energies of a loop: the work of loading, that regained on unloading, and the loss."""

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from roughmdr.numerics.arguments import Floats
from roughmdr.result.curves import Branch, apply, curve, result_of
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
        _energies, force, separation, core=[["step"]] * 2, out=[[]] * 6, loading=loading, unloading=unloading
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


def _energies(
    force: Floats, separation: Floats, *, loading: NDArray[np.bool_], unloading: NDArray[np.bool_]
) -> tuple[Floats, ...]:
    """Return the work of loading, of unloading, and their difference, each followed by its error.

    By the trapezoid rule. To leave a step out takes away the triangle that it makes with its neighbours. The error is
    a third of the larger change where every other step is left out, as that of smooth curves is, and the root of the
    sum of the squares of the triangles, for jumps: one between two steps makes a triangle of at least its own error.
    """
    force, separation = np.broadcast_arrays(force, separation)
    work = 0.5 * (force[..., 1:] + force[..., :-1]) * np.diff(separation, axis=-1)
    rise, run = np.diff(force, axis=-1), np.diff(separation, axis=-1)
    triangle = 0.5 * (run[..., :-1] * rise[..., 1:] - run[..., 1:] * rise[..., :-1])
    inner = [branch[:-1] & branch[1:] for branch in (loading, unloading)]
    even = np.arange(triangle.shape[-1]) % 2 == 0

    def error(steps: NDArray[np.bool_]) -> Floats:
        changes = (np.abs(_sum(triangle, steps & every_other)) for every_other in (even, ~even))
        return np.asarray(np.maximum(*changes) / 3.0 + np.sqrt(_sum(triangle * triangle, steps)))

    done, regained = -_sum(work, loading), _sum(work, unloading)
    return done, error(inner[0]), regained, error(inner[1]), done - regained, error(inner[0] | inner[1])


def _sum(values: Floats, chosen: NDArray[np.bool_]) -> Floats:
    return np.asarray(values[..., chosen].sum(axis=-1))

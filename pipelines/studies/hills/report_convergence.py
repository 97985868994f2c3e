"""The part of the report on what the force of hills hangs on."""

import numpy as np
import xarray as xr

from studies.hills.convergence import FINEST
from studies.hills.errors import WORDS, percent, rms
from studies.hills.separations import POINTS
from studies.study import table


def report_reference(result: xr.Dataset) -> str:
    """Return in words how far the boundary elements are right that all is held against."""
    elements = result["trial_elements"]
    errors = elements.isel(grid=0) / elements.isel(grid=-1) - 1.0
    found = "; ".join(
        f"{words} within {percent(rms(errors.sel(quantity=quantity)))} r.m.s., "
        f"{percent(float(np.abs(errors.sel(quantity=quantity)).max()))} at most"
        for quantity, words in WORDS.items()
    )
    return (
        f"These elements themselves, against {int(elements['grid'][-1])} points a wave on {result.sizes['trial']} "
        f"isotropic maps: {found}."
    )


def by_points(result: xr.Dataset) -> dict[str, xr.DataArray]:
    """Return over the points a wave the error of the force of hills, what it lacks, and what is said to be lacking."""
    force = result["trial_force_by_points"]
    return {
        "error": _rms_over_maps(force / result["trial_force"] - 1.0),
        "lacking": (1.0 - force / result["trial_force_finest_grid"]).mean(["trial", "fraction"]),
        "stated": result["resolution_error"].mean("trial"),
    }


def by_scales(result: xr.Dataset) -> xr.DataArray:
    """Return the error of the force of hills over their number of contact radii."""
    return _rms_over_maps(result["trial_force_by_scales"] / result["trial_force"] - 1.0)


def by_noise(result: xr.Dataset) -> xr.DataArray:
    """Return by how much noise moves the force of asperities in pairs, [asperities, noise]."""
    force = result["trial_force_by_noise"]
    return _rms_over_maps(force / force.sel(noise=0.0, drop=True) - 1.0).drop_sel(noise=0.0)


def _rms_over_maps(errors: xr.DataArray) -> xr.DataArray:
    return (errors**2).mean(["trial", "fraction"]) ** 0.5


def report_convergence(result: xr.Dataset) -> str:
    """Return what the force hangs on, in tables."""
    hursts = ", ".join(f"{hurst:g}" for hurst in result["trial_hurst"].to_numpy())
    points, scales, noise = by_points(result), by_scales(result), by_noise(result)
    of_points = table(
        ["points a shortest wave", *(f"{n}" for n in result["points"].to_numpy())],
        [
            ["error, r.m.s.", *map(percent, points["error"].to_numpy())],
            [f"too low against {FINEST} points, mean", *map(percent, points["lacking"].to_numpy())],
            ["`resolution_error`", *map(percent, points["stated"].to_numpy())],
        ],
    )
    of_scales = table(
        ["contact radii of a hill", *(f"{n}" for n in result["scales"].to_numpy())],
        [["error, r.m.s.", *map(percent, scales.to_numpy())]],
    )
    of_noise = table(
        ["noise over r.m.s. height", *(percent(n, 0) for n in noise["noise"].to_numpy())],
        [[str(name), *map(percent, noise.sel(asperities=name).to_numpy())] for name in noise["asperities"].to_numpy()],
    )
    return (
        f"What the force of hills hangs on, on {result.sizes['trial']} isotropic maps (Hurst exponents {hursts}). The "
        f"grid of the map, against fine elements and against hills of the finest grid:\n\n{of_points}\n\n"
        f"The number of contact radii, with {POINTS} points a wave:\n\n{of_scales}\n\n"
        f"White noise added to a map with {POINTS} points a wave moves the force by, r.m.s.:\n\n{of_noise}"
    )

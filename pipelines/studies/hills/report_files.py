"""The part of the report on measured maps."""

import numpy as np
import xarray as xr

from roughmdr.ensemble.maps.resolution import MAX_HILLS_ERROR
from studies.hills.errors import errors_on_files, percent, rms
from studies.hills.measured_maps import FILES, FOLDER, FREE_METHODS
from studies.study import table


def report_files(result: xr.Dataset) -> str:
    """Return what was found on measured maps, or that there are none."""
    if "surface" not in result.dims:
        return (
            f"Measured maps were left out: the environment variable {FOLDER} names no folder with {' or '.join(FILES)}."
        )
    names = [str(name) for name in result["surface"].to_numpy()]
    rows = [row for name in names for row in _rows(name, result.sel(surface=name))]
    head = ["map", "method", "force, rms", "mean", "area, rms", "stiffness, rms", "no answer"]
    described = " ".join(_described(name, result.sel(surface=name)) for name in names)
    return (
        "Measured maps, squares from the middle, against boundary elements of a free half-space on the same points: "
        "errors of the forces of all cells, those at the border too, where hills and summits whose tops lie beyond it "
        f"are missing.\n\n{table(head, rows)}\n\n{described}"
    )


def _rows(name: str, own: xr.Dataset) -> list[list[str]]:
    rows = []
    for method in FREE_METHODS:
        force, area, stiffness = (
            errors_on_files(own, quantity).sel(surface_solver=method)
            for quantity in ("force", "contact_fraction", "stiffness")
        )
        known = np.isfinite(force.to_numpy())
        mean = f"{100 * float(force.mean()):+.1f} %" if known.any() else "-"
        missing = percent(float(1.0 - known.mean()), 0)
        rows.append([name, method, percent(rms(force)), mean, percent(rms(area), 0), percent(rms(stiffness)), missing])
    return rows


def _described(name: str, own: xr.Dataset) -> str:
    """Return what to know of a map before its errors are read."""
    border = own["border_share"].to_numpy()
    per_wave, error = float(own["surface_points"] / own["surface_waves"]), float(own["surface_resolution_error"])
    resolved = (
        ""
        if error <= MAX_HILLS_ERROR
        else (
            "; that is too few: elements and hills on these points are held to each other, and neither to the surface, "
            f"whose forces are higher by about {percent(error, 0)} (`resolution_error`)"
        )
    )
    return (
        f"{name}: {int(own['surface_points'])} points and {float(own['surface_waves']):.0f} wavelengths a side, "
        f"{per_wave:.1f} points a wavelength{resolved}. Within one wavelength of the border lies "
        f"{percent(border.min(), 0)} to {percent(border.max(), 0)} of the force.{_answers(own)}"
    )


def _answers(own: xr.Dataset) -> str:
    """Return in words up to which contact fraction methods have an answer, where that is not the last one."""
    parts = []
    for method in FREE_METHODS:
        known = np.isfinite(own["surface_force"].sel(surface_solver=method).to_numpy())
        if not known.any():
            parts.append(f" {method.capitalize()} have no answer at any separation.")
        elif not known.all():
            last = percent(float(own["fraction"].to_numpy()[known].max()), 0)
            parts.append(f" {method.capitalize()} have no equilibrium beyond {last} contact.")
    return "".join(parts)

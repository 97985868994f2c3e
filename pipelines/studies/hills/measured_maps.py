"""Measured maps, which do not repeat: squares from their middle, held against boundary elements of a free half-space.

The files are no part of the project; the environment variable ``ROUGHMDR_SURFACES`` names a folder that holds them.
"""

import os
from pathlib import Path

import numpy as np
import xarray as xr

from roughmdr.ensemble.maps.detrend import remove_trend
from roughmdr.ensemble.maps.height_map import HeightMap
from roughmdr.ensemble.maps.hills.find import wavelength
from roughmdr.ensemble.maps.read_map import read_map
from roughmdr.ensemble.maps.resolution import MAX_HILLS_ERROR, hills_error
from roughmdr.ensemble.maps.summits import find_summits
from studies.comparison import percent, rms
from studies.hills.maps import FRACTIONS, QUANTITIES, by_asperities, by_elements, elements_of, hills_of, where_reached
from studies.study import named, table

FOLDER = "ROUGHMDR_SURFACES"
FILES = ("optical.nc", "afm_film.di")
FREE_METHODS = ("summits", "summits in pairs", "hills")
_ALONE = {"model": "pairwise", "boundary": "free"}
_WAVES, _FEW_WAVES = 32, 12  # most waves a side of a square; the latter in the reduced form
_SEARCHED = 12  # separations, between which those of the fractions are found


def files() -> list[Path]:
    """Return the measured maps that are here."""
    folder = os.environ.get(FOLDER)
    return [path for path in (Path(folder) / name for name in FILES) if path.exists()] if folder else []


def middle_of(path: Path, waves: int) -> HeightMap:
    """Return a square from the middle of a map, a quadratic removed from the whole."""
    surface = read_map(path)
    remove_trend(surface.height, "quadratic")
    points = min(*surface.height.shape, round(waves * wavelength(surface) / surface.dx))
    first, second = ((length - points) // 2 for length in surface.height.shape)
    return surface._replace(height=surface.height[first : first + points, second : second + points].copy())


def measure_files(quick: bool) -> xr.Dataset:
    """Press the maps that are here; nothing where there are none."""
    paths = files()
    if not paths:
        return xr.Dataset()
    measured = [_measure(middle_of(path, _FEW_WAVES if quick else _WAVES)) for path in paths]
    return xr.concat(measured, "surface").assign_coords(surface=[path.name for path in paths])


def _measure(surface: HeightMap) -> xr.Dataset:
    """Press one map by each method."""
    elements, side = elements_of(surface)
    tried = float(elements.height.max()) - np.linspace(0.02, 1.0, _SEARCHED) * float(np.ptp(elements.height))
    separation = side * where_reached(elements, tried, FRACTIONS)
    found = [
        by_elements(surface, separation),
        by_asperities(surface, separation, find_summits, None),
        by_asperities(surface, separation, find_summits, _ALONE),
        by_asperities(surface, separation, hills_of, _ALONE),
    ]
    numbers, over = np.array([each.numbers for each in found]), ("surface_solver", "fraction")
    points, length = surface.height.shape[0], wavelength(surface)
    return xr.Dataset(
        {
            **{f"surface_{name}": (over, numbers[:, i]) for i, name in enumerate(QUANTITIES)},
            "surface_points": ((), points, named("points a side")),
            "surface_waves": ((), points * surface.dx / length, named("wavelengths a side")),
            "surface_resolution_error": ((), hills_error(length / surface.dx)),
        },
        {"surface_solver": ["free elements", *FREE_METHODS], "fraction": list(FRACTIONS)},
    )


def report_files(result: xr.Dataset) -> str:
    """Return what was found on measured maps, or that there are none."""
    if "surface" not in result.dims:
        return (
            f"Measured maps were left out: the environment variable {FOLDER} names no folder with {' or '.join(FILES)}."
        )
    rows, described = [], []
    for name in map(str, result["surface"].to_numpy()):
        own = result.sel(surface=name)
        described.append(_described(name, own))
        for method in FREE_METHODS:
            force, area, stiffness = (errors_on_files(own, each).sel(surface_solver=method) for each in QUANTITIES)
            known = np.isfinite(force.to_numpy())
            mean = f"{100 * float(force.mean()):+.1f} %" if known.any() else "-"
            last = percent(float(own["fraction"].to_numpy()[known].max(initial=0.0)), 0)
            rows.append([name, method, percent(rms(force)), mean, percent(rms(area), 0), percent(rms(stiffness)), last])
    head = ["map", "method", "force, rms", "mean", "area, rms", "stiffness, rms", "answers up to"]
    return (
        "Measured maps, squares from the middle, against boundary elements of a free half-space on the same points: "
        "errors of the forces of all cells, those at the border too, where summits beyond it are missing."
        f"\n\n{table(head, rows)}\n\n{' '.join(described)}"
    )


def errors_on_files(result: xr.Dataset, quantity: str = "force") -> xr.DataArray:
    """Return relative errors on measured maps over surface, surface_solver and fraction."""
    values = result[f"surface_{quantity}"]
    return values.drop_sel(surface_solver="free elements") / values.sel(surface_solver="free elements", drop=True) - 1.0


def _described(name: str, own: xr.Dataset) -> str:
    """Return what to know of a map before its errors are read."""
    per_wave, error = float(own["surface_points"] / own["surface_waves"]), float(own["surface_resolution_error"])
    few = (
        f"; that is too few: elements and hills on these points are held to each other, and neither to the surface, "
        f"whose forces are higher by about {percent(error, 0)} (`resolution_error`)"
    )
    return (
        f"{name}: {int(own['surface_points'])} points and {float(own['surface_waves']):.0f} wavelengths a side, "
        f"{per_wave:.1f} points a wavelength{few if error > MAX_HILLS_ERROR else ''}."
    )

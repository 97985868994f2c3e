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
from roughmdr.ensemble.maps.summits import find_summits
from studies.comparison import ERRORS, each_of, error_cells, errors_against, percent
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
    return xr.Dataset(
        {
            **{f"surface_{name}": (over, numbers[:, i]) for i, name in enumerate(QUANTITIES)},
            "points_per_wave": ((), wavelength(surface) / surface.dx, named("points a wavelength of the hills")),
        },
        {"surface_solver": ["free elements", *FREE_METHODS], "fraction": list(FRACTIONS)},
    )


def report_files(result: xr.Dataset) -> str:
    """Return what was found on measured maps, or that there are none."""
    if "surface" not in result.dims:
        return (
            f"Measured maps were left out: the environment variable {FOLDER} names no folder with {' or '.join(FILES)}."
        )
    rows = []
    for own in each_of(result, "surface"):
        name, per_wave = own["surface"].item(), f"{float(own['points_per_wave']):.1f}"
        for method in FREE_METHODS:
            errors = [errors_on_files(own, quantity).sel(surface_solver=method) for quantity in QUANTITIES]
            known = np.isfinite(errors[0].to_numpy())
            last = percent(float(own["fraction"].to_numpy()[known].max(initial=0.0)), 0)
            rows.append([name, per_wave, method, *error_cells(*errors), last])
    return (
        "Measured maps, squares from the middle, against boundary elements of a free half-space on the same points: "
        "errors of the forces of all cells, those at the border too, where summits beyond it are missing."
        f"\n\n{table(['map', 'points a wavelength', 'method', *ERRORS, 'answers up to'], rows)}"
    )


def errors_on_files(result: xr.Dataset, quantity: str = "force") -> xr.DataArray:
    """Return relative errors on measured maps over surface, surface_solver and fraction."""
    return errors_against(result[f"surface_{quantity}"], "free elements", "surface_solver")

"""Measured maps, which do not repeat: squares from their middle, held against boundary elements of a free half-space.

The files are no part of the project; the environment variable ``ROUGHMDR_SURFACES`` names a folder that holds them.
"""

import os
from pathlib import Path

import numpy as np

from roughmdr.ensemble.maps.detrend import remove_trend
from roughmdr.ensemble.maps.height_map import HeightMap
from roughmdr.ensemble.maps.hills.find import wavelength
from roughmdr.ensemble.maps.read_map import read_map
from roughmdr.ensemble.maps.summits import find_summits
from studies.hills.maps import FRACTIONS, Pressed, by_asperities, by_elements, elements_of, hills_of, where_reached

FOLDER = "ROUGHMDR_SURFACES"
FILES = ("optical.nc", "afm_film.di")
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


def press_files(quick: bool) -> list[tuple[str, list[Pressed]]]:
    """Return each map that is here, by its name, pressed by elements, by summits, alone and in pairs, and by hills."""
    found = []
    for path in files():
        surface = middle_of(path, _FEW_WAVES if quick else _WAVES)
        elements, side = elements_of(surface)
        tried = float(elements.height.max()) - np.linspace(0.02, 1.0, _SEARCHED) * float(np.ptp(elements.height))
        separation = side * where_reached(elements, tried, FRACTIONS)
        solved = [
            by_elements(surface, separation),
            by_asperities(surface, separation, find_summits, None),
            by_asperities(surface, separation, find_summits, _ALONE),
            by_asperities(surface, separation, hills_of, _ALONE),
        ]
        found.append((f"{path.name}, {wavelength(surface) / surface.dx:.1f} points a wavelength", solved))
    return found

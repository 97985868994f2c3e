"""Gaussian self-affine maps, the same on grids of any fineness, and measured ones, pressed by one method: over E*.

Of measured maps, which do not repeat, squares from the middle stand beside boundary elements of a free half-space. The
files are no part of the project; the environment variable ``ROUGHMDR_SURFACES`` names a folder that holds them.
"""

import os
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

import roughmdr as rm
from roughmdr.elements.half_space import BoundaryElements
from roughmdr.ensemble.ensemble import Ensemble
from roughmdr.ensemble.maps.detrend import remove_trend
from roughmdr.ensemble.maps.height_map import HeightMap, MapWaves
from roughmdr.ensemble.maps.hills.find import SCALES, find_hills, wavelength
from roughmdr.ensemble.maps.read_map import read_map
from roughmdr.ensemble.maps.summits import find_summits
from roughmdr.numerics.arguments import Floats
from studies.comparison import law_or_nan
from studies.study import timed

SIDE = 1e-4  # side of the patch [m]
SLOPE = 1e-2  # r.m.s., small: nothing depends on it
_ROLL_OFF = 2.0  # wave number over that of the side, below which the spectrum is level


class MapCase(NamedTuple):
    """A map: Hurst exponent, side over the shortest wave, seed, and length of the waves along over across."""

    hurst: float
    bandwidth: int
    seed: int
    anisotropy: float = 1.0

    def height(self, points: float) -> Floats:
        """Return the map [m] on a grid with so many points a shortest wave."""
        stretch = np.sqrt(self.anisotropy)
        count = 2 * round(0.5 * points * self.bandwidth * stretch)
        number = np.fft.fftfreq(count, 1.0 / count)
        along, across = np.meshgrid(number, number, indexing="ij")
        wave = np.hypot(along * stretch, across / stretch)
        inside = (wave > 0.0) & (wave <= self.bandwidth)
        amplitude = np.where(inside, np.maximum(wave, _ROLL_OFF) ** -(1.0 + self.hurst), 0.0)
        most = int(np.ceil(self.bandwidth * stretch)) + 1
        noise = np.random.default_rng([self.seed, round(10 * self.hurst), self.bandwidth]).standard_normal(
            (2, 2 * most + 1, 2 * most + 1)
        )
        place = np.clip(along, -most, most).astype(int) + most, np.clip(across, -most, most).astype(int) + most
        spectrum = amplitude * (noise[0] + 1j * noise[1])[place]
        height = np.fft.ifft2(spectrum).real
        power = np.abs(np.fft.fft2(height)) ** 2 / count**4
        slope = 2.0 * np.pi / SIDE * np.sqrt(np.sum(power * (along**2 + across**2)))
        return np.asarray(height * (SLOPE / slope))


ISOTROPIC = [
    MapCase(hurst, bandwidth, seed)
    for hurst in (0.3, 0.5, 0.8)
    for bandwidth, seeds in ((8, (11, 12, 13)), (16, (11, 12)), (32, (11, 12)), (64, (11,)))
    for seed in seeds
]
ANISOTROPIC = [MapCase(hurst, bandwidth, 11, 4.0) for hurst in (0.3, 0.5, 0.8) for bandwidth in (8, 16, 32)]
QUICK = [MapCase(0.8, 8, 11), MapCase(0.5, 16, 11), MapCase(0.5, 8, 11, 4.0)]


WORDS = {"force": "force", "contact_fraction": "contact area", "stiffness": "stiffness"}
QUANTITIES = tuple(WORDS)
PAIRS = "pairwise"
STIFFNESS_EACH = 4
"""Steps from one separation to the next at which elements give the stiffness, which costs them two more solutions."""
_DIFFERENCE = 1e-4  # change of a separation each way, over itself


class Pressed(NamedTuple):
    """Force, area and stiffness of a map along a path, over E*, and the run time of the first two."""

    force: Floats  # [m2]
    contact_fraction: Floats
    stiffness: Floats  # -dF/dh [m]
    seconds: float


def square(height: Floats) -> HeightMap:
    """Return heights [m] as a map of the study: periodic, of the side ``SIDE``."""
    return HeightMap(height, SIDE / height.shape[0], SIDE / height.shape[1], True)


def hills_of(surface: HeightMap, scales: int = SCALES) -> Ensemble:
    """Return the hills of a map."""
    return find_hills(surface, find_summits(surface), scales)


def by_elements(surface: HeightMap, separation: Floats) -> Pressed:
    """Return the solution of boundary elements at separations [m]; one after the other, each from the last."""
    started = time.perf_counter()
    elements, side = elements_of(surface)
    seconds = time.perf_counter() - started
    found = np.full((len(QUANTITIES), separation.size), np.nan)
    for i, h in enumerate((separation / side).tolist()):
        started = time.perf_counter()
        found[0, i] = elements.press(h) * side * side
        found[1, i] = elements.patches().area / float(elements.sides.prod())
        seconds += time.perf_counter() - started
        if i % STIFFNESS_EACH == 0:
            found[2, i] = elements.stiffness(h) * side
    return Pressed(found[0], found[1], found[2], seconds)


def elements_of(surface: HeightMap) -> tuple[BoundaryElements, float]:
    """Return boundary elements of a map over its side, and the side [m]."""
    sides = np.array([surface.dx, surface.dy]) * surface.height.shape
    return BoundaryElements(surface.height / sides[0], sides / sides[0], periodic=surface.periodic), float(sides[0])


def where_reached(elements: BoundaryElements, tried: Floats, fractions: Floats, **ends: float | None) -> Floats:
    """Return where elements reach contact fractions, between the separations tried; beyond those the ``ends``."""
    area = np.array([elements.patches().area if elements.press(h) > 0.0 else np.nan for h in tried.tolist()])
    known = area > 0.0
    whole = float(elements.sides.prod())
    return np.asarray(np.interp(np.log(fractions), np.log(area[known] / whole), tried[known], **ends))


def by_asperities(
    surface: HeightMap, separation: Floats, find: Callable[[HeightMap], Ensemble], interaction: Any
) -> Pressed:
    """Return the law of the asperities of a map at separations [m]; NaN where it has none."""
    found, finding = timed(lambda: find(surface).labelled().to_xarray())
    law = partial(law_or_nan, found, separation, effective_modulus=1.0, interaction=interaction)
    (force, contact_fraction), seconds = timed(lambda: law("force", "contact_fraction"))
    return Pressed(force, contact_fraction, law("stiffness")[0], finding + seconds)


def by_elements_and_asperities(surface: HeightMap, separation: Floats, pairs: Any) -> list[Pressed]:
    """Return the solution of boundary elements, and the laws of summits, alone and in pairs, and of hills in pairs."""
    laws = [(find_summits, None), (find_summits, pairs), (hills_of, pairs)]
    return [by_elements(surface, separation), *(by_asperities(surface, separation, *each) for each in laws)]


def by_persson(surface: HeightMap, separation: Floats, gamma: float) -> Pressed:
    """Return Persson's theory of the spectrum of a map at separations [m]; the stiffness by central differences."""
    started = time.perf_counter()
    spectrum = MapWaves.of(surface, None).spectrum
    assert spectrum is not None
    area = surface.height.size * surface.dx * surface.dy

    def pressure(h: Floats) -> Floats:
        return rm.theory.persson_pressure(separation=h, spectrum=spectrum, gamma=gamma, effective_modulus=1.0)

    found = pressure(separation)
    fraction = rm.theory.persson_contact_fraction(pressure=found, rms_slope=spectrum.rms_slope, effective_modulus=1.0)
    seconds = time.perf_counter() - started
    change = _DIFFERENCE * separation
    stiffness = area * (pressure(separation - change) - pressure(separation + change)) / (2.0 * change)
    return Pressed(area * found, fraction, stiffness, seconds)


POINTS = 8  # points a shortest wave of the map, and of the boundary elements that all is compared with
FRACTIONS = np.geomspace(0.003, 0.2, 9)
_POINTS = 4  # a shortest wave, of the elements that look for the separations
_SEARCHED = 12  # separations, between which those of the fractions are found
FOLDER = "ROUGHMDR_SURFACES"
FILES = ("optical.nc", "afm_film.di")
_ALONE = {"model": "pairwise", "boundary": "free"}
_WAVES, _FEW_WAVES = 32, 12  # most waves a side of a square; the latter in the reduced form


def separations(case: MapCase) -> Floats:
    """Return separations [m] of the contact fractions, by coarse boundary elements."""
    height = case.height(_POINTS)
    tried = np.linspace(0.98 * float(height.max()), 0.2 * float(height.std()), _SEARCHED)
    elements, side = elements_of(square(height))
    return side * where_reached(elements, tried / side, FRACTIONS)


def middle_of(path: Path, waves: int) -> HeightMap:
    """Return a square from the middle of a map, a quadratic removed from the whole."""
    surface = read_map(path)
    remove_trend(surface.height, "quadratic")
    points = min(*surface.height.shape, round(waves * wavelength(surface) / surface.dx))
    first, second = ((length - points) // 2 for length in surface.height.shape)
    return surface._replace(height=surface.height[first : first + points, second : second + points].copy())


def press_files(quick: bool) -> list[tuple[str, list[Pressed]]]:
    """Return each map that is here, by its name, with ``by_elements_and_asperities``."""
    folder, found = os.environ.get(FOLDER), []
    for path in filter(Path.exists, (Path(folder, name) for name in FILES if folder)):
        surface = middle_of(path, _FEW_WAVES if quick else _WAVES)
        elements, side = elements_of(surface)
        tried = float(elements.height.max()) - np.linspace(0.02, 1.0, _SEARCHED) * float(np.ptp(elements.height))
        solved = by_elements_and_asperities(surface, side * where_reached(elements, tried, FRACTIONS), _ALONE)
        found.append((f"{path.name}, {wavelength(surface) / surface.dx:.1f} points a wavelength", solved))
    return found

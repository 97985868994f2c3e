"""Gaussian self-affine maps, the same on grids of any fineness, and one such map pressed by one method: over E*."""

import time
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

import roughmdr as rm
from roughmdr.elements.half_space import BoundaryElements
from roughmdr.ensemble.ensemble import Ensemble
from roughmdr.ensemble.maps.height_map import HeightMap
from roughmdr.ensemble.maps.hills.find import SCALES, find_hills
from roughmdr.ensemble.maps.summits import find_summits
from roughmdr.ensemble.maps.waves import MapWaves
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

    @property
    def numbers(self) -> Floats:
        """The quantities over the separations, [quantity, separation]."""
        return np.array([self.force, self.contact_fraction, self.stiffness])


def square(height: Floats) -> HeightMap:
    """Return heights [m] as a map of the study: periodic, of the side ``SIDE``."""
    return HeightMap(height, SIDE / height.shape[0], SIDE / height.shape[1], True)


def hills_of(surface: HeightMap, scales: int = SCALES) -> Ensemble:
    """Return the hills of a map."""
    return find_hills(surface, find_summits(surface), scales)


def by_elements(surface: HeightMap, separation: Floats, *, stiffness: bool = True) -> Pressed:
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
        if stiffness and i % STIFFNESS_EACH == 0:
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

    def law(*variables: str) -> list[Floats]:
        return law_or_nan(found, separation, *variables, effective_modulus=1.0, interaction=interaction)

    found, finding = timed(lambda: find(surface).labelled().to_xarray())
    (force, contact_fraction), seconds = timed(lambda: law("force", "contact_fraction"))
    return Pressed(force, contact_fraction, law("stiffness")[0], finding + seconds)


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


def separations(case: MapCase) -> Floats:
    """Return separations [m] of the contact fractions, by coarse boundary elements."""
    height = case.height(_POINTS)
    tried = np.linspace(0.98 * float(height.max()), 0.2 * float(height.std()), _SEARCHED)
    elements, side = elements_of(square(height))
    return side * where_reached(elements, tried / side, FRACTIONS)

"""Press one map by one method along separations: force, contact area and stiffness, and the run time."""

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
from studies.hills.maps import SIDE

QUANTITIES = ("force", "contact_fraction", "stiffness")
STIFFNESS_EACH = 4
"""Steps from one separation to the next at which elements give the stiffness, which costs them two more solutions."""
_DIFFERENCE = 1e-4  # of a separation, each way, over itself


class Pressed(NamedTuple):
    """Force, area and stiffness of a map along a path, over E*, and the run time of the first two."""

    force: Floats
    """[m2]"""
    contact_fraction: Floats
    stiffness: Floats
    """-dF/dh [m]"""
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


def by_elements(height: Floats, separation: Floats, *, stiffness: bool = True) -> Pressed:
    """Return the solution of boundary elements at separations [m]; one after the other, each from the last."""
    started = time.perf_counter()
    elements = BoundaryElements(height / SIDE, np.array([1.0, 1.0]))
    seconds = time.perf_counter() - started
    found = np.full((len(QUANTITIES), separation.size), np.nan)
    for i, h in enumerate((separation / SIDE).tolist()):
        started = time.perf_counter()
        found[0, i] = elements.press(h) * SIDE * SIDE
        found[1, i] = elements.patches().area
        seconds += time.perf_counter() - started
        if stiffness and i % STIFFNESS_EACH == 0:
            found[2, i] = elements.stiffness(h) * SIDE
    return Pressed(found[0], found[1], found[2], seconds)


def by_asperities(
    surface: HeightMap, separation: Floats, find: Callable[[HeightMap], Ensemble], interaction: Any
) -> Pressed:
    """Return the law of the asperities of a map at separations [m]; NaN where it has none."""
    started = time.perf_counter()
    ensemble = find(surface).labelled().to_xarray()

    def of(*asked: str) -> list[Floats]:
        try:
            law = rm.load_separation(
                ensemble, separation=separation, effective_modulus=1.0, interaction=interaction, variables=asked
            )
        except rm.RoughmdrError:
            return [np.full(separation.size, np.nan)] * len(asked)
        return [law[name].to_numpy() for name in asked]

    force, contact_fraction = of("force", "contact_fraction")
    seconds = time.perf_counter() - started
    return Pressed(force, contact_fraction, of("stiffness")[0], seconds)


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

"""Maps with their adhesion, and the laws and stated errors of their asperities along a path. E* is 1."""

import math
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from oracles.adhesive_elements import AdhesiveMap

from roughmdr.ensemble.maps.summits import find_summits
from roughmdr.numerics.arguments import Floats
from studies.comparison import FACTOR, bounds, cases_of, in_cases, law_of, law_or_nan
from studies.hills.maps import POINTS, SIDE, MapCase, hills_of, square
from studies.study import table

_SEARCHED = 0.05  # step of the separations among which that of the preload is found, over their stretch
SETS = ("calibration", "validation")
_FEWEST, _MOST = 144, 324
"""Points of a grid a side: as many as resolve the cohesive zone; the Tabor number is at most one that they resolve."""
_SEEN = 0.02  # least error of a step that counts, over the largest force
_STATED = {
    "error_rms": ("r.m.s. error", "1"),
    "error_largest": ("largest error", "1"),
    "error_stated": ("stated error", "1"),
    "error_inside": ("share of steps within their stated error", "1"),
}


class Law(NamedTuple):
    """Force over E* [m2] and contact fraction along a path; NaN where there is none."""

    force: Floats
    contact_fraction: Floats


class Case(NamedTuple):
    """A map, its adhesion, the preload and the grid of boundary elements."""

    surface: MapCase
    jump_on: float
    """The radius at which a summit of median curvature jumps on, over the wavelength: the work of adhesion."""
    preload: float  # the contact fraction of independent hills at closest approach
    points: int  # points of the grid, a side of a patch with isotropic waves
    steps: int = 16  # from clear to closest approach
    tabor: float = 2.0  # Tabor number of a summit of median curvature


class Adhesive:
    """The summits and hills of a case, with work of adhesion and range."""

    def __init__(self, case: Case) -> None:
        self.case = case
        surface = square(case.surface.height(POINTS))
        self.summits = find_summits(surface).labelled().to_xarray()
        self.hills = hills_of(surface).labelled().to_xarray()
        radius = float(np.median(self.summits["radius"]))
        jump_on = case.jump_on * self.hills.attrs["wavelength"]
        self.work = jump_on**3 / (2.0 * math.pi * radius**2)
        self.reach = (self.work**2 * radius) ** (1.0 / 3.0) / case.tabor
        self.cohesive_zone = self.reach**2 / self.work
        """E* w/strength^2 [m], which a grid must resolve."""
        self.stretch = jump_on**2 / radius
        """A measure of how far a contact is stretched before it lets go [m]."""

    def path(self) -> Floats:
        """Return separations [m] from clear to the preload and back."""
        height = self.hills["height"].to_numpy()
        clear = deepest = float(height.max()) + self.stretch
        while self.law(self.hills, np.array([clear, deepest])).contact_fraction[1] < self.case.preload:
            deepest -= _SEARCHED * self.stretch
        loading = np.linspace(clear, deepest, self.case.steps)
        return np.concatenate([loading, loading[-2::-1]])

    def law(self, asperities: xr.Dataset, separation: Floats, **asked: Any) -> Law:
        """Return the law of asperities along a path, by JKR unless asked otherwise; NaN where there is none."""
        asked |= {"effective_modulus": 1.0, "work": self.work}
        return Law(*law_or_nan(asperities, separation, "force", "contact_fraction", **asked))

    def by_elements(self, separation: Floats, points: float) -> Law:
        """Return the law by boundary elements; a contact is the mean of what is closed and what is within the range."""
        surface = self.case.surface
        height = surface.height(points / (surface.bandwidth * np.sqrt(surface.anisotropy)))
        elements = AdhesiveMap(height / SIDE, 1.0, self.work / SIDE, self.reach / SIDE)
        states = [elements.move(h / SIDE) for h in separation.tolist()]
        force = np.array([state.force for state in states]) * SIDE**2
        return Law(force, np.array([0.5 * (state.closed + state.attracted) for state in states]))


_MAPS = (MapCase(0.8, 4, 11), MapCase(0.5, 6, 11), MapCase(0.8, 6, 12), MapCase(0.8, 4, 11, 2.0))
WEAK, STRONG = 0.12, 0.2
CASES = [Case(surface, share, preload, 216) for surface in _MAPS for share, preload in ((WEAK, 0.03), (STRONG, 0.02))]
QUICK = [Case(_MAPS[0], share, 0.02, 108, 10) for share in (WEAK, STRONG)]


def drawn(seed: int) -> Case:
    """Return a case with everything drawn: spectrum, work, preload, and a Tabor number from 1 to 4."""
    rng = np.random.default_rng(seed)
    bandwidth, anisotropy = int(rng.choice((4, 5, 6, 8, 12))), float(rng.choice((1.0, 1.0, 1.0, 2.0, 4.0)))
    surface = MapCase(float(rng.uniform(0.3, 0.9)), bandwidth, seed, anisotropy)
    work, preload = float(rng.uniform(0.08, 0.2)), float(rng.uniform(0.02, 0.05))
    return Case(surface, work, preload, _FEWEST, tabor=float(np.exp(rng.uniform(0.0, np.log(4.0)))))


MAPS = {
    "calibration": [*CASES, *map(drawn, (*range(21, 33), *range(41, 61)))],
    "validation": list(map(drawn, range(71, 91))),
}
FEW = {"calibration": QUICK[:1], "validation": [drawn(61)._replace(steps=QUICK[0].steps)]}


class Stated(NamedTuple):
    """Errors of hills in pairs on a map, over their largest force, at most 1 as the stated one is."""

    rms: float  # root mean square over the steps whose error counts
    largest: float  # largest of a step
    stated: float  # the model_error
    inside: float  # share of the steps with a visible error whose own stated error is no less


def measure_stated(maps: dict[str, list[Case]]) -> xr.Dataset:
    """Return the errors of the maps of both sets."""
    found = in_cases(_STATED, [_errors(case) for name in SETS for case in maps[name]], "map")
    return xr.Dataset(found, {"set": ("map", [name for name in SETS for _ in maps[name]])})


def _errors(case: Case) -> Stated:
    """Return the errors of a map."""
    adhesive = Adhesive(case)
    resolved = math.sqrt(adhesive.cohesive_zone * _MOST / SIDE)
    if resolved < 1.0:
        adhesive = Adhesive(case._replace(tabor=resolved * case.tabor))
    separation, points = adhesive.path(), max(_FEWEST, SIDE / adhesive.cohesive_zone)
    true = adhesive.by_elements(separation, points).force
    asked = {"effective_modulus": 1.0, "work": adhesive.work, "interaction": "pairwise", "range": adhesive.reach}
    hills = law_of(adhesive.hills, separation=separation, variables=("force", "model_error_curve"), **asked)
    return compare(true, hills["force"].to_numpy(), hills["model_error_curve"].to_numpy())


def compare(true: Floats, force: Floats, stated: Floats) -> Stated:
    """Return the errors of forces of which at each step an error over the largest is stated; NaN is left out."""
    known = np.isfinite(force)
    true, force, stated = true[known], force[known], stated[known]
    off = np.minimum(np.abs(force - true) / np.abs(force).max(), 1.0)
    seen = off > _SEEN
    inside = float(np.mean(off[seen] <= stated[seen])) if seen.any() else 1.0
    return Stated(float(np.sqrt(np.mean(off[seen] ** 2))) if seen.any() else 0.0, off.max(), stated.max(), inside)


def report_stated(result: xr.Dataset) -> str:
    """Return the table of how often the stated error bounds, by sets."""
    rows = []
    for name in SETS:
        own = cases_of(result, set=name)
        rms, largest, stated, inside = (own[name].to_numpy() for name in _STATED)
        bounded, near = bounds(largest, stated)
        counts = [f"{np.count_nonzero(each)} of {each.size}" for each in (rms <= stated, bounded, near)]
        rows.append([name, *counts, f"{100.0 * inside.mean():.0f} %"])
    head = ["maps", "r.m.s. bounded", "largest step bounded", f"and within a factor of {FACTOR:g}", "steps bounded"]
    return table(head, rows)

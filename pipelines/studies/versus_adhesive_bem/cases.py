"""A few adhesive paraboloids in a periodic patch, their path of separations, and what the models make of them.

All is in units in which E* is 1, the mean radius R is 1, and 2 pi w R^2/E* = a0^3 is 1: a0 is the contact radius to
which one alone jumps on. Lengths along the plane are in a0, across it in a0^2/R, forces in E* a0^3/R.
"""

import math
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

import roughmdr as rm
from roughmdr.numerics.arguments import Floats
from studies.comparison import INTERACTIONS, PAIRS, law_of

WORK = 0.5 / math.pi
DETACHED = -(3.0 * 0.25 ** (4.0 / 3.0))
"""The indentation at which one alone lets go under fixed grips, t^4 - t at t^3 = 1/4: a measure of separations."""
MODELS: dict[str, Any] = {name: INTERACTIONS[name] for name in ("independent", "order 1", "order 2")}
"""Interactions by name; images of the patch are felt by pairs only."""
_STD_RADIUS = 0.1
_LEAST_DISTANCE = 0.7  # least distance over the mean spacing
_ABOVE, _BEYOND = 0.55, 0.85  # path: start and end above the top
_SCANNED = 400  # separations in which the last jump-on is found


class Case(NamedTuple):
    """An ensemble, its adhesion and its grid."""

    asperities: int
    spacing: float  # the side of the area for each [a0]
    tabor: float
    points: int  # a side of the grid of boundary elements
    seed: int = 1
    step: float = 0.05  # between separations
    below: float = 0.15  # distance by which it is pressed beyond the last jump-on
    spread: float = 0.15  # standard deviation of the heights

    @property
    def size(self) -> float:
        """The side of the patch."""
        return self.spacing * math.sqrt(self.asperities)

    @property
    def reach(self) -> float:
        """The range of the attraction, w over its strength."""
        tip = rm.Paraboloid(radius=1.0)
        return float(WORK * rm.tabor(tip, effective_modulus=1.0, work=WORK, strength=1.0) / self.tabor)

    @property
    def coarse(self) -> int:
        """A side of the grid that shows the error of the grid."""
        return 2 * self.points // 3

    def generate(self) -> xr.Dataset:
        """Return the ensemble: lognormal radii, normal heights, none too near another; one alone has radius 1."""
        section: dict[str, object] = {
            "source": "random", "count": self.asperities, "patch": self.size, "shape": "paraboloid", "radius": 1.0,
            "height": {"distribution": "normal", "std": self.spread}, "placement": "random",
        }  # fmt: skip
        if self.asperities > 1:
            section["radius"] = {"distribution": "lognormal", "mean": 1.0, "std": _STD_RADIUS}
            section |= {"placement": "hard_core", "min_distance": _LEAST_DISTANCE * self.spacing}
        return rm.generate(section, seed=self.seed)

    def separations(self, ensemble: xr.Dataset) -> Floats:
        """Return the path: until all are in contact to second order, a little beyond, and until all have let go."""
        height = ensemble["height"].to_numpy()
        scanned = np.linspace(height.max(), height.min() - 1.5, _SCANNED)
        count = law(ensemble, scanned, MODELS["order 2"])["count"]
        deepest = float(scanned[np.flatnonzero(count == self.asperities)[0]]) - self.below
        loading = np.arange(height.max() + _ABOVE, deepest - 0.5 * self.step, -self.step)
        unloading = np.arange(loading[-1] + self.step, height.max() + _BEYOND, self.step)
        return np.concatenate([loading, unloading])


STATED: dict[str, Any] = {
    "independent, JKR": {"adhesion": "jkr"}, "independent, Dugdale": {"adhesion": "dugdale"},
    "pairs, JKR": {"adhesion": "jkr", "interaction": PAIRS[2]},
}  # fmt: skip
"""Models whose stated errors are held against boundary elements (``pipelines/study.py at_pressure``)."""
FLATTER = 1e3  # radii over those of the case: slopes are small, and nothing else changes
PRESSED = (
    Case(4, 7.0, 1.0, 180, 21, below=1.2), Case(1, 12.0, 1.2, 180, below=2.0),
    Case(4, 8.0, 2.0, 402, 22, below=1.2), Case(9, 7.0, 1.5, 396, 23, below=1.0),
    Case(4, 10.0, 2.0, 504, 24, below=1.5), Case(9, 7.0, 2.0, 528, 25, below=1.0),
    Case(4, 6.0, 3.0, 450, 26, below=0.9), Case(16, 7.0, 1.0, 354, 27, below=1.2),
    Case(16, 5.0, 1.0, 252, 51, below=0.3, spread=0.6), Case(16, 5.0, 1.5, 378, 52, below=0.3, spread=0.6),
    Case(9, 6.0, 2.0, 450, 53, below=0.5, spread=0.6), Case(16, 5.0, 2.0, 504, 54, below=0.3, spread=0.6),
)  # fmt: skip
"""Cases for these; others have set the constants."""


def law(ensemble: xr.Dataset, separation: Floats, interaction: Any) -> dict[str, Floats]:
    """Return force, contact area and number of contacts by roughmdr along a path."""
    names = {"force": "force", "area": "contact_area", "count": "contact_count"}
    asked = {"effective_modulus": 1.0, "work": WORK, "adhesion": "jkr", "interaction": interaction}
    found = law_of(ensemble, separation=separation, variables=[*names.values()], **asked)
    return {short: found[name].to_numpy() for short, name in names.items()}


def flat_law(case: Case, ensemble: xr.Dataset, separation: Floats, variables: list[str], **asked: Any) -> xr.Dataset:
    """Return the law of flatter asperities along a path, in eight steps from one separation to the next."""
    flat = ensemble.assign(height=ensemble["height"] / FLATTER, radius=ensemble["radius"] * FLATTER)
    along = np.interp(np.arange(8 * separation.size - 7) / 8, np.arange(separation.size), separation) / FLATTER
    asked = asked | {"work": WORK / FLATTER**2, "range": case.reach / FLATTER, "effective_modulus": 1.0}
    return law_of(flat, separation=along, variables=variables, **asked)

"""The stated error of JKR hills against boundary elements, on maps its constants are from and on others."""

import math
from typing import NamedTuple

import numpy as np
import xarray as xr

from roughmdr.numerics.arguments import Floats
from studies.adhesive_hills.cases import CASES, QUICK, Adhesive, Case
from studies.comparison import FACTOR, bounds, law_of
from studies.hills.maps import SIDE, MapCase
from studies.study import named, table

SETS = ("calibration", "validation")
_FEWEST, _MOST = 144, 324
"""Points of a grid a side: as many as resolve the cohesive zone; the Tabor number is at most one that they resolve."""
_SEEN = 0.02  # least error of a step that counts, over the largest force


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

    rms: float
    """Root mean square over the steps whose error counts."""
    largest: float
    """Largest of a step."""
    stated: float
    """The ``model_error``."""
    inside: float
    """Share of the steps with a visible error whose own stated error is no less."""


def measure_stated(maps: dict[str, list[Case]]) -> xr.Dataset:
    """Return the errors of the maps of both sets."""
    names = [name for name in SETS for _ in maps[name]]
    found = [_errors(case) for name in SETS for case in maps[name]]
    words = ("r.m.s. error", "largest error", "stated error", "share of steps within their stated error")
    columns = zip(Stated._fields, zip(*found, strict=True), words, strict=True)
    return xr.Dataset(
        {f"error_{name}": ("map", list(values), named(word)) for name, values, word in columns}, {"set": ("map", names)}
    )


def _errors(case: Case) -> Stated:
    """Return the errors of a map."""
    adhesive = Adhesive(case)
    resolved = math.sqrt(adhesive.cohesive_zone * _MOST / SIDE)
    if resolved < 1.0:
        adhesive = Adhesive(case._replace(tabor=resolved * case.tabor))
    separation, points = adhesive.path(), max(_FEWEST, SIDE / adhesive.cohesive_zone)
    true = adhesive.by_elements(separation, points, adhesive.reach).force
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
        rms, largest, stated, inside = (
            result[f"error_{each}"].to_numpy()[result["set"].to_numpy() == name] for each in Stated._fields
        )
        bounded, near = bounds(largest, stated)
        counts = [f"{np.count_nonzero(each)} of {each.size}" for each in (rms <= stated, bounded, near)]
        rows.append([name, *counts, f"{100.0 * inside.mean():.0f} %"])
    head = ["maps", "r.m.s. bounded", "largest step bounded", f"and within a factor of {FACTOR:g}", "steps bounded"]
    return table(head, rows)

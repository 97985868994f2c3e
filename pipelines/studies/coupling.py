"""Coupled asperities: error against run time of a load by several methods, and run time against their number."""

import math
from functools import partial
from typing import Any
from unittest.mock import patch

import numpy as np
import xarray as xr
from benchmarks.child import in_new_process
from oracles.boundary_elements import HeightMap

from roughmdr.interaction import solve
from roughmdr.numerics.arguments import Floats
from studies.comparison import PAIRS, in_cases, law_of
from studies.study import Study, named, table, timed
from studies.versus_bem import without_grid
from studies.versus_bem.ensembles import MODULUS, SIZE, Case, height_map, separations

FRACTIONS = np.array([0.01, 0.02, 0.03, 0.05])
GRIDS = {False: (64, 128, 256, 512, 1024), True: (64, 128)}
"""Points a side of boundary elements; the limit of the two finest is what all are held against."""
COUNTS = {False: (100, 200, 300, 500, 1000, 3000, 10_000, 100_000), True: (100, 300, 1000)}
_MOST_DENSE = 3000
_LOADS = np.geomspace(0.01, 0.03, 5)
"""Contact fractions on the way of a load whose time counts."""

_POINT = {"error": ("largest relative error of the force", "1"), "seconds": ("run time of a load", "s")}
_COST = {
    "seconds_dense": ("run time of a load, pairs one by one", "s"),
    "seconds_mesh": ("run time of a load, on a mesh", "s"),
}


def coupled(ensemble: xr.Dataset, separation: Floats, interaction: Any, dense: bool = True) -> Floats:
    """Return forces [N] at separations [m], of pairs one by one or, not ``dense``, on a mesh."""
    limit = dict.fromkeys(solve.DENSE_UP_TO, 10**9 if dense else 0)
    with patch.object(solve, "DENSE_UP_TO", limit):
        law = law_of(ensemble, separation=separation, effective_modulus=MODULUS, variables="force",
                     interaction=interaction)  # fmt: skip
    return law["force"].to_numpy()


def by_boundary_elements(ensemble: xr.Dataset, separation: Floats, points: int) -> tuple[Floats, float]:
    """Return forces [N] at separations [m] on a grid, and the run time [s] of a load."""
    surface = HeightMap(height_map(ensemble, points), SIZE, MODULUS)
    force, seconds = timed(lambda: np.array([surface.press(h).force for h in separation.tolist()]))
    return force, seconds / separation.size


def compare(quick: bool) -> list[tuple[str, str, float, float]]:
    """Return methods on separated paraboloids of lognormal radii: name, setting, error and run time of a load [s]."""
    ensemble = Case("hard_core 0.7", "lognormal", 100, 0.2, 256, 1).generate()
    along = separations(ensemble, FRACTIONS)
    grids = {points: by_boundary_elements(ensemble, along, points) for points in GRIDS[quick]}
    fine, coarse = (grids[points][0] for points in sorted(grids, reverse=True)[:2])
    exact = without_grid(fine, coarse)
    asked: list[tuple[str, str, Any, bool]] = [
        ("independent", "-", None, True),
        ("mean field", "-", "mean_field", True),
    ]
    for order, pairs in PAIRS.items():
        asked.append((f"pairwise, order {order}", "dense", pairs, True))
        asked += [(f"pairwise, order {order}, mesh", f"error {error:g}", {**pairs, "error": error}, False)
                  for error in ((1e-6,) if quick else (1e-3, 1e-6, 1e-9))]  # fmt: skip
    found = []
    for method, setting, *how in asked:
        action = partial(coupled, ensemble, along, *how)
        action()  # compiles
        force, seconds = timed(action, 2)
        found.append((method, setting, _worst(force, exact), seconds / along.size))
    by_grid = ((f"{points} points", _worst(force, exact), seconds) for points, (force, seconds) in grids.items())
    return found + [("boundary elements", *each) for each in by_grid]


def _worst(force: Floats, exact: Floats) -> float:
    return float(np.abs(force / exact - 1.0).max())


def cost(count: int) -> list[float]:
    """Return the run times of a load of pairs one by one and on a mesh [s]; NaN of many one by one."""
    placement = "random" if count > 20_000 else "hard_core 0.5"
    ensemble = Case(placement, "lognormal", count, 0.2, 64, 1).generate()
    along = separations(ensemble, _LOADS)
    found = [math.nan] * (count > _MOST_DENSE)
    for dense in (False,) if found else (True, False):
        coupled(ensemble, along[:1], PAIRS[2], dense)
        found.append(timed(partial(coupled, ensemble, along, PAIRS[2], dense))[1] / along.size)
    return found


def measure(quick: bool) -> xr.Dataset:
    """Return the points of all methods, and the cost for each number of asperities in a process of one core."""
    points = compare(quick)
    costs = [in_new_process(cost, count, NUMBA_NUM_THREADS="1", OMP_NUM_THREADS="1") for count in COUNTS[quick]]
    found = in_cases(_POINT, [point[2:] for point in points], "point") | in_cases(_COST, costs, "asperities")
    words = {name: ("point", [point[i] for point in points]) for i, name in enumerate(("method", "setting"))}
    counts = ("asperities", np.array(COUNTS[quick], dtype=float), named("number of asperities"))
    return xr.Dataset(found, {**words, "asperities": counts})


def report(result: xr.Dataset) -> str:
    """Return both tables."""
    points = (result[name].to_numpy().tolist() for name in ("method", "setting", "error", "seconds"))
    rows = [[method, setting, f"{100.0 * error:.2g} %", f"{1e3 * seconds:.3g} ms"]
            for method, setting, error, seconds in zip(*points, strict=True)]  # fmt: skip
    costs = [
        [f"{count:,.0f}", *("" if math.isnan(each) else f"{1e3 * each:.3g} ms" for each in seconds)]
        for count, *seconds in zip(*(result[name].to_numpy() for name in ("asperities", *_COST)), strict=True)
    ]
    return f"""The largest error of the force of 100 separated paraboloids of lognormal radii, up to 5 % contact:

{table(["method", "setting", "error of the force", "a load"], rows)}

A load to second order on one core, at 1 to 3 % contact:

{table(["asperities", "pairs one by one", "on a mesh"], costs)}
"""


STUDY = Study(
    "coupling", "Coupled asperities: error and run time", measure, {}, report,
    f"up to {max(COUNTS[True])} of {max(COUNTS[False])} asperities, one error; "
    f"boundary elements of up to {max(GRIDS[True])} of {max(GRIDS[False])} points a side",
)  # fmt: skip

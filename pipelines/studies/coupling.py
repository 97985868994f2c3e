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
from studies.comparison import PAIRS, in_cases, law_of, of_rows
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


def coupled(ensemble: xr.Dataset, separation: Floats, interaction: Any, dense: bool) -> Floats:
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


def compare(quick: bool) -> xr.Dataset:
    """Return error and run time of a load by each method, on separated paraboloids of lognormal radii."""
    ensemble = Case("hard_core 0.7", "lognormal", 100, 0.2, 256, 1).generate()
    along = separations(ensemble, FRACTIONS)
    grids = {points: by_boundary_elements(ensemble, along, points) for points in GRIDS[quick]}
    fine, coarse = (grids[points][0] for points in sorted(grids, reverse=True)[:2])
    exact = without_grid(fine, coarse)
    found = {f"boundary elements, {points} points a side": each for points, each in grids.items()}
    for order, pairs in PAIRS.items():
        action = partial(coupled, ensemble, along, pairs, True)
        action()  # compiles
        force, seconds = timed(action, 2)
        found[f"pairwise, order {order}"] = force, seconds / along.size
    rows = [{"method": method, "error": np.abs(force / exact - 1.0).max(), "seconds": seconds}
            for method, (force, seconds) in found.items()]  # fmt: skip
    return of_rows(_POINT, rows, "point")


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
    costs = [in_new_process(cost, count, NUMBA_NUM_THREADS="1", OMP_NUM_THREADS="1") for count in COUNTS[quick]]
    counts = ("asperities", np.array(COUNTS[quick], dtype=float), named("number of asperities"))
    return compare(quick).assign(in_cases(_COST, costs, "asperities")).assign_coords(asperities=counts)


def report(result: xr.Dataset) -> str:
    """Return both tables."""
    points = zip(*(result[name].to_numpy() for name in ("method", "error", "seconds")), strict=True)
    rows = [[method, f"{100.0 * error:.2g} %", f"{1e3 * seconds:.3g} ms"] for method, error, seconds in points]
    costs = [
        [f"{count:,.0f}", *("" if math.isnan(each) else f"{1e3 * each:.3g} ms" for each in seconds)]
        for count, *seconds in zip(*(result[name].to_numpy() for name in ("asperities", *_COST)), strict=True)
    ]
    return f"""The largest error of the force of 100 separated paraboloids of lognormal radii, up to 5 % contact:

{table(["method", "error of the force", "a load"], rows)}

A load to second order on one core, at 1 to 3 % contact:

{table(["asperities", "pairs one by one", "on a mesh"], costs)}
"""


STUDY = Study(
    "coupling", "Coupled asperities: error and run time", measure, {}, report,
    f"up to {max(COUNTS[True])} of {max(COUNTS[False])} asperities; "
    f"boundary elements of up to {max(GRIDS[True])} of {max(GRIDS[False])} points a side",
)  # fmt: skip

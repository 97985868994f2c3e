"""Coupled asperities: error against run time of a load by several methods, and run time against their number."""

import math
from functools import partial
from typing import Any, NamedTuple
from unittest.mock import patch

import numpy as np
import xarray as xr
from benchmarks.process import in_new_process, peak_memory
from oracles.boundary_elements import HeightMap

from roughmdr.interaction import solve
from roughmdr.numerics.arguments import Floats
from studies.comparison import PAIRS, cases_of, in_cases, law_of, panels
from studies.study import Figure, Study, named, table, timed
from studies.versus_bem import without_grid
from studies.versus_bem.ensembles import MODULUS, SIZE, Case, height_map, separations

FRACTIONS = np.array([0.01, 0.02, 0.03, 0.05])
GRIDS = {False: (64, 128, 256, 512, 1024), True: (64, 128)}
"""Points a side of boundary elements; the limit of the two finest is what all are held against."""
COUNTS = {False: (100, 200, 300, 500, 1000, 3000, 10_000, 100_000), True: (100, 300, 1000)}
_MOST_DENSE = 3000
_LOADS = np.geomspace(0.01, 0.03, 5)
"""Contact fractions on the way of a load whose time counts; the last is that of its force."""


_POINT = {"error": ("largest relative error of the force", "1"), "seconds": ("run time of a load", "s")}
_COST = {
    "seconds_mesh": ("run time of a load, on a mesh", "s"),
    "seconds_dense": ("run time of a load, pairs one by one", "s"),
    "difference": ("relative difference of the forces", "1"),
    "memory": ("largest memory of the process", "B"),
}


class Point(NamedTuple):
    """A method on the ensemble."""

    method: str
    setting: str
    error: float  # largest relative error of the force over the loads
    seconds: float  # a load


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


def compare(quick: bool) -> list[Point]:
    """Return all methods on separated paraboloids of lognormal radii."""
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
        found.append(Point(method, setting, _worst(force, exact), seconds / along.size))
    for points, (force, seconds) in grids.items():
        found.append(Point("boundary elements", f"{points} points", _worst(force, exact), seconds))
    return found


def _worst(force: Floats, exact: Floats) -> float:
    return float(np.abs(force / exact - 1.0).max())


def cost(count: int) -> tuple[float, ...]:
    """Return the run times of a load on a mesh and of pairs one by one, how far they differ, and the memory [B]."""
    placement = "random" if count > 20_000 else "hard_core 0.5"
    ensemble = Case(placement, "lognormal", count, 0.2, 64, 1).generate()
    along = separations(ensemble, _LOADS)
    measured = {True: (math.nan, math.nan)}
    for dense in (False, True) if count <= _MOST_DENSE else (False,):
        coupled(ensemble, along[:1], PAIRS[2], dense)
        force, seconds = timed(partial(coupled, ensemble, along, PAIRS[2], dense))
        measured[dense] = force[-1], seconds / along.size
    (force_mesh, seconds_mesh), (force_dense, seconds_dense) = measured[False], measured[True]
    return seconds_mesh, seconds_dense, abs(force_mesh / force_dense - 1.0), peak_memory()


def measure(quick: bool) -> xr.Dataset:
    """Return the points of all methods, and the cost for each number of asperities in a process of one core."""
    points = compare(quick)
    costs = [in_new_process(cost, count, NUMBA_NUM_THREADS="1", OMP_NUM_THREADS="1") for count in COUNTS[quick]]
    found = in_cases(_POINT, [point[2:] for point in points], "point") | in_cases(_COST, costs, "asperities")
    words = {name: ("point", [getattr(point, name) for point in points]) for name in ("method", "setting")}
    counts = ("asperities", np.array(COUNTS[quick], dtype=float), named("number of asperities"))
    return xr.Dataset(found, {**words, "asperities": counts})


def crossover(result: xr.Dataset) -> float:
    """Return the number of asperities from which on a mesh is the faster; infinite where it never is."""
    both = result.dropna("asperities", subset=["seconds_dense"])
    slower = both["asperities"].to_numpy()[(both["seconds_mesh"] > both["seconds_dense"]).to_numpy()]
    larger = both["asperities"].to_numpy()
    beyond = larger[larger > slower.max(initial=0.0)]
    return float(beyond.min()) if beyond.size else float("inf")


def draw(result: xr.Dataset) -> Figure:
    """Draw the error of each method over its run time, and run times over the number of asperities."""
    figure, (left, right) = panels(12, 5.2, 2)
    for name in dict.fromkeys(result["method"].to_numpy().tolist()):
        own = cases_of(result, method=name)
        left.loglog(1e3 * own["seconds"], own["error"], "o-", ms=5, lw=1.2, label=name)
    left.set(xlabel="run time of a load [ms]", ylabel="relative error of the force")
    left.set_title("100 separated paraboloids, up to 5 % contact")
    left.legend(fontsize=8)
    for name, label in (("seconds_dense", "pairs one by one"), ("seconds_mesh", "on a mesh")):
        right.loglog(result["asperities"], result[name], "o-", ms=5, lw=1.2, label=label)
    right.set(xlabel="asperities", ylabel="run time of a load [s]", title="Second order, 1 to 3 % contact, one core")
    right.legend(fontsize=9)
    return figure


def report(result: xr.Dataset) -> str:
    """Return both tables, and from where on a mesh is the faster."""
    points = (result[name].to_numpy().tolist() for name in ("method", "setting", "error", "seconds"))
    rows = [[method, setting, f"{100.0 * error:.2g} %", f"{1e3 * seconds:.3g} ms"]
            for method, setting, error, seconds in zip(*points, strict=True)]  # fmt: skip
    numbers = ("asperities", "seconds_dense", "seconds_mesh", "difference", "memory")
    costs = [
        [f"{count:,.0f}", *("" if math.isnan(each) else f"{1e3 * each:.3g} ms" for each in (dense, mesh)),
         "" if math.isnan(difference) else f"{difference:.1g}", f"{memory / 1e6:.0f} MB"]
        for count, dense, mesh, difference, memory in zip(*(result[name].to_numpy() for name in numbers), strict=True)
    ]  # fmt: skip
    return f"""The largest error of the force of 100 separated paraboloids of lognormal radii, up to 5 % contact:

{table(["method", "setting", "error of the force", "a load"], rows)}

A load to second order on one core, at 1 to 3 % contact:

{table(["asperities", "pairs one by one", "on a mesh", "difference of the forces", "memory"], costs)}

From {crossover(result):.0f} asperities on a mesh is the faster.
"""


STUDY = Study(
    "coupling", "Coupled asperities: error and run time", measure, draw, report,
    f"up to {max(COUNTS[True])} of {max(COUNTS[False])} asperities, one error; "
    f"boundary elements of up to {max(GRIDS[True])} of {max(GRIDS[False])} points a side",
)  # fmt: skip

"""Methods for the force of one ensemble of coupled asperities: what each costs a load, and how far off it is."""

import time
import warnings
from collections.abc import Callable
from functools import partial
from typing import Any, NamedTuple
from unittest.mock import patch

import numpy as np
import xarray as xr
from oracles.boundary_elements import HeightMap

import roughmdr as rm
from roughmdr.interaction import solve
from roughmdr.numerics.arguments import Floats
from studies.versus_bem import without_grid
from studies.versus_bem.ensembles import MODULUS, SIZE, Case, height_map, separations

FRACTIONS = np.array([0.01, 0.02, 0.03, 0.05])
GRIDS = {False: (64, 128, 256, 512, 1024), True: (64, 128)}
"""Points a side of boundary elements; those of twice the finest are what all are held against."""
_PAIRWISE = "pairwise, order {order}"


class Point(NamedTuple):
    """A method on the ensemble."""

    method: str
    setting: str
    error: float
    """Largest relative error of the force over the loads."""
    seconds: float
    """A load."""


def timed(action: Callable[[], Floats], loads: int) -> tuple[Floats, float]:
    """Return forces and the run time [s] of a load, the shorter of two: what has to be compiled is compiled before."""
    seconds = []
    for _ in range(2):
        started = time.perf_counter()
        force = action()
        seconds.append((time.perf_counter() - started) / loads)
    return force, min(seconds)


def coupled(ensemble: xr.Dataset, separation: Floats, interaction: Any, dense: bool = True) -> Floats:
    """Return forces [N] at separations [m], of pairs one by one or, not ``dense``, on a mesh."""
    limit = dict.fromkeys(solve.DENSE_UP_TO, 10**9 if dense else 0)
    with warnings.catch_warnings(), patch.object(solve, "DENSE_UP_TO", limit):
        warnings.simplefilter("ignore", rm.LimitWarning)
        law = rm.load_separation(
            ensemble, separation=separation, effective_modulus=MODULUS, variables="force", interaction=interaction
        )
    return law["force"].to_numpy()


def by_boundary_elements(ensemble: xr.Dataset, separation: Floats, points: int) -> tuple[Floats, float]:
    """Return forces [N] at separations [m] on a grid, and the run time [s] of a load."""
    surface = HeightMap(height_map(ensemble, points), SIZE, MODULUS)
    started = time.perf_counter()
    force = np.array([surface.press(h).force for h in separation.tolist()])
    return force, (time.perf_counter() - started) / separation.size


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
    for order in (1, 2):
        table: dict[str, Any] = {"model": "pairwise", "order": order}
        asked.append((_PAIRWISE.format(order=order), "dense", table, True))
        asked += [(f"{_PAIRWISE.format(order=order)}, mesh", f"error {error:g}", {**table, "error": error}, False)
                  for error in ((1e-6,) if quick else (1e-3, 1e-6, 1e-9))]  # fmt: skip
    found = []
    for method, setting, *how in asked:
        coupled(ensemble, along, *how)
        force, seconds = timed(partial(coupled, ensemble, along, *how), along.size)
        found.append(Point(method, setting, _worst(force, exact), seconds))
    for points, (force, seconds) in grids.items():
        found.append(Point("boundary elements", f"{points} points", _worst(force, exact), seconds))
    return found


def _worst(force: Floats, exact: Floats) -> float:
    return float(np.abs(force / exact - 1.0).max())

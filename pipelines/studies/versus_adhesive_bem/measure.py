"""Adhesive asperities by models and by boundary elements on two grids, along the same path."""

import time
from collections.abc import Sequence

import numpy as np
import xarray as xr
from oracles.adhesive_elements import AdhesiveMap

from roughmdr.numerics.arguments import Floats
from studies.study import named
from studies.versus_adhesive_bem.cases import MODELS, WORK, Case, law
from studies.versus_bem.ensembles import distances, height_map

CASES = (
    Case(1, 8.0, 2.0, 192),
    Case(1, 8.0, 3.0, 288),
    Case(1, 8.0, 4.0, 384),
    Case(1, 8.0, 6.0, 576),
    Case(4, 5.0, 2.0, 256),
    Case(4, 5.0, 3.0, 384),
    Case(4, 5.0, 4.0, 512),
    Case(4, 5.0, 6.0, 720),
    Case(4, 7.0, 2.0, 352),
    Case(4, 7.0, 4.0, 672),
    Case(9, 5.0, 2.0, 384, 2),
)
QUICK = (Case(1, 8.0, 2.0, 144, step=0.08), Case(4, 5.0, 2.0, 192, step=0.08))
SOURCES = (*MODELS, "bem", "coarse")
"""They give force, area and count: the models, and boundary elements on both grids."""
_QUANTITIES = {
    "force": "force over E* a0^3/R",
    "area": "contact area over a0^2; of boundary elements the mean of those closed and within the range",
    "count": "asperities in contact",
}


def by_elements(case: Case, ensemble: xr.Dataset, separation: Floats, points: int) -> dict[str, Floats]:
    """Return force, contact area and number of contacts by boundary elements; one is where the gap at a tip is 0."""
    surface = AdhesiveMap(height_map(ensemble, points), case.size, WORK, case.reach)
    tips = tuple((ensemble[axis].to_numpy() * points / case.size).astype(int) % points for axis in "xy")
    rows = []
    for h in separation.tolist():
        state = surface.move(h)
        rows.append((state.force, 0.5 * (state.closed + state.attracted), np.count_nonzero(surface.gap[tips] == 0.0)))
    return dict(zip(_QUANTITIES, np.array(rows, dtype=float).T, strict=True))


class Compared(dict[str, dict[str, Floats]]):
    """Force, area and count by each source along the path of a case, with the run times of the path [s]."""

    def __init__(self, case: Case) -> None:
        ensemble = case.generate()
        self.nearest = float(distances(ensemble).min())
        self.separation = case.separations(ensemble)
        self.above = self.separation - float(ensemble["height"].max())
        self.seconds: dict[str, float] = {}
        for name in SOURCES:
            started = time.perf_counter()
            if name in MODELS:
                self[name] = law(ensemble, self.separation, MODELS[name])
            else:
                points = case.points if name == "bem" else case.coarse
                self[name] = by_elements(case, ensemble, self.separation, points)
            self.seconds[name] = time.perf_counter() - started


def measure(quick: bool) -> xr.Dataset:
    """Compare all cases, or two of them on coarse grids."""
    cases = QUICK if quick else CASES
    return collect(cases, [Compared(case) for case in cases])


def collect(cases: Sequence[Case], compared: Sequence[Compared]) -> xr.Dataset:
    """Return all numbers, NaN beyond the end of a path."""
    longest = max(one.separation.size for one in compared)

    def padded(rows: list[Floats]) -> Floats:
        return np.array([np.pad(row, (0, longest - row.size), constant_values=np.nan) for row in rows])

    variables = {
        quantity: (("case", "source", "step"),
                   np.stack([padded([one[name][quantity] for one in compared]) for name in SOURCES], axis=1),
                   named(words))
        for quantity, words in _QUANTITIES.items()
    }  # fmt: skip
    seconds = [[one.seconds[name] for name in SOURCES] for one in compared]
    columns = {
        "asperities": ([case.asperities for case in cases], "asperities in the patch"),
        "spacing": ([case.spacing for case in cases], "mean spacing over a0"),
        "nearest": ([one.nearest for one in compared], "least distance over a0"),
        "tabor": ([case.tabor for case in cases], "Tabor number of the mean radius"),
        "points": ([case.points for case in cases], "grid points a side"),
        "cells": ([case.reach * case.points / case.size for case in cases], "range over the spacing of the grid"),
        "seed": ([case.seed for case in cases], "seed"),
    }
    return xr.Dataset(
        {
            **variables,
            "separation": (("case", "step"), padded([one.above for one in compared]),
                           named("separation from the highest asperity over a0^2/R")),
            "seconds": (("case", "source"), seconds, named("run time of a path", "s")),
        },
        {
            "source": list(SOURCES),
            **{name: ("case", values, named(words)) for name, (values, words) in columns.items()},
        },
    )  # fmt: skip

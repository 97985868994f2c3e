"""100 000 random asperities with JKR adhesion and without, up to where they detach or jump: errors and their bounds."""

from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

import numpy as np
import xarray as xr

from roughmdr.shapes import SHAPES
from studies.asperity_error.judge import random_error
from studies.study import Study, named, table

COUNT, QUICK = 100_000, 480
_WORKERS, _GROUP_SIZE = 2, 100
_WEIGHT = {"tabulated": 0.2}  # of a shape, else 1: its reference is slow
_MODELS = ("none", "JKR")
COLUMNS = {
    "shape": {"long_name": "shape of the asperity"},
    "adhesive": named("with JKR adhesion"),
    "seed": named("number of the asperity"),
    "true_error": named("true error of the force"),
    "stated_error": named("bound on it"),
    "distance": named("distance to the end of the branch"),
}


Group = tuple[str, bool, range]
"""Some asperities: shape, whether with adhesion, and their numbers."""


def groups(count: int) -> list[Group]:
    """Return about ``count`` asperities."""
    weights = {kind: _WEIGHT.get(kind, 1.0) for kind in SHAPES}
    found = []
    for kind, weight in weights.items():
        size = round(0.5 * count * weight / sum(weights.values()) + 0.5)
        seeds = [range(start, min(start + _GROUP_SIZE, size)) for start in range(0, size, _GROUP_SIZE)]
        found += [(kind, adhesive, each) for adhesive in (False, True) for each in seeds]
    return found


def rows_of(group: Group) -> list[tuple[str, int, int, float, float, float]]:
    """Return a row of ``COLUMNS`` for each asperity of a group."""
    kind, adhesive, seeds = group
    rows = []
    for seed in seeds:
        one = random_error(kind, adhesive, seed)
        relative = abs(one.error / one.force), abs(one.stated / one.force)
        rows.append((kind, int(adhesive), seed, *relative, one.distance))
    return rows


def measure(quick: bool) -> xr.Dataset:
    """Return the errors of all asperities, from two processes."""
    with ProcessPoolExecutor(_WORKERS, get_context("spawn")) as pool:
        rows = [row for part in pool.map(rows_of, groups(QUICK if quick else COUNT)) for row in part]
    columns = zip(COLUMNS.items(), zip(*rows, strict=True), strict=True)
    return xr.Dataset({name: ("asperity", np.array(values), attributes) for (name, attributes), values in columns})


def report(result: xr.Dataset) -> str:
    """Return how many are within the bound, and how near the worst of each shape comes to it."""
    excess, stated = (result.true_error / result.stated_error).to_numpy(), result.stated_error.to_numpy()
    rows = []
    for kind in SHAPES:
        for adhesive, model in enumerate(_MODELS):
            chosen = np.flatnonzero((result["shape"] == kind) & (result.adhesive == adhesive))
            worst = chosen[np.argmax(excess[chosen])]
            cells = [f"{excess[worst]:.2g}", f"{float(result.distance[worst]):.1g}", f"{int(result.seed[worst])}"]
            quantiles = [f"{value:.1g}" for value in np.quantile(stated[chosen], [0.5, 0.99])]
            rows.append([kind, model, f"{chosen.size}", *cells, *quantiles])
    head = ["shape", "adhesion", "asperities", "true/stated: largest", "at", "number", "stated: median", "99 %"]
    return f"Outside the bound: {int((excess > 1.0).sum())} of {excess.size} asperities.\n\n{table(head, rows)}"


TITLE = "Single asperities up to their folds: is the bound on the error a bound?"
STUDY = Study("asperity_error", TITLE, measure, {}, report, f"{QUICK} of {COUNT} asperities")

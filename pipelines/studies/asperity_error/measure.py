"""100 000 random asperities with JKR adhesion and without, up to where they detach or jump: errors and their bounds."""

from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import xarray as xr

from roughmdr.shapes import SHAPES
from studies.asperity_error.judge import ForceError, random_error
from studies.study import named, table

if TYPE_CHECKING:
    from matplotlib.figure import Figure

COUNT, QUICK = 100_000, 480
_WORKERS, _GROUP_SIZE = 2, 100
_WEIGHT = {"tabulated": 0.2}  # of a shape, else 1: its reference is slow
_MODELS = ("none", "JKR")


class Group(NamedTuple):
    """Some asperities of one shape, with or without adhesion."""

    kind: str
    adhesive: bool
    seeds: range


def groups(count: int) -> list[Group]:
    """Return about ``count`` asperities."""
    weights = {kind: _WEIGHT.get(kind, 1.0) for kind in SHAPES}
    found = []
    for kind, weight in weights.items():
        size = round(0.5 * count * weight / sum(weights.values()) + 0.5)
        starts = range(0, size, _GROUP_SIZE)
        found += [Group(kind, adhesive, range(start, min(start + _GROUP_SIZE, size)))
                  for adhesive in (False, True) for start in starts]  # fmt: skip
    return found


def errors(group: Group) -> list[ForceError]:
    """Return the errors of a group."""
    return [random_error(group.kind, group.adhesive, seed)[1] for seed in group.seeds]


def measure(quick: bool) -> xr.Dataset:
    """Return the errors of all asperities, from two processes."""
    asked = groups(QUICK if quick else COUNT)
    with ProcessPoolExecutor(_WORKERS, get_context("spawn")) as pool:
        found = list(pool.map(errors, asked))
    rows = [(group.kind, group.adhesive, seed, abs(one.error / one.force), abs(one.stated / one.force), one.distance)
            for group, some in zip(asked, found, strict=True)
            for seed, one in zip(group.seeds, some, strict=True)]  # fmt: skip
    kind, adhesive, seed, true, stated, distance = (
        ("asperity", np.array(column)) for column in zip(*rows, strict=True)
    )
    return xr.Dataset(
        {
            "true_error": (*true, named("true error of the force")),
            "stated_error": (*stated, named("bound on it")),
            "distance": (*distance, named("distance to the end of the branch")),
        },
        {
            "shape": kind,
            "adhesive": ("asperity", adhesive[1].astype(np.int8), named("with JKR adhesion")),
            "seed": (*seed, named("number of the asperity")),
        },
    )


def report(result: xr.Dataset) -> str:
    """Return how many are within the bound, and how near the worst of each shape comes to it."""
    excess = (result.true_error / result.stated_error).to_numpy()
    rows = []
    for kind in SHAPES:
        for adhesive, model in enumerate(_MODELS):
            chosen = np.flatnonzero((result["shape"] == kind) & (result.adhesive == adhesive))
            worst = chosen[np.argmax(excess[chosen])]
            cells = [f"{excess[worst]:.2g}", f"{float(result.distance[worst]):.1g}", f"{int(result.seed[worst])}"]
            stated = np.quantile(result.stated_error.to_numpy()[chosen], [0.5, 0.99])
            rows.append([kind, model, f"{chosen.size}", *cells, *(f"{value:.1g}" for value in stated)])
    head = ["shape", "adhesion", "asperities", "true/stated: largest", "at", "number", "stated: median", "99 %"]
    return f"Outside the bound: {int((excess > 1.0).sum())} of {excess.size} asperities.\n\n{table(head, rows)}"


def draw(result: xr.Dataset) -> "Figure":
    """Draw the true error of each asperity over the stated one."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(6.0, 5.0), layout="constrained")
    axes = figure.add_subplot()
    for adhesive, model in enumerate(_MODELS):
        chosen = result.isel(asperity=np.flatnonzero(result.adhesive == adhesive))
        error = chosen.true_error.clip(min=1e-18)
        axes.plot(chosen.stated_error, error, ".", markersize=2.0, alpha=0.4, label=f"adhesion: {model}")
    ends = [1e-15, 1e-3]
    axes.plot(ends, ends, "k-", linewidth=0.8)
    axes.set(xscale="log", yscale="log", xlabel="stated error of the force", ylabel="true error of the force")
    axes.legend()
    return figure

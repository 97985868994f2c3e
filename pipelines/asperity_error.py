"""The bound on the error of the force against the exact force of single asperities, of all shapes, up to their folds.

    python pipelines/asperity_error.py -o results/studies

100 000 asperities at random, with JKR's adhesion and without, from 1e-12 of the depth on to where they let go or jump.
Writes asperity_error.nc and asperity_error.png.
"""

from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import xarray as xr
from random_asperities import Found, found
from study import Study, named, table

from roughmdr.shapes import SHAPES

if TYPE_CHECKING:
    from matplotlib.figure import Figure

COUNT, QUICK = 100_000, 480
_WORKERS, _CHUNK = 2, 100
_SLOW = {"tabulated": 0.2}  # of the share of other shapes: its reference takes that much longer


class Group(NamedTuple):
    """Some asperities of one shape and one law."""

    kind: str
    adhesive: bool
    seeds: range


def groups(count: int) -> list[Group]:
    """About ``count`` asperities."""
    share = {kind: _SLOW.get(kind, 1.0) for kind in SHAPES}
    made = []
    for kind, part in share.items():
        each = round(0.5 * count * part / sum(share.values()) + 0.5)
        for adhesive in (False, True):
            made += [Group(kind, adhesive, range(begin, min(begin + _CHUNK, each))) for begin in range(0, each, _CHUNK)]
    return made


def judge(group: Group) -> list[Found]:
    """The errors of a group."""
    return [found(group.kind, group.adhesive, seed)[1] for seed in group.seeds]


def measure(quick: bool) -> xr.Dataset:
    """All asperities, on two processes."""
    asked = groups(QUICK if quick else COUNT)
    with ProcessPoolExecutor(_WORKERS, get_context("spawn")) as pool:
        judged = list(pool.map(judge, asked))
    rows = [(group, seed, one) for group, some in zip(asked, judged, strict=True)
            for seed, one in zip(group.seeds, some, strict=True)]  # fmt: skip
    over = "asperity"
    return xr.Dataset(
        {
            "true_error": (over, [abs(one.error / one.force) for _, _, one in rows], named("true error of the force")),
            "stated_error": (over, [abs(one.stated / one.force) for _, _, one in rows], named("bound on it")),
            "distance": (over, [one.distance for _, _, one in rows], named("distance to the end of the branch")),
        },
        {
            "shape": (over, [group.kind for group, _, _ in rows]),
            "adhesive": (over, np.array([group.adhesive for group, _, _ in rows], dtype=np.int8), named("JKR or none")),
            "seed": (over, [seed for _, seed, _ in rows], named("number of the asperity")),
        },
    )


def tell(result: xr.Dataset) -> str:
    """How many are within the bound, and how near the worst of each shape comes to it."""
    excess = (result.true_error / result.stated_error).to_numpy()
    rows = []
    for kind in SHAPES:
        for adhesive, law in ((0, "none"), (1, "JKR")):
            own = np.flatnonzero((result["shape"] == kind) & (result.adhesive == adhesive))
            worst = own[np.argmax(excess[own])]
            cells = [f"{excess[worst]:.2g}", f"{float(result.distance[worst]):.1g}", f"{int(result.seed[worst])}"]
            stated = np.quantile(result.stated_error.to_numpy()[own], [0.5, 0.99])
            rows.append([kind, law, f"{own.size}", *cells, *(f"{value:.1g}" for value in stated)])
    head = ["shape", "adhesion", "asperities", "true/stated: most", "at", "number", "stated: median", "99 %"]
    return f"Outside the bound: {int((excess > 1.0).sum())} of {excess.size} asperities.\n\n{table(head, rows)}"


def draw(result: xr.Dataset) -> "Figure":
    """Each asperity: the true error over the stated one."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(6.0, 5.0), layout="constrained")
    axes = figure.add_subplot()
    for adhesive, law in ((0, "no adhesion"), (1, "JKR")):
        own = result.isel(asperity=np.flatnonzero(result.adhesive == adhesive))
        axes.plot(own.stated_error, own.true_error.clip(min=1e-18), ".", markersize=2.0, alpha=0.4, label=law)
    ends = [1e-15, 1e-3]
    axes.plot(ends, ends, "k-", linewidth=0.8)
    axes.set(xscale="log", yscale="log", xlabel="stated error of the force", ylabel="true error of the force")
    axes.legend()
    return figure


STUDY = Study("asperity_error", "Single asperities up to their folds: is the bound one?", measure, draw, tell)

if __name__ == "__main__":
    STUDY.command()

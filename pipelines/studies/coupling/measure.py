"""Coupled asperities: methods for one ensemble, and the run time over the number of asperities."""

import numpy as np
import xarray as xr
from benchmarks.process import in_new_process

from studies.coupling.costs import COUNTS, Cost, cost
from studies.coupling.methods import compare
from studies.study import named


def measure(quick: bool) -> xr.Dataset:
    """Return the points of all methods, and the cost for each number of asperities in a process of one core."""
    points = compare(quick)
    costs = [Cost(*in_new_process(cost, count, NUMBA_NUM_THREADS="1", OMP_NUM_THREADS="1")) for count in COUNTS[quick]]
    asperities, *numbers = np.array(costs, dtype=float).T
    columns = {
        "seconds_mesh": ("run time of a load, on a mesh", "s"),
        "seconds_dense": ("run time of a load, pairs one by one", "s"),
        "difference": ("relative difference of the forces", "1"),
        "memory": ("largest memory of the process", "B"),
    }
    return xr.Dataset(
        {
            "error": ("point", [point.error for point in points], named("largest relative error of the force")),
            "seconds": ("point", [point.seconds for point in points], named("run time of a load", "s")),
            **{name: ("asperities", values, named(*words))
               for (name, words), values in zip(columns.items(), numbers, strict=True)},
        },
        {
            "method": ("point", [point.method for point in points]),
            "setting": ("point", [point.setting for point in points]),
            "asperities": ("asperities", asperities, named("number of asperities")),
        },
    )  # fmt: skip


def crossover(result: xr.Dataset) -> float:
    """Return the number of asperities from which on a mesh is the faster; infinite where it never is."""
    both = result.dropna("asperities", subset=["seconds_dense"])
    slower = both["asperities"].to_numpy()[(both["seconds_mesh"] > both["seconds_dense"]).to_numpy()]
    larger = both["asperities"].to_numpy()
    beyond = larger[larger > slower.max(initial=0.0)]
    return float(beyond.min()) if beyond.size else float("inf")

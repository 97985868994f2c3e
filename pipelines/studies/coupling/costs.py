"""Run time and memory of a load to second order over the number of asperities, dense and on a mesh."""

import math
import time
from typing import NamedTuple

import numpy as np
import xarray as xr
from benchmarks.process import peak_memory

from studies.coupling.methods import coupled
from studies.versus_bem.ensembles import Case, separations

COUNTS = {False: (100, 200, 300, 500, 1000, 3000, 10_000, 100_000), True: (100, 300, 1000)}
_MOST_DENSE = 3000
_LOADS = np.geomspace(0.01, 0.03, 5)
"""Contact fractions on the way, the last of which counts."""


class Cost(NamedTuple):
    """Run times for one number of asperities."""

    asperities: int
    seconds: float
    """A load, on a mesh."""
    seconds_dense: float
    """NaN where that is not measured."""
    difference: float
    """Of the forces, relative."""
    memory: float
    """The largest of the process so far [B]."""


def ensemble_of(count: int) -> xr.Dataset:
    """Return separated paraboloids with lognormal radii."""
    return Case("random" if count > 20_000 else "hard_core 0.5", "lognormal", count, 0.2, 64, 1).generate()


def cost(count: int) -> Cost:
    """Return the run times of a load on a path of a few."""
    ensemble = ensemble_of(count)
    along = separations(ensemble, _LOADS)
    measured = {}
    for dense in (False, True) if count <= _MOST_DENSE else (False,):
        coupled(ensemble, along[:1], "pairwise", dense)
        started = time.perf_counter()
        force = coupled(ensemble, along, "pairwise", dense)
        measured[dense] = force[-1], (time.perf_counter() - started) / along.size
    force, seconds = measured[False]
    of_dense, seconds_dense = measured.get(True, (math.nan, math.nan))
    return Cost(count, seconds, seconds_dense, abs(force / of_dense - 1.0), peak_memory())

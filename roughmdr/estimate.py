"""What a run will cost, before it runs: time and memory, from a short calibration on a small part of it."""

import os
import subprocess
import sys
import time
import tracemalloc
from typing import NamedTuple

import numpy as np

from roughmdr.aggregate import Route, compute, prepare
from roughmdr.ensemble import RandomAsperities
from roughmdr.plan import Cell, Plan, kinds

_SAMPLE = 10_000  # asperities; beyond, time and memory grow in proportion
_STEPS = 500
_CELLS = 12
_DISK = 3e8  # bytes a second: a slow disk
_NUMBER = 8  # bytes

# What a run loads, in a process of its own: the compiled sum, the workers, the file format.
_START = """
import roughmdr.cli, roughmdr.runner, dask.threaded, dask.callbacks, netCDF4, sys
from roughmdr.aggregate import prepare
for kind in sys.argv[1:]:
    shape, adhesive = kind.split(":")
    prepare(shape, adhesive=adhesive == "True")
try:
    import resource
except ImportError:
    print(0)
else:
    unit = 1 if sys.platform == "darwin" else 1024
    print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * unit)
"""


class Estimate(NamedTuple):
    """What a run costs, in seconds and bytes."""

    seconds: float
    """In all."""
    start_up: float
    """Until the first asperity is made."""
    memory: float
    """At most, in all."""
    resident: float
    """What Python and its packages take; 0 where the system does not tell."""
    file: float
    """The result on disk."""


class _Cost(NamedTuple):
    seconds: float
    memory: float


def estimate(plan: Plan, workers: int) -> Estimate:
    """The cost of a plan, from single runs of a few of its cells and from starting Python once."""
    for shape, adhesive in kinds(plan):
        prepare(shape, adhesive=adhesive)
    start_up, resident = _start_up(plan)
    chosen = np.random.default_rng(0).permutation(len(plan.cells))[:_CELLS]
    costs = [_cost(plan, plan.cells[i]) for i in sorted(chosen.tolist())]
    busy = min(workers, len(plan.tasks), _cores())
    numbers = plan.cells[0].route.separation.size * len(plan.scene.output.variables)
    curves = _NUMBER * numbers * plan.runs
    one = curves / len(plan.scene.output.variables)  # the parts of a variable are put together beside them
    kept = curves if plan.scene.output.keep == "curves" else 4 * _NUMBER * numbers * len(plan.cells)
    return Estimate(
        seconds=start_up + float(np.mean([cost.seconds for cost in costs])) * plan.runs / busy + kept / _DISK,
        start_up=start_up,
        memory=resident + curves + one + min(workers, len(plan.tasks)) * max(cost.memory for cost in costs),
        resident=resident,
        file=kept,
    )


def _cost(plan: Plan, cell: Cell) -> _Cost:
    """Of one run of a cell, by running it; a large ensemble or a long path by a part of it."""
    scene, route, part = cell.scene, cell.route, 1.0
    section = scene.asperities
    if isinstance(section, RandomAsperities) and section.count > _SAMPLE:
        part = section.count / _SAMPLE
        section = section.model_copy(update={"count": _SAMPLE})
    steps = route.separation.size
    if steps > _STEPS:
        some = np.linspace(0, steps - 1, _STEPS).astype(int)
        route = Route.along(route.separation[some], unload=False, adhesive=scene.work > 0.0)

    def run() -> tuple[float, float]:
        started = time.perf_counter()
        ensemble = section.ensemble(scene.seed, 0)
        made = time.perf_counter()
        compute(ensemble, route, modulus=scene.modulus, work=scene.work, variables=plan.scene.output.variables)
        return made - started, time.perf_counter() - made

    tracemalloc.start()
    run()
    memory = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    making, adding = min(run() for _ in range(2))
    return _Cost(part * (making + adding * steps / route.separation.size), part * memory)


def _start_up(plan: Plan) -> tuple[float, float]:
    """Seconds and bytes of a run before it begins."""
    command = [sys.executable, "-c", _START, *(f"{shape}:{adhesive}" for shape, adhesive in kinds(plan))]
    started = time.perf_counter()
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    return time.perf_counter() - started, float(done.stdout)


def _cores() -> int:
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1

"""Time and memory of a run before it runs, from a short calibration on a small part of it."""

import math
import os
import time
import tracemalloc
from typing import NamedTuple

import numpy as np

from roughmdr.aggregate import LoadingPath
from roughmdr.batch.costs import START_UP, file_bytes, result_bytes
from roughmdr.batch.plan import Cell, Plan
from roughmdr.batch.realization import simulate_ensemble, simulate_realization
from roughmdr.batch.rounds import Rounds
from roughmdr.batch.tasks import BLOCK_SIZE, prepare_all, split_into_tasks
from roughmdr.errors import RoughmdrError
from roughmdr.storage.memory import available_memory, peak_memory

_MAX_ASPERITIES = 10_000  # beyond, time and memory grow in proportion
_MAX_STEPS = 500
_MAX_CELLS = 12
_REPEATS = 3
_DISK = 3e8  # bytes a second: a slow disk
_NUMBER = 8  # bytes
_STEP_SECONDS = 3e-6  # of a step of the path itself


class Estimate(NamedTuple):
    """Cost of a run in seconds and bytes; with [accuracy], of its first round."""

    runs: int
    tasks: int
    seconds: float  # in all
    start_up: float  # until the first asperity is made
    memory: float  # peak, in all
    resident: float  # of Python and its packages; 0 where the system does not tell
    available_memory: float  # how much more this process could be given; inf where the system does not tell
    file: float  # size of the result on disk
    failures: tuple[str, ...]  # which of the cells that were tried cannot be computed, and why


def estimate(plan: Plan, workers: int) -> Estimate:
    """Return the cost of a plan, from single runs of a few of its cells; RoughmdrError where none can be run."""
    rounds = Rounds(plan)
    first = rounds.begin()
    prepare_all(plan, first)
    resident = peak_memory()
    cells = np.random.default_rng(0).permutation(len(plan.cells))[:_MAX_CELLS]
    variables = plan.scene.output.variables
    costs, failures = [], []
    for cell in sorted(cells.tolist()):
        try:
            costs.append(_cost(plan.cells[cell], rounds.methods[cell].estimator, variables))
        except RoughmdrError as error:
            failures.append(f"{plan.name_of(cell, 0)}: {error}")
    if not costs:
        raise RoughmdrError(failures[0])
    run_seconds, run_bytes = zip(*costs, strict=True)
    runs = sum(each.last - each.first for each in first)
    tasks = len(split_into_tasks(plan, first, variables, workers))
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    busy = min(workers, tasks, cores)
    memory, file = result_bytes(plan, runs), file_bytes(plan, runs)
    if plan.keeps_statistics:
        memory += busy * min(BLOCK_SIZE, math.ceil(runs / tasks)) * _NUMBER * plan.steps * len(variables)
    computing = float(np.mean(run_seconds)) * runs / busy
    return Estimate(
        runs=runs,
        tasks=tasks,
        seconds=START_UP + computing + file / _DISK + _STEP_SECONDS * plan.steps,
        start_up=START_UP,
        memory=resident + memory + busy * max(run_bytes),
        resident=resident,
        available_memory=available_memory()[0],
        file=file,
        failures=tuple(failures),
    )


def _cost(cell: Cell, estimator: str, variables: list[str]) -> tuple[float, float]:
    """Measure time [s] and memory [byte] of one run of a cell; of a large ensemble or a long path a part."""
    scene, path = cell.scene, cell.path
    section = scene.asperities.limited_to(_MAX_ASPERITIES)
    if cell.steps > _MAX_STEPS:
        some = np.linspace(0, cell.steps - 1, _MAX_STEPS).astype(int)
        path = LoadingPath.along(path.separation[some], unload=False, adhesive=scene.work > 0.0)

    def run() -> tuple[float, float]:
        started = time.perf_counter()
        if estimator == "expected":
            simulate_realization(scene, path, 0, variables, "expected")
            return 0.0, time.perf_counter() - started
        ensemble = section.ensemble(scene.seed, 0, stratified=estimator == "stratified")
        drawn = time.perf_counter()
        simulate_ensemble(scene, path, ensemble, variables)
        return drawn - started, time.perf_counter() - drawn

    tracemalloc.start()
    run()
    memory = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    drawing, summing = np.mean([run() for _ in range(_REPEATS)], axis=0).tolist()
    ratio = scene.asperities.expected_count / section.expected_count if estimator != "expected" else 1.0
    return ratio * (drawing + summing * cell.steps / path.separation.size), ratio * memory

"""What a run will cost, before it runs: time and memory, from a short calibration on a small part of it."""

import math
import os
import subprocess
import sys
import tempfile
import time
import tracemalloc
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple

import numpy as np
import tomli_w

from roughmdr.aggregate import LoadingPath, compute
from roughmdr.batch.compile import prepare_all
from roughmdr.batch.plan import Cell, Plan, simulate_realization
from roughmdr.batch.rounds import Rounds
from roughmdr.batch.sizes import file_bytes, held_bytes
from roughmdr.batch.tasks import BLOCK_SIZE, split_into_tasks
from roughmdr.errors import RoughmdrError
from roughmdr.shapes import SHAPES
from roughmdr.storage.memory import available_memory

_SAMPLE = 10_000  # asperities; beyond, time and memory grow in proportion
_STEPS = 500
_CELLS = 12
_REPEATS = 3
_DISK = 3e8  # bytes a second: a slow disk
_NUMBER = 8  # bytes
_STEP_SECONDS = 3e-6  # of a step of the path itself


class Estimate(NamedTuple):
    """What a run costs, in seconds and bytes; with [accuracy], what its first round does."""

    runs: int
    tasks: int
    seconds: float
    """In all."""
    start_up: float
    """Until the first asperity is made."""
    memory: float
    """At most, in all."""
    resident: float
    """What Python and its packages take; 0 where the system does not tell."""
    room: float
    """How much more this process could be given; inf where the system does not tell."""
    file: float
    """The result on disk."""
    failures: tuple[str, ...]
    """Which of the cells that were tried cannot be computed, and why."""


class _Cost(NamedTuple):
    seconds: float
    memory: float


def estimate(plan: Plan, workers: int) -> Estimate:
    """The cost of a plan, from single runs of a few of its cells and from a run of next to nothing."""
    rounds = Rounds(plan)
    first = rounds.begin()
    prepare_all(plan, first)
    try:
        start_up, resident = _start_up(plan.cells[0]), _resident()
    except OSError as error:  # of the folder for temporary files
        raise RoughmdrError(f"a run of next to nothing cannot be timed here: {error.strerror}") from None
    chosen = np.random.default_rng(0).permutation(len(plan.cells))[:_CELLS]
    costs, failures = _costs(plan, rounds, sorted(chosen.tolist()))
    variables, steps = plan.scene.output.variables, plan.cells[0].path.separation.size
    runs = sum(stretch.last - stretch.first for stretch in first)
    tasks = len(split_into_tasks(plan, first, variables, workers))
    busy = min(workers, tasks, _cores())
    held, file = held_bytes(plan, runs), file_bytes(plan, runs)
    if plan.scene.output.keep == "statistics":
        held += busy * min(BLOCK_SIZE, math.ceil(runs / tasks)) * _NUMBER * steps * len(variables)
    return Estimate(
        runs=runs,
        tasks=tasks,
        seconds=start_up
        + float(np.mean([cost.seconds for cost in costs])) * runs / busy
        + file / _DISK
        + _STEP_SECONDS * steps,
        start_up=start_up,
        memory=resident + held + busy * max(cost.memory for cost in costs),
        resident=resident,
        room=available_memory()[0],
        file=file,
        failures=tuple(failures),
    )


def _costs(plan: Plan, rounds: Rounds, cells: list[int]) -> tuple[list[_Cost], list[str]]:
    """The costs of those cells that can be run, and why the others cannot; RoughmdrError where none can."""
    costs, failures = [], []
    for cell in cells:
        try:
            costs.append(_cost(plan, plan.cells[cell], rounds.choices[cell].estimator))
        except RoughmdrError as error:
            failures.append(f"{plan.name_of(cell, 0)}: {error}")
    if not costs:
        raise RoughmdrError(failures[0])
    return costs, failures


def _cost(plan: Plan, cell: Cell, estimator: str) -> _Cost:
    """Of one run of a cell, by running it; a large ensemble or a long path by a part of it."""
    scene, path = cell.scene, cell.path
    section = scene.asperities.limited_to(_SAMPLE)
    steps = path.separation.size
    if steps > _STEPS:
        some = np.linspace(0, steps - 1, _STEPS).astype(int)
        path = LoadingPath.along(path.separation[some], unload=False, adhesive=scene.work > 0.0)

    def run() -> tuple[float, float]:
        started = time.perf_counter()
        if estimator == "expected":
            simulate_realization(scene, path, 0, plan.scene.output.variables, "expected")
            return 0.0, time.perf_counter() - started
        ensemble = section.ensemble(scene.seed, 0, stratified=estimator == "stratified")
        made = time.perf_counter()
        compute(
            ensemble,
            path,
            effective_modulus=scene.effective_modulus,
            adhesion=scene.adhesion_model,
            variables=plan.scene.output.variables,
        )
        return made - started, time.perf_counter() - made

    tracemalloc.start()
    run()
    memory = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    making, adding = np.mean([run() for _ in range(_REPEATS)], axis=0).tolist()
    part = scene.asperities.expected_count / section.expected_count if estimator != "expected" else 1.0
    return _Cost(part * (making + adding * steps / path.separation.size), part * memory)


def _start_up(cell: Cell) -> float:
    """Seconds of a run that is as little as a run of the cell's kind can be: all of it is to start."""
    shape = SHAPES[cell.scene.asperities.shape_name]
    asperities = {"source": "random", "shape": shape.name, "count": 1, "patch": 1.0, "height": 0.0}
    smallest = {
        "material": {"effective_modulus": 1.0},
        "adhesion": {
            "model": cell.scene.adhesion_model.model,
            "work": cell.scene.work and 1.0,
            **({"strength": 1.0} if cell.scene.adhesion_model.strength < math.inf else {}),
        },
        "asperities": {**asperities, **shape.example()},
        "path": {"separation": [0.0]},
    }
    with tempfile.TemporaryDirectory() as folder:
        scene = Path(folder) / "scene.toml"
        scene.write_text(tomli_w.dumps(smallest))
        command = [sys.executable, "-P", "-m", "roughmdr", "run", str(scene), "-o", str(scene.with_suffix(".nc"))]
        started = time.perf_counter()
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode:
            raise RoughmdrError(f"a run of next to nothing does not work here: {done.stderr.strip()}")
    return time.perf_counter() - started


def _resident() -> float:
    """Bytes of this process at most so far; it has loaded nearly all that a run loads."""
    # Where it is there, since getrusage counts what the process was forked from too.
    with suppress(OSError, StopIteration), open("/proc/self/status") as status:
        return next(1024.0 * int(line.split()[1]) for line in status if line.startswith("VmHWM"))
    with suppress(ImportError):
        import resource

        return float(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)  # bytes, where there is no /proc
    return 0.0


def _cores() -> int:
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1

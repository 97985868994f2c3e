"""Time and memory of a run before it runs, by the constants of ``costs``."""

import math
import os
from typing import NamedTuple

from roughmdr.batch.costs import START_UP, beside, ensemble_bytes, file_bytes, result_bytes, seconds
from roughmdr.batch.plan import Plan
from roughmdr.batch.rounds import Rounds
from roughmdr.batch.tasks import RunRange, prepare_all, split_into_tasks
from roughmdr.storage.memory import available_memory, peak_memory

_DISK = 3e8  # bytes a second: a slow disk
_STEP_SECONDS = 3e-6  # seconds of a step of the path itself
_WORTH = 10.0  # seconds of runs from which processes are worth their start
_PROCESSES = 3.0  # seconds that processes take to start: 2 to 4


class Estimate(NamedTuple):
    """Cost of a run in seconds and bytes; with [accuracy], of its first round."""

    runs: int
    tasks: int
    seconds: float  # in all
    longest: float  # in all, should what is beside the law need the finest grids; as ``seconds`` where there are none
    finest: float  # bytes of these grids at a time; 0 where there are none
    start_up: float  # until the first asperity is made
    memory: float  # peak, in all
    resident: float  # memory of Python and its packages, in all processes; 0 where the system does not tell
    available_memory: float  # how much more this process could be given; inf where the system does not tell
    file: float  # size of the result on disk


def holds_lock(plan: Plan) -> bool:
    """Return whether runs hold Python's lock, so that threads wait for each other longer than they compute: in pairs,
    but for what is solved on a grid.
    """
    scene = plan.scene
    grids = any(stage.on_grid for stage in scene.stages) or getattr(scene.interaction, "beyond", "flag") != "flag"
    return not grids and any(cell.scene.needs_positions for cell in plan.cells)


def suits_processes(plan: Plan, workers: int) -> bool:
    """Return whether processes compute a plan sooner than threads: several runs that hold Python's lock, and take
    longer than processes take to start.
    """
    if workers == 1 or not holds_lock(plan):
        return False
    first = Rounds(plan).begin()
    return sum(each.last - each.first for each in first) > 1 and _computing(first) > _WORTH


def _computing(runs: list[RunRange]) -> float:
    """Return the seconds of all runs, one after the other."""
    return math.fsum((each.last - each.first) * seconds(each.cell, each.estimator) for each in runs)


def estimate(plan: Plan, workers: int) -> Estimate:
    """Return the cost of a plan by ``roughmdr run``, beyond what the compiler takes; what the runs need is compiled
    here already.
    """
    processes = suits_processes(plan, workers)
    workers = 1 if holds_lock(plan) and not processes else workers
    first = Rounds(plan).begin()
    prepare_all(plan, first)
    resident = peak_memory()
    runs = sum(each.last - each.first for each in first)
    tasks = len(split_into_tasks(plan, first, plan.scene.output.variables, workers))
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    busy = min(workers, tasks, cores)
    resident *= 1 + busy * processes
    file = file_bytes(plan, runs)
    whole = START_UP + _PROCESSES * processes + _computing(first) / busy + file / _DISK + _STEP_SECONDS * plan.steps
    finer = sum((each.last - each.first) * (beside(each.cell, finest=True)[0] - beside(each.cell)[0]) for each in first)
    at_a_time = ensemble_bytes(plan) + max(beside(cell)[1] for cell in plan.cells)
    return Estimate(
        runs=runs,
        tasks=tasks,
        seconds=whole,
        longest=whole + finer / busy,
        finest=busy * max(beside(cell, finest=True)[1] for cell in plan.cells),
        start_up=START_UP,
        memory=resident + result_bytes(plan, runs) + busy * at_a_time,
        resident=resident,
        available_memory=available_memory()[0],
        file=file,
    )

"""Time and memory of a run before it runs, from a short calibration on a small part of it."""

import os
import time
from typing import NamedTuple

import numpy as np

from roughmdr.batch.calibrate import Cost, measure
from roughmdr.batch.costs import START_UP, beside, file_bytes, result_bytes, seconds
from roughmdr.batch.plan import Plan
from roughmdr.batch.rounds import Rounds
from roughmdr.batch.tasks import prepare_all, split_into_tasks
from roughmdr.errors import RoughmdrError
from roughmdr.storage.memory import available_memory, peak_memory

BUDGET = 1.0
"""Seconds that a calibration may take."""
_MAX_CELLS = 12
_DISK = 3e8  # bytes a second: a slow disk
_STEP_SECONDS = 3e-6  # seconds of a step of the path itself


class Estimate(NamedTuple):
    """Cost of a run in seconds and bytes; with [accuracy], of its first round."""

    runs: int
    tasks: int
    seconds: float  # in all
    longest: float  # in all, should what is beside the law need the finest grids; as ``seconds`` where there are none
    finest: float  # bytes of these grids at a time; 0 where there are none
    start_up: float  # until the first asperity is made
    memory: float  # peak, in all
    resident: float  # of Python and its packages; 0 where the system does not tell
    available_memory: float  # how much more this process could be given; inf where the system does not tell
    file: float  # size of the result on disk
    failures: tuple[str, ...]  # which of the cells that were tried cannot be computed, and why
    asperity_steps: int  # number of asperities times steps in the largest parts that were run


def estimate(plan: Plan, workers: int, budget: float = BUDGET) -> Estimate:
    """Return the cost of a plan, from parts of single runs of some of its cells, in about ``budget`` seconds.

    That is beyond what the compiler takes. RoughmdrError where none of these cells can be run.
    """
    rounds = Rounds(plan)
    first = rounds.begin()
    prepare_all(plan, first)
    resident = peak_memory()
    variables = plan.scene.output.variables
    costs, failures = _measured(plan, rounds, variables, budget)
    if not costs:
        raise RoughmdrError(failures[0])
    foreseen = [seconds(plan.cells[cell], rounds.methods[cell].estimator) for cell in costs]
    correction = sum(cost.seconds for cost in costs.values()) / sum(foreseen)
    foreseen_total = sum((runs.last - runs.first) * seconds(runs.cell, runs.estimator) for runs in first)
    runs = sum(each.last - each.first for each in first)
    tasks = len(split_into_tasks(plan, first, variables, workers))
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    busy = min(workers, tasks, cores)
    memory, file = result_bytes(plan, runs), file_bytes(plan, runs)
    computing = correction * foreseen_total / busy
    whole = START_UP + computing + file / _DISK + _STEP_SECONDS * plan.steps
    finer = sum(
        (each.last - each.first) * (beside(each.cell, finest=True).seconds - beside(each.cell).seconds)
        for each in first
    )
    return Estimate(
        runs=runs,
        tasks=tasks,
        seconds=whole,
        longest=whole + finer / busy,
        finest=busy * max(beside(cell, finest=True).memory for cell in plan.cells),
        start_up=START_UP,
        memory=resident + memory + busy * max(cost.memory for cost in costs.values()),
        resident=resident,
        available_memory=available_memory()[0],
        file=file,
        failures=tuple(failures),
        asperity_steps=sum(cost.asperities * cost.steps for cost in costs.values()),
    )


def _measured(plan: Plan, rounds: Rounds, variables: list[str], budget: float) -> tuple[dict[int, Cost], list[str]]:
    """Return the costs of some cells by their number, as many as there is time for, and why others cannot be run."""
    started = time.perf_counter()
    cells = np.random.default_rng(0).permutation(len(plan.cells))[:_MAX_CELLS].tolist()
    costs, failures = dict[int, Cost](), list[str]()
    for number, cell in enumerate(cells):
        left = budget - (time.perf_counter() - started)
        if costs and left <= 0.0:
            break
        try:
            estimator = rounds.methods[cell].estimator
            costs[cell] = measure(plan.cells[cell], estimator, variables, left / (len(cells) - number))
        except RoughmdrError as error:
            failures.append(f"{plan.name_of(cell, 0)}: {error}")
    return costs, failures

"""Tasks: which runs go together, and what a worker does with them."""

import math
import time
from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from roughmdr.batch.costs import seconds
from roughmdr.batch.moments import Moments, MomentTree
from roughmdr.batch.plan import Cell, Plan, simulate_realization
from roughmdr.batch.resume.keys import check_versions
from roughmdr.batch.task_result import RunDiagnostics, TaskResult, table_of
from roughmdr.errors import RoughmdrError
from roughmdr.numerics.arguments import Floats
from roughmdr.variables import ADHESION_CODES, FAILED

_AT_ONCE = 0.1  # a batch that takes less [s] is one task: to load dask takes as long
_LEAST, _USUAL, _MOST = 0.05, 0.1, 3.0  # what a task takes [s]
_MANY = 4000  # of so many tasks each may take longer
_EACH = 8  # tasks a worker at least, so that all finish together
_BYTES = 2**24  # of curves in a task, if it has more than one
BLOCK_SIZE = 256
"""Curves in memory at a time, where tallies are kept."""


class RunRange(NamedTuple):
    """Realisations first ... last - 1 of a cell."""

    cell: int
    first: int
    last: int
    estimator: str


class TaskPart(NamedTuple):
    """A stretch of a task, with all that it takes to compute it."""

    key: str
    cell: Cell
    first: int
    last: int
    estimator: str


class Task(NamedTuple):
    """What a worker computes in one go."""

    parts: tuple[TaskPart, ...]
    variables: tuple[str, ...]
    tallied: bool
    """Whether tallies are wanted, not curves."""
    versions: str


def split_into_tasks(
    plan: Plan, stretches: Sequence[RunRange], variables: Sequence[str], workers: int
) -> list[list[RunRange]]:
    """Stretches, in their order, cut so that each group takes about as long as a task should."""
    each = [seconds(plan.cells[stretch.cell], stretch.estimator) for stretch in stretches]
    in_all = sum(own * (last - first) for own, (_, first, last, _) in zip(each, stretches, strict=True))
    if plan.chunk is None and in_all <= _AT_ONCE:
        return [list(stretches)] if stretches else []
    enough = max(_LEAST, min(in_all / (_EACH * workers), max(_USUAL, min(in_all / _MANY, _MOST))))
    tallied = plan.scene.output.keep == "statistics"
    size = 8 * len(variables) * plan.cells[0].path.separation.size
    most = 2**62 if tallied else max(1, _BYTES // size)
    tasks: list[list[RunRange]] = []
    group: list[RunRange] = []
    filled, runs = 0.0, 0
    for own, (cell, begin, last, estimator) in zip(each, stretches, strict=True):
        first = begin
        while first < last:
            fitting = math.ceil((enough - filled) / own) if plan.chunk is None else plan.chunk - runs
            taken = min(max(fitting, 1), most - runs, last - first)
            group.append(RunRange(cell, first, first + taken, estimator))
            first, filled, runs = first + taken, filled + taken * own, runs + taken
            if runs >= most or (filled >= enough if plan.chunk is None else runs >= plan.chunk):
                tasks.append(group)
                group, filled, runs = [], 0.0, 0
    return [*tasks, group] if group else tasks


def compute(task: Task) -> TaskResult:
    """The results of a task; a run that cannot be computed is marked, and says why."""
    check_versions(task.versions)
    keys = [part.key for part in task.parts]
    steps = task.parts[0].cell.path.separation.size
    rows: list[tuple[int, int, Moments, RunDiagnostics]] = []
    for number, part in enumerate(task.parts):
        found = _tallied(part, task.variables) if task.tallied else _curves(part, task.variables)
        rows += [(number, first, tally, row) for first, tally, row in found]
    return table_of(keys, task.variables, rows, steps)


def _curves(part: TaskPart, names: Sequence[str]) -> Iterator[tuple[int, Moments, RunDiagnostics]]:
    for realization in range(part.first, part.last):
        values, row = _run(part, realization, names)
        yield realization, Moments.of(values), row


def _tallied(part: TaskPart, names: Sequence[str]) -> Iterator[tuple[int, Moments, RunDiagnostics]]:
    """What the realisations come to; those that fail stand for themselves."""
    tallies, rows = MomentTree(), dict[int, RunDiagnostics]()
    for first in range(part.first, part.last, BLOCK_SIZE):
        begin, kept = first, list[Floats]()
        for realization in range(first, min(first + BLOCK_SIZE, part.last)):
            values, row = _run(part, realization, names)
            if row.status == FAILED:
                yield realization, Moments.of(values), row
                tallies.add_all(begin, np.array(kept).reshape(-1, *values.shape))
                begin, kept = realization + 1, []
            else:
                kept.append(values)
                rows[realization] = row
        if kept:
            tallies.add_all(begin, np.array(kept))
    for first, tally in tallies.held.items():
        whole = rows[first]
        for realization in range(first + 1, first + tally.size):
            whole = whole.joined(rows[realization])
        yield first, tally, whole


def _run(part: TaskPart, realization: int, names: Sequence[str]) -> tuple[Floats, RunDiagnostics]:
    """The variables [variable, step] of one realisation, and what else there is to say."""
    (scene, path), started = part.cell, time.perf_counter()
    try:
        found = simulate_realization(scene, path, realization, list(names), part.estimator)
    except Exception as error:  # whatever it is, the other runs go on
        what = f"{type(error).__name__}: {error}" if str(error) else type(error).__name__
        values = np.full((len(names), path.separation.size), math.nan)
        return values, RunDiagnostics(time.perf_counter() - started, status=FAILED, remark=what)
    law = ADHESION_CODES.index(found.model if scene.work > 0.0 else "none")
    values = np.array([found.variables[name] for name in names])
    slope, extent, _ = found.extremes
    row = RunDiagnostics(0.0, found.numerical_error, found.tabor, law, slope, extent, remark="\n".join(found.doubts))
    return values, row._replace(run_time=time.perf_counter() - started)


def failed(task: Task, remark: str) -> TaskResult:
    """The shard of a task that could not be computed at all."""
    steps = task.parts[0].cell.path.separation.size
    nothing = Moments.of(np.full((len(task.variables), steps), math.nan))
    row = RunDiagnostics(0.0, math.nan, status=FAILED, remark=remark)
    rows = [
        (number, realization, nothing, row)
        for number, part in enumerate(task.parts)
        for realization in range(part.first, part.last)
    ]
    return table_of([part.key for part in task.parts], task.variables, rows, steps)


def first_error(remark: str) -> Exception:
    """The error that a failed run tells of, to be raised again."""
    import roughmdr.errors

    name, _, message = remark.partition(": ")
    kind = getattr(roughmdr.errors, name, None)
    if isinstance(kind, type) and issubclass(kind, RoughmdrError):
        return kind(message)
    return RuntimeError(remark)

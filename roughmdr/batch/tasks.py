"""Tasks: which runs go together, and what a worker does with them."""

import math
import time
from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from roughmdr.aggregate import LoadSeparation
from roughmdr.batch.costs import seconds
from roughmdr.batch.diagnostics import Row, merge_rows, row_of
from roughmdr.batch.moments import Moments, MomentTree
from roughmdr.batch.plan import Cell, Plan, simulate_realization
from roughmdr.batch.resume.keys import check_versions
from roughmdr.batch.task_result import TaskResult
from roughmdr.errors import RoughmdrError
from roughmdr.numerics.arguments import Floats
from roughmdr.scene import Scene
from roughmdr.variables import ADHESION_CODES, DONE, FAILED

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
    """Compute a task; a run that cannot be computed is marked as failed, and its remark says why."""
    check_versions(task.versions)
    steps = task.parts[0].cell.path.separation.size
    rows: list[tuple[int, int, Moments, Row]] = []
    for number, part in enumerate(task.parts):
        results = _moments(part, task.variables) if task.tallied else _curves(part, task.variables)
        rows += [(number, *result) for result in results]
    return TaskResult.of([part.key for part in task.parts], task.variables, rows, steps)


def _curves(part: TaskPart, names: Sequence[str]) -> Iterator[tuple[int, Moments, Row]]:
    for realization in range(part.first, part.last):
        values, diagnostics = _run(part, realization, names)
        yield realization, Moments.of(values), diagnostics


def _moments(part: TaskPart, names: Sequence[str]) -> Iterator[tuple[int, Moments, Row]]:
    """Yield blocks of merged realisations: the first, moments and diagnostics; realisations that fail stand alone."""
    tree, rows = MomentTree(), dict[int, Row]()
    for first in range(part.first, part.last, BLOCK_SIZE):
        begin, curves = first, list[Floats]()
        for realization in range(first, min(first + BLOCK_SIZE, part.last)):
            values, rows[realization] = _run(part, realization, names)
            if rows[realization]["status"] == FAILED:
                yield realization, Moments.of(values), rows[realization]
                tree.add_all(begin, np.array(curves).reshape(-1, *values.shape))
                begin, curves = realization + 1, []
            else:
                curves.append(values)
        if curves:
            tree.add_all(begin, np.array(curves))
    for first, moments in tree.blocks.items():
        yield first, moments, merge_rows([rows[realization] for realization in range(first, first + moments.size)])


def _run(part: TaskPart, realization: int, names: Sequence[str]) -> tuple[Floats, Row]:
    """Return the variables [variable, step] and the diagnostics of one realisation."""
    (scene, path), started = part.cell, time.perf_counter()
    try:
        result = simulate_realization(scene, path, realization, list(names), part.estimator)
    except Exception as error:  # whatever it is, the other runs go on
        values = np.full((len(names), path.separation.size), math.nan)
        remark = f"{type(error).__name__}: {error}" if str(error) else type(error).__name__
        return values, row_of(run_time=time.perf_counter() - started, status=FAILED, remark=remark)
    values = np.array([result.variables[name] for name in names])
    known = diagnostics_of(result, scene)
    return values, row_of(run_time=time.perf_counter() - started, status=DONE, **known)


def diagnostics_of(result: LoadSeparation, scene: Scene) -> dict[str, object]:
    """Return the diagnostics of a realisation that its result tells, by their names in ``RUN_DIAGNOSTICS``."""
    return {
        "numerical_error": result.numerical_error,
        "edge_slope": result.extremes.slope,
        "profile_extent": result.extremes.extent,
        "tabor_number": result.tabor if result.tabor < math.inf else math.nan,
        "adhesion_law": ADHESION_CODES.index(result.model if scene.work > 0.0 else "none"),
        "remark": "\n".join(result.doubts),
    }


def failed(task: Task, remark: str) -> TaskResult:
    """Return the result of a task that could not be computed at all."""
    steps = task.parts[0].cell.path.separation.size
    moments = Moments.of(np.full((len(task.variables), steps), math.nan))
    diagnostics = row_of(run_time=0.0, status=FAILED, remark=remark)
    rows = [
        (number, realization, moments, diagnostics)
        for number, part in enumerate(task.parts)
        for realization in range(part.first, part.last)
    ]
    return TaskResult.of([part.key for part in task.parts], task.variables, rows, steps)


def first_error(remark: str) -> Exception:
    """The error that a failed run tells of, to be raised again."""
    import roughmdr.errors

    name, _, message = remark.partition(": ")
    kind = getattr(roughmdr.errors, name, None)
    if isinstance(kind, type) and issubclass(kind, RoughmdrError):
        return kind(message)
    return RuntimeError(remark)

"""Tasks: which runs go together, and what a worker does with them."""

import math
import time
from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from roughmdr.batch.costs import seconds
from roughmdr.batch.moments import Tallies, Tally
from roughmdr.batch.plan import Cell, Plan, law_of
from roughmdr.batch.resume.keys import check_versions
from roughmdr.batch.task_result import Row, Shard, table_of
from roughmdr.errors import RoughmdrError
from roughmdr.numerics.arguments import Floats
from roughmdr.variables import ADHESION_CODES, FAILED

_AT_ONCE = 0.1  # a batch that takes less [s] is one task: to load dask takes as long
_LEAST, _USUAL, _MOST = 0.05, 0.1, 3.0  # what a task takes [s]
_MANY = 4000  # of so many tasks each may take longer
_EACH = 8  # tasks a worker at least, so that all finish together
_BYTES = 2**24  # of curves in a task, if it has more than one
TOGETHER = 256
"""Curves in memory at a time, where tallies are kept."""


class Stretch(NamedTuple):
    """Realisations first ... last - 1 of a cell."""

    cell: int
    first: int
    last: int
    estimator: str


class Part(NamedTuple):
    """A stretch of a task, with all that it takes to compute it."""

    key: str
    cell: Cell
    first: int
    last: int
    estimator: str


class Task(NamedTuple):
    """What a worker computes in one go."""

    parts: tuple[Part, ...]
    variables: tuple[str, ...]
    tallied: bool
    """Whether tallies are wanted, not curves."""
    versions: str


def cut(plan: Plan, stretches: Sequence[Stretch], variables: Sequence[str], workers: int) -> list[list[Stretch]]:
    """Stretches, in their order, cut so that each group takes about as long as a task should."""
    each = [seconds(plan.cells[stretch.cell], stretch.estimator) for stretch in stretches]
    in_all = sum(own * (last - first) for own, (_, first, last, _) in zip(each, stretches, strict=True))
    if plan.chunk is None and in_all <= _AT_ONCE:
        return [list(stretches)] if stretches else []
    enough = max(_LEAST, min(in_all / (_EACH * workers), max(_USUAL, min(in_all / _MANY, _MOST))))
    tallied = plan.scene.output.keep == "statistics"
    size = 8 * len(variables) * plan.cells[0].route.separation.size
    most = 2**62 if tallied else max(1, _BYTES // size)
    tasks: list[list[Stretch]] = []
    group: list[Stretch] = []
    filled, runs = 0.0, 0
    for own, (cell, begin, last, estimator) in zip(each, stretches, strict=True):
        first = begin
        while first < last:
            fitting = math.ceil((enough - filled) / own) if plan.chunk is None else plan.chunk - runs
            taken = min(max(fitting, 1), most - runs, last - first)
            group.append(Stretch(cell, first, first + taken, estimator))
            first, filled, runs = first + taken, filled + taken * own, runs + taken
            if runs >= most or (filled >= enough if plan.chunk is None else runs >= plan.chunk):
                tasks.append(group)
                group, filled, runs = [], 0.0, 0
    return [*tasks, group] if group else tasks


def compute(task: Task) -> Shard:
    """The results of a task; a run that cannot be computed is marked, and says why."""
    check_versions(task.versions)
    keys = [part.key for part in task.parts]
    steps = task.parts[0].cell.route.separation.size
    rows: list[tuple[int, int, Tally, Row]] = []
    for number, part in enumerate(task.parts):
        found = _tallied(part, task.variables) if task.tallied else _curves(part, task.variables)
        rows += [(number, first, tally, row) for first, tally, row in found]
    return table_of(keys, task.variables, rows, steps)


def _curves(part: Part, names: Sequence[str]) -> Iterator[tuple[int, Tally, Row]]:
    for realization in range(part.first, part.last):
        values, row = _run(part, realization, names)
        yield realization, Tally.of(values), row


def _tallied(part: Part, names: Sequence[str]) -> Iterator[tuple[int, Tally, Row]]:
    """What the realisations come to; those that fail stand for themselves."""
    tallies, rows = Tallies(), dict[int, Row]()
    for first in range(part.first, part.last, TOGETHER):
        begin, kept = first, list[Floats]()
        for realization in range(first, min(first + TOGETHER, part.last)):
            values, row = _run(part, realization, names)
            if row.status == FAILED:
                yield realization, Tally.of(values), row
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


def _run(part: Part, realization: int, names: Sequence[str]) -> tuple[Floats, Row]:
    """The variables [variable, step] of one realisation, and what else there is to say."""
    (scene, route), started = part.cell, time.perf_counter()
    try:
        found = law_of(scene, route, realization, list(names), part.estimator)
    except Exception as error:  # whatever it is, the other runs go on
        what = f"{type(error).__name__}: {error}" if str(error) else type(error).__name__
        values = np.full((len(names), route.separation.size), math.nan)
        return values, Row(time.perf_counter() - started, status=FAILED, remark=what)
    law = ADHESION_CODES.index(found.model if scene.work > 0.0 else "none")
    values = np.array([found.variables[name] for name in names])
    slope, extent, _ = found.extremes
    row = Row(0.0, found.numerical_error, found.tabor, law, slope, extent, remark="\n".join(found.doubts))
    return values, row._replace(run_time=time.perf_counter() - started)


def failed(task: Task, remark: str) -> Shard:
    """The shard of a task that could not be computed at all."""
    steps = task.parts[0].cell.route.separation.size
    nothing = Tally.of(np.full((len(task.variables), steps), math.nan))
    row = Row(0.0, math.nan, status=FAILED, remark=remark)
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

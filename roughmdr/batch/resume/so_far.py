"""The mean law over the runs that are kept so far, at a few steps; each stored task result is read once."""

import math
from itertools import islice
from typing import NamedTuple

import numpy as np

from roughmdr.batch.moments import Moments
from roughmdr.batch.resume.kept import Kept, Progress
from roughmdr.batch.resume.manifest import StoredFile
from roughmdr.batch.resume.store import read_task_result
from roughmdr.batch.task_result import TaskResult
from roughmdr.numerics.arguments import Ints

_STEPS = 6  # steps told, of which one is the closest approach, also where unloading follows
_FILES = 2000  # most task results read at one look, which takes seconds; more follow at the next
_AT_ONCE = 2**30  # most bytes of curves read at one look, likewise


class LawSoFar(NamedTuple):
    """The law of a cell at some steps, over the runs that are kept."""

    cell: int
    variable: str
    steps: Ints
    moments: Moments  # [step]
    kept: int  # runs of the cell that are kept, of which some may not be read yet


class SoFar:
    """Moments of the force, or of what else is asked for, by the keys of the cells."""

    def __init__(self, progress: Progress) -> None:
        """Take the steps and the cells of a batch; where it cannot be planned here nothing is read."""
        self.progress, self._read, self._moments = progress, set[StoredFile](), dict[str, Moments]()
        self._runs = set[tuple[str, int]]()
        plan = progress.plan
        if plan is not None:
            self._variable = plan.watched if plan.watched in plan.variables else plan.variables[0]
            self._steps = np.unique([math.ceil(plan.steps * part / _STEPS) - 1 for part in range(1, _STEPS + 1)])

    def law(self, kept: Kept) -> LawSoFar | None:
        """Return the law of the first cell of which runs are kept, None for no run; damaged files do not count."""
        if self.progress.plan is None:
            return None
        numbered = enumerate(self.progress.keys)
        cell = next((number for number, keys in numbered if not keys.isdisjoint(kept.by_key)), None)
        if cell is None:
            return None
        told = self.progress.keys[cell]
        of_cell = (each for each in kept.files if any(runs.key in told for runs in each.runs))
        unread = (each for each in of_cell if each not in self._read)
        room = _AT_ONCE
        for file in islice(unread, _FILES):
            self._read.add(file)
            result = read_task_result(kept.folder, file.name, file.sha256)
            if result is not None:
                self._add(result)
                room -= sum(each.nbytes for each in result.moments)
            if room < 0:
                break
        if not (known := [self._moments[key] for key in sorted(told) if key in self._moments]):
            return None
        there = sum(kept.by_key[key] for key in told)
        return LawSoFar(cell, self._variable, self._steps, max(known, key=lambda each: each.size), there)

    def _add(self, result: TaskResult) -> None:
        if self._variable not in result.variables or result.moments[0].shape[-1] <= self._steps[-1]:
            return
        variable = result.variables.index(self._variable)
        for row, (cell, first) in enumerate(zip(result.cell.tolist(), result.first.tolist(), strict=True)):
            key = result.keys[cell]
            if (key, first) not in self._runs:  # another output may have had runs computed again
                self._runs.add((key, first))
                new = result.moments_of(row).select(variable).select(self._steps)
                self._moments[key] = self._moments[key].merged(new) if key in self._moments else new

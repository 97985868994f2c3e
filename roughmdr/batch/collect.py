"""Collects the results of tasks, in whatever order they come."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from roughmdr.batch.moments import MEAN, ROWS, KnownMoments, Moments, MomentTree
from roughmdr.batch.task_result import Columns, Row, TaskResult, merge, merge_rows, not_run
from roughmdr.loading.pull_off import PullOff
from roughmdr.numerics.arguments import Floats, Ints
from roughmdr.storage.room import Room
from roughmdr.variables import FAILED, NOT_RUN


class CollectedResults(NamedTuple):
    """All results of a batch; arrays lie over the cells and, where curves are kept, over the realisations."""

    values: dict[str, Floats]
    """"curves" [cell, realization, variable, step], or "mean", "sem", "min" and "max" [cell, variable, step]."""
    pull_offs: Floats
    """[cell, realization, number of ``PullOff``], or its ``KnownMoments`` [cell, row of the table, number]."""
    diagnostics: Columns


class Collector:
    """Results so far: as curves, or as moments, which take no more memory the more realisations there are.

    Moments are kept beside curves too where a variable is ``watched``; curves take ``room``.
    """

    def __init__(
        self, variables: Sequence[str], steps: int, room: Room, *, keep_moments: bool, watched: str | None = None
    ) -> None:
        self._variables, self._shape, self._keep_moments = tuple(variables), (len(variables), steps), keep_moments
        self._watched = None if watched is None else self._variables.index(watched)
        self._results: list[TaskResult] = []
        self._room, self.none_done = room, True  # whether no realisation at all could be computed
        self._cells_of: dict[str, list[int]] = {}
        self.places: CollectedResults | None = None
        """Places of all curves, which results fill as they are added; None until it is known how many there will be."""
        self._trees: dict[str, MomentTree[Moments]] = {}
        self._pull_offs: dict[str, MomentTree[KnownMoments]] = {}
        self._diagnostics: dict[str, Row] = {}
        self._remarks: dict[str, tuple[int, str]] = {}

    def expect(self, cells: Sequence[tuple[str, int]]) -> None:
        """Make places for the curves of cells, each given by its key and its number of realisations."""
        for cell, (key, _) in enumerate(cells):
            self._cells_of.setdefault(key, []).append(cell)
        self._count = np.array([count for _, count in cells])
        shape = len(cells), int(self._count.max())
        curves, pull_offs = self._room.empty((*shape, *self._shape)), np.full((*shape, len(PullOff._fields)), np.nan)
        curves[np.arange(shape[1]) >= self._count[:, None]] = np.nan  # the others are all put there
        self.places = CollectedResults({"curves": curves}, pull_offs, not_run(shape))

    def add(self, result: TaskResult) -> Ints:
        """Add the result of a task; return the runs that got their places, as indices of cells and realisations."""
        self.none_done &= bool((result.diagnostics["status"] == FAILED).all())
        placed = np.zeros(0, dtype=np.int64)
        if self.places is not None:
            placed = self._place(result, self.places)
        elif not self._keep_moments:
            self._results.append(result._replace(moments=tuple(map(self._room.keep, result.moments))))
        if self._keep_moments or self._watched is not None:
            self._add_moments(result)
        return placed

    def _place(self, result: TaskResult, places: CollectedResults) -> Ints:
        """Put rows where they are in the result, which may be several cells alike; return where, as ``add`` does."""
        rows = zip(result.cell.tolist(), result.first.tolist(), strict=True)
        selected = [
            (row, cell, first)
            for row, (number, first) in enumerate(rows)
            for cell in self._cells_of.get(result.keys[number], ())
            if first < self._count[cell]
        ]
        row, cell, first = np.array(selected, dtype=np.int64).reshape(-1, 3).T
        places.values["curves"][cell, first] = result.moments[0][row]
        places.pull_offs[cell, first] = result.pull_offs[row, MEAN]
        for name, array in places.diagnostics.items():
            array[cell, first] = result.diagnostics[name][row]
        placed: Ints = cell * places.pull_offs.shape[1] + first
        return placed

    def _add_moments(self, result: TaskResult) -> None:
        rows_of: dict[str, list[int]] = {}
        columns = result.cell, result.first, result.diagnostics["status"], result.diagnostics["remark"]
        for row, (cell, first, status, remark) in enumerate(zip(*(each.tolist() for each in columns), strict=True)):
            key = result.keys[cell]
            rows_of.setdefault(key, []).append(row)
            if status != FAILED:
                self._trees.setdefault(key, MomentTree()).add(first, result.moments_of(row))
                self._pull_offs.setdefault(key, MomentTree()).add(first, result.pull_off_of(row))
            if remark:  # of the realisation that comes first, whichever is done first
                self._remarks[key] = min((first, remark), self._remarks.get(key, (first, remark)))
        for key, rows in rows_of.items():
            merged = merge({name: column[rows] for name, column in result.diagnostics.items()})
            before = self._diagnostics.get(key)
            self._diagnostics[key] = merged if before is None else merge_rows([before, merged])

    def watched(self, key: str, count: int) -> Moments | None:
        """Return the moments of the watched variable over the first realisations of a cell; None where some failed."""
        total = self._total(key, count)
        return None if total is None else total.select(self._watched)

    def means(self, key: str, count: int) -> dict[str, Floats]:
        """Return the mean of each variable, [step], over the first realisations of a cell, none of which failed."""
        total = self._total(key, count)
        assert total is not None
        return dict(zip(self._variables, total.mean, strict=True))

    def _total(self, key: str, count: int) -> Moments | None:
        return self._trees[key].total(count) if key in self._trees else None

    def diagnostics(self, key: str) -> Row:
        """Return the diagnostics of all realisations of a cell together."""
        return self._diagnostics[key]

    def collected(self, cells: Sequence[tuple[str, int]]) -> CollectedResults:
        """Return the results of cells, each given by its key and its number of realisations; curves are given away."""
        return self._collect_moments(cells) if self._keep_moments else self._collect_curves(cells)

    def _collect_curves(self, cells: Sequence[tuple[str, int]]) -> CollectedResults:
        if self.places is None:
            self.expect(cells)
        assert self.places is not None
        while self._results:
            self._place(self._results.pop(), self.places)
        if np.count_nonzero(self.places.diagnostics["status"] != NOT_RUN) < self._count.sum():
            raise AssertionError("a realisation was neither computed nor did it fail")
        return self.places

    def _collect_moments(self, cells: Sequence[tuple[str, int]]) -> CollectedResults:
        statistics = {name: np.full((len(cells), *self._shape), np.nan) for name in ("mean", "sem", "min", "max")}
        diagnostics = not_run((len(cells),))
        pull_offs = np.full((len(cells), len(ROWS), len(PullOff._fields)), np.nan)
        for cell, (key, count) in enumerate(cells):
            total = self._total(key, count)
            known = self._pull_offs[key].total(count) if key in self._pull_offs else None
            if total is not None and known is not None:
                pull_offs[cell] = known.table
                statistics["mean"][cell], statistics["sem"][cell] = total.mean, total.standard_error
                statistics["min"][cell], statistics["max"][cell] = total.minimum, total.maximum
            elif key not in self._diagnostics or self._diagnostics[key]["status"] != FAILED:
                raise AssertionError("a realisation was neither computed nor did it fail")
            first, remark = self._remarks.get(key, (0, ""))
            row = {**self._diagnostics[key], "remark": f"realisation {first}: {remark}" if first else remark}
            for name, array in diagnostics.items():
                array[cell] = row[name]
        return CollectedResults(statistics, pull_offs, diagnostics)

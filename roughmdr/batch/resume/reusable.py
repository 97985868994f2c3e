"""Rows of task results of earlier runs, selected as they are needed."""

from collections.abc import Callable, Iterator, Sequence

import numpy as np

from roughmdr.batch.task_result import TaskResult
from roughmdr.batch.tasks import RunRange
from roughmdr.errors import StoreError

Reader = Callable[[], TaskResult | None]  # reads a task result; None where it is damaged


class ReusableRows:
    """By the keys of the cells. Only where the rows are is in memory; they are read again when they are needed."""

    def __init__(self, keys: Sequence[set[str]], variables: Sequence[str], *, keep_moments: bool) -> None:
        self._keys = set[str]().union(*keys)
        self._variables, self._keep_moments = variables, keep_moments
        self._readers: list[Reader] = []
        self._rows: dict[str, list[tuple[int, int, int, int]]] = {}
        """First realisation, minus their number, so that long rows come first, and number of the reader and row."""
        self._has_more = False

    def matches(self, keys: Sequence[str]) -> bool:
        """Return whether a cell of this run has one of the keys."""
        return not self._keys.isdisjoint(keys)

    def add(self, read: Reader) -> bool | None:
        """Note the rows of a task result; return whether it has cells of this run, in whatever variables.

        None where it cannot be read.
        """
        result = read()
        if result is None:
            return None
        self._has_more |= not self._keys.issuperset(result.keys)
        if not self.matches(result.keys):
            return False
        self._has_more |= not set(self._variables).issuperset(result.variables)
        if self._usable(result) is not None:
            columns = zip(result.cell.tolist(), result.first.tolist(), result.size.tolist(), strict=True)
            for row, (cell, first, size) in enumerate(columns):
                if (key := result.keys[cell]) in self._keys:
                    self._rows.setdefault(key, []).append((first, -size, len(self._readers), row))
            self._readers.append(read)
        return True

    def has_unused(self, cells: Sequence[tuple[str, int]]) -> bool:
        """Return whether there is more than these cells need, each given by its key and number of realisations."""
        return self._has_more or any(
            first - minus_size > count for key, count in cells for first, minus_size, *_ in self._rows.get(key, ())
        )

    def _usable(self, result: TaskResult) -> TaskResult | None:
        single = (result.size == 1).all()
        return result.with_variables(self._variables) if self._keep_moments or single else None

    def missing(self, ranges: Sequence[RunRange], selected: list[tuple[int, int]]) -> list[RunRange]:
        """Return the runs without rows; append the rows of the others to ``selected``."""
        missing = list[RunRange]()
        for runs in ranges:
            first = runs.first
            for begin, minus_size, number, row in sorted(self._rows.get(runs.key, ())):
                if first <= begin and begin - minus_size <= runs.last:
                    missing.append(runs._replace(first=first, last=begin))
                    selected.append((number, row))
                    first = begin - minus_size
            missing.append(runs._replace(first=first))
        return [runs for runs in missing if runs.first < runs.last]

    def read(self, selected: Sequence[tuple[int, int]]) -> Iterator[TaskResult]:
        """Yield the rows that were selected."""
        rows_of: dict[int, list[int]] = {}
        for number, row in selected:
            rows_of.setdefault(number, []).append(row)
        for number, rows in rows_of.items():
            whole = self._readers[number]()
            usable = None if whole is None else self._usable(whole)
            if usable is None:
                raise StoreError("a stored task result has been damaged: is another program at work in its folder?")
            yield usable.select_rows(np.array(rows, dtype=np.int64))

"""Rows of shards that are at hand already, of an earlier run, to be taken as they are needed."""

from collections.abc import Callable, Iterator, Sequence

import numpy as np

from roughmdr.batch.task_result import TaskResult
from roughmdr.errors import StoreError


class ReusableRows:
    """By the keys of the cells. Only where the rows are is in memory; they are read again when they are taken."""

    def __init__(self, keys: Sequence[set[str]], variables: Sequence[str], *, tallied: bool) -> None:
        self._wanted = set[str]().union(*keys)
        self._variables, self._tallied = variables, tallied
        self._reads: list[Callable[[], TaskResult | None]] = []
        self._rows: dict[str, list[tuple[int, int, int, int]]] = {}
        self._more = False

    def wants(self, keys: Sequence[str]) -> bool:
        """Whether a cell of one of the keys is among those that are wanted."""
        return not self._wanted.isdisjoint(keys)

    def add(self, read: Callable[[], TaskResult | None]) -> bool | None:
        """Note the contents of a shard; whether it has cells that are wanted, in whatever variables.

        None where it cannot be read.
        """
        whole = read()
        if whole is None:
            return None
        self._more |= not self._wanted.issuperset(whole.keys)
        if not self.wants(whole.keys):
            return False
        self._more |= not set(self._variables).issuperset(whole.variables)
        shard = self._fitting(whole)
        if shard is not None:
            columns = zip(shard.cell.tolist(), shard.first.tolist(), shard.size.tolist(), strict=True)
            for row, (cell, first, size) in enumerate(columns):
                if (key := shard.keys[cell]) in self._wanted:
                    self._rows.setdefault(key, []).append((first, -size, len(self._reads), row))
            self._reads.append(read)
        return True

    def spare(self, chosen: Sequence[tuple[str, int]]) -> bool:
        """Whether there is more than goes into these cells, of which each has a key and so many realisations."""
        return self._more or any(
            first - less > count for key, count in chosen for first, less, *_ in self._rows.get(key, ())
        )

    def _fitting(self, shard: TaskResult) -> TaskResult | None:
        return shard.with_variables(self._variables) if self._tallied or shard.single else None

    def take(self, key: str, first: int, last: int, picks: list[tuple[int, int]]) -> Iterator[tuple[int, int]]:
        """Of the realisations first ... last - 1 of a cell the missing ones; rows of the others go to ``picks``."""
        for begin, less, number, row in sorted(self._rows.get(key, ())):
            if first <= begin and begin - less <= last:
                if first < begin:
                    yield first, begin
                picks.append((number, row))
                first = begin - less
        if first < last:
            yield first, last

    def shards(self, picks: Sequence[tuple[int, int]]) -> Iterator[TaskResult]:
        """The rows that were taken, as shards."""
        by_shard: dict[int, list[int]] = {}
        for number, row in picks:
            by_shard.setdefault(number, []).append(row)
        for number, rows in by_shard.items():
            whole = self._reads[number]()
            shard = None if whole is None else self._fitting(whole)
            if shard is None:
                raise StoreError("a shard that was whole is so no longer: is another program at work in its folder?")
            yield shard.select_rows(np.array(rows, dtype=np.int64))

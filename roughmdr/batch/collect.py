"""What the shards of a batch come to, in whatever order they come."""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from roughmdr.batch.moments import Moments, MomentTree
from roughmdr.batch.task_result import RunDiagnostics, TaskResult
from roughmdr.numerics.arguments import Floats
from roughmdr.variables import FAILED, NOT_RUN


class CollectedResults(NamedTuple):
    """All that was found out; arrays lie over the cells and, where curves are kept, over the realisations."""

    values: Floats
    """[cell, realization, variable, step]; of no cell where tallies are kept."""
    tally: Moments
    """[cell, variable, step]; of no cell where curves are kept, and its ``size`` says nothing."""
    sem: Floats
    """Standard errors of the means, as ``tally``."""
    beside: dict[str, NDArray[Any]]
    """What else there is to say, by the names in ``RunDiagnostics``."""


class Collector:
    """The shards so far: as curves, or as tallies, which take no more memory the more realisations there are.

    Of the curves of a ``watched`` variable there are tallies too.
    """

    def __init__(self, variables: Sequence[str], steps: int, *, tallied: bool, watched: str | None = None) -> None:
        self._shape, self._tallied = (len(variables), steps), tallied
        self._watched = None if watched is None else tuple(variables).index(watched)
        self._shards: list[TaskResult] = []
        self._tallies: dict[str, MomentTree] = {}
        self._beside: dict[str, RunDiagnostics] = {}
        self._remarks: dict[str, tuple[int, str]] = {}

    def add(self, shard: TaskResult) -> None:
        """Take in one more."""
        if not self._tallied:
            self._shards.append(shard)
        if self._tallied or self._watched is not None:
            part = np.s_[:] if self._tallied else np.s_[self._watched]
            for number in range(len(shard.first)):
                key, first, row = (
                    shard.keys[shard.cell[number]],
                    int(shard.first[number]),
                    RunDiagnostics.of(shard, number),
                )
                if row.status != FAILED:
                    self._tallies.setdefault(key, MomentTree()).add(first, shard.of_row(number).picked(part))
                if row.remark:  # of the realisation that comes first, whichever is done first
                    self._remarks[key] = min((first, row.remark), self._remarks.get(key, (first, row.remark)))
                self._beside[key] = self._beside[key].joined(row) if key in self._beside else row

    @property
    def nothing(self) -> bool:
        """Whether no realisation at all could be computed."""
        return not self._tallies and all((shard.status == FAILED).all() for shard in self._shards)

    def watched(self, key: str, count: int) -> Moments | None:
        """Of the first realisations of a cell, of the variable that is watched; None where some failed."""
        whole = self._whole(key, count)
        return whole.picked(self._watched) if self._tallied and whole is not None else whole

    def _whole(self, key: str, count: int) -> Moments | None:
        return self._tallies[key].total(count) if key in self._tallies else None

    def beside(self, key: str) -> RunDiagnostics:
        """What else there is to say of all realisations of such a cell."""
        return self._beside[key]

    def found(self, chosen: Sequence[tuple[str, int]]) -> CollectedResults:
        """All of it, for each cell of the realisations that were chosen: its key, and how many they are."""
        return self._statistics(chosen) if self._tallied else self._curves(chosen)

    def _curves(self, chosen: Sequence[tuple[str, int]]) -> CollectedResults:
        cells: dict[str, list[int]] = {}
        for cell, (key, _) in enumerate(chosen):
            cells.setdefault(key, []).append(cell)
        count = np.array([count for _, count in chosen])
        shape = len(chosen), int(count.max())
        values = np.full((*shape, *self._shape), np.nan)
        beside = _nothing(shape)
        while self._shards:
            shard = self._shards.pop()
            rows = zip(shard.cell.tolist(), shard.first.tolist(), strict=True)
            places = [
                (row, cell, first)
                for row, (number, first) in enumerate(rows)
                for cell in cells.get(shard.keys[number], ())
                if first < count[cell]
            ]
            if places:
                row, cell, first = np.array(places).T
                values[cell, first] = shard.values[row]
                for name, array in beside.items():
                    array[cell, first] = getattr(shard, name)[row]
        if ((beside["status"] == NOT_RUN) & (np.arange(shape[1]) < count[:, None])).any():
            raise AssertionError("a realisation was neither computed nor did it fail")
        nothing = np.empty((0, *self._shape))
        return CollectedResults(values, Moments.of(nothing), nothing, beside)

    def _statistics(self, chosen: Sequence[tuple[str, int]]) -> CollectedResults:
        shape = (len(chosen), *self._shape)
        mean, spread, least, greatest, sem = (np.full(shape, np.nan) for _ in range(5))
        beside = _nothing((len(chosen),))
        for cell, (key, count) in enumerate(chosen):
            whole = self._whole(key, count)
            if whole is not None:
                mean[cell], spread[cell], least[cell], greatest[cell] = whole[1:]
                sem[cell] = whole.standard_error
            elif key not in self._beside or self._beside[key].status != FAILED:
                raise AssertionError("a realisation was neither computed nor did it fail")
            if key in self._beside:
                first, remark = self._remarks.get(key, (0, ""))
                if first:
                    remark = f"realisation {first}: {remark}"
                row = self._beside[key]._replace(remark=remark)
                for name, array in beside.items():
                    array[cell] = getattr(row, name)
        return CollectedResults(np.empty((0, 1, *self._shape)), Moments(0, mean, spread, least, greatest), sem, beside)


def _nothing(shape: tuple[int, ...]) -> dict[str, NDArray[Any]]:
    """What there is to say of realisations that did not run."""
    nothing = RunDiagnostics(run_time=np.nan, numerical_error=np.nan, status=NOT_RUN)._asdict()
    return {name: np.full(shape, value, dtype=object if name == "remark" else None) for name, value in nothing.items()}

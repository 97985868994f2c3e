"""What one task found out: a table that knows its cells by their keys, and can be kept as bytes."""

import io
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from roughmdr.batch.moments import Moments
from roughmdr.numerics.arguments import Floats
from roughmdr.variables import DONE

Integers = NDArray[np.int64]


class TaskResult(NamedTuple):
    """A row for each realisation, or for some that were put together (``tally.py``); all arrays begin with the rows."""

    keys: tuple[str, ...]
    """Of the cells (``identity.py``)."""
    variables: tuple[str, ...]
    cell: Integers
    """Which of the keys a row belongs to."""
    first: Integers
    """The first realisation of a row."""
    size: Integers
    """How many they are."""
    values: Floats
    """[row, variable, step]; means, where there are several."""
    spread: Floats
    """As ``values``, and so the next two, where tallies are kept; of no variable where curves are."""
    least: Floats
    greatest: Floats
    run_time: Floats
    """[s]"""
    numerical_error: Floats
    tabor: Floats
    """The least Tabor number; inf where the strength of the attraction is not known."""
    law: Integers
    """The law of adhesion that was taken, as in ``ADHESION_CODES``."""
    slope: Floats
    """As in ``limits.Extremes``."""
    extent: Floats
    status: Integers
    remark: NDArray[np.str_]
    """Why a realisation failed, or what makes its ensemble doubtful; mostly empty."""

    @property
    def single(self) -> bool:
        """Whether every row is one realisation."""
        return bool((self.size == 1).all())

    def of_row(self, row: int) -> Moments:
        """What a row says of all variables."""
        if self.size[row] == 1:
            return Moments.of(self.values[row])
        return Moments(int(self.size[row]), self.values[row], self.spread[row], self.least[row], self.greatest[row])

    def rows(self, chosen: Integers) -> "TaskResult":
        """Some of the rows."""
        return self._replace(**{name: getattr(self, name)[chosen] for name in _BY_ROW})

    def with_variables(self, names: Sequence[str]) -> "TaskResult | None":
        """The same in these variables; None where one is missing."""
        if tuple(names) == self.variables:
            return self
        if not set(names) <= set(self.variables):
            return None
        order = [self.variables.index(name) for name in names]
        tallied = () if self.single else ("spread", "least", "greatest")
        picked = {name: getattr(self, name)[:, order] for name in ("values", *tallied)}
        return self._replace(variables=tuple(names), **picked)

    def dumped(self) -> bytes:
        """The shard as bytes."""
        buffer = io.BytesIO()
        np.savez(buffer, allow_pickle=False, **{name: np.asarray(array) for name, array in self._asdict().items()})
        return buffer.getvalue()

    @classmethod
    def loaded(cls, content: bytes) -> "TaskResult":
        """The shard that bytes hold; ValueError, KeyError or OSError where they hold none."""
        with np.load(io.BytesIO(content), allow_pickle=False) as held:
            arrays = {name: held[name] for name in cls._fields}
        return cls(
            **{**arrays, "keys": tuple(arrays["keys"].tolist()), "variables": tuple(arrays["variables"].tolist())}
        )


_BY_ROW = tuple(name for name in TaskResult._fields if name not in ("keys", "variables"))


class RunDiagnostics(NamedTuple):
    """What there is to say of one realisation, beside its variables."""

    run_time: float
    numerical_error: float = np.nan
    tabor: float = np.inf
    law: int = 0
    slope: float = 0.0
    extent: float = 0.0
    status: int = DONE
    remark: str = ""

    def joined(self, other: "RunDiagnostics") -> "RunDiagnostics":
        """Of both together: the time of all, the worst of the rest, what was said first."""
        return RunDiagnostics(
            self.run_time + other.run_time,
            float(np.fmax(self.numerical_error, other.numerical_error)),  # NaN where a run failed
            min(self.tabor, other.tabor),
            max(self.law, other.law),
            max(self.slope, other.slope),
            max(self.extent, other.extent),
            max(self.status, other.status),
            self.remark or other.remark,
        )

    @classmethod
    def of(cls, shard: TaskResult, row: int) -> "RunDiagnostics":
        """The row of a shard."""
        return cls(*(getattr(shard, name)[row].item() for name in cls._fields))


def table_of(
    keys: Sequence[str], variables: Sequence[str], rows: Sequence[tuple[int, int, Moments, RunDiagnostics]], steps: int
) -> TaskResult:
    """The shard of rows: the cell, where the realisations begin, what they come to, and what else there is to say."""
    cell, first, tallies, beside = zip(*rows, strict=True) if rows else ((), (), (), ())
    size = np.array([tally.size for tally in tallies], dtype=np.int64)
    shape = (len(rows), len(variables), steps)

    def stacked(name: str) -> Floats:
        if name != "mean" and (size == 1).all():
            return np.empty((len(rows), 0, 0))
        return np.array([getattr(tally, name) for tally in tallies]).reshape(shape)

    columns = {
        name: np.array([getattr(row, name) for row in beside], dtype=kind)
        for name, kind in zip(
            RunDiagnostics._fields, (float, float, float, np.int64, float, float, np.int64, str), strict=True
        )
    }
    return TaskResult(
        tuple(keys),
        tuple(variables),
        np.array(cell, dtype=np.int64),
        np.array(first, dtype=np.int64),
        size,
        stacked("mean"),
        stacked("spread"),
        stacked("least"),
        stacked("greatest"),
        **columns,
    )

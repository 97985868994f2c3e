"""The result of a task: a table that knows its cells by their keys, and can be stored as bytes.

Diagnostics, as ``RUN_DIAGNOSTICS`` declares them, are a row for one run and columns for several.
"""

import io
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from roughmdr.batch.moments import ROWS as KNOWN_ROWS, KnownMoments, Moments
from roughmdr.loading.pull_off import PullOff
from roughmdr.numerics.arguments import Floats
from roughmdr.variables import RUN_DIAGNOSTICS

Integers = NDArray[np.int64]
_DIAGNOSTIC = "diagnostic."  # before the name of each in a file, apart from those of the other arrays
_MOMENTS = Moments._fields[1:]
_ARRAYS = ("keys", "variables", "cell", "first", "size", "pull_offs")
Row = Mapping[str, Any]  # diagnostics of one run, or of several that are merged, by name
Columns = dict[str, NDArray[Any]]


class TaskResult(NamedTuple):
    """A row for each realisation, or for several that were merged (``moments.py``); all arrays begin with the rows."""

    keys: tuple[str, ...]  # keys of the cells (``resume/keys.py``)
    variables: tuple[str, ...]
    cell: Integers  # index of the key that a row belongs to
    first: Integers  # first realisation of a row
    size: Integers  # number of realisations of a row
    moments: tuple[Floats, ...]
    """Means [row, variable, step] and, where a row has several realisations, spreads, minima and maxima."""
    pull_offs: Floats
    """Tables of ``KnownMoments`` of the numbers of ``PullOff``: [row, row of the table, number]."""
    diagnostics: Columns

    @classmethod
    def of(cls, keys: Sequence[str], variables: Sequence[str], rows: Sequence["ResultRow"], steps: int) -> "TaskResult":
        """Make the table of rows with moments [variable, step]."""
        cell, first, moments, known, diagnostics = zip(*rows, strict=True) if rows else ((), (), (), (), ())
        size = np.array([each.size for each in moments], dtype=np.int64)
        shape = (len(rows), len(variables), steps)
        arrays = tuple(
            np.array([getattr(each, name) for each in moments]).reshape(shape)
            for name in (_MOMENTS if (size > 1).any() else _MOMENTS[:1])
        )
        cells, firsts = (np.array(each, dtype=np.int64) for each in (cell, first))
        pull_offs = np.array([each.table for each in known]).reshape(len(rows), len(KNOWN_ROWS), len(PullOff._fields))
        columns: Columns = {
            name: np.array([row[name] for row in diagnostics], dtype=each.dtype)
            for name, each in RUN_DIAGNOSTICS.items()
        }
        return cls(tuple(keys), tuple(variables), cells, firsts, size, arrays, pull_offs, columns)

    @property
    def realizations(self) -> int:
        """Number of realisations in all rows."""
        return int(self.size.sum())

    @property
    def runs(self) -> list[tuple[str, int, int]]:
        """Key of a cell, first realisation and number after the last of each range of realisations, in order."""
        found = list[tuple[str, int, int]]()
        rows = sorted(zip(self.cell.tolist(), self.first.tolist(), self.size.tolist(), strict=True))
        for key, first, size in ((self.keys[cell], first, size) for cell, first, size in rows):
            begin = found.pop()[1] if found and found[-1][::2] == (key, first) else first
            found.append((key, begin, first + size))
        return found

    def moments_of(self, row: int) -> Moments:
        """Return the moments of all variables of a row."""
        if self.size[row] == 1:
            return Moments.of(self.moments[0][row])
        return Moments(int(self.size[row]), *(array[row] for array in self.moments))

    def pull_off_of(self, row: int) -> KnownMoments:
        """Return the moments of the pull-offs of a row."""
        return KnownMoments(int(self.size[row]), self.pull_offs[row])

    def select_rows(self, rows: Integers) -> "TaskResult":
        """Return the table of some of the rows."""
        cell, first, size = (array[rows] for array in (self.cell, self.first, self.size))
        diagnostics = {name: column[rows] for name, column in self.diagnostics.items()}
        moments = tuple(array[rows] for array in self.moments)
        return TaskResult(self.keys, self.variables, cell, first, size, moments, self.pull_offs[rows], diagnostics)

    def with_variables(self, names: Sequence[str]) -> "TaskResult | None":
        """Return the table with these variables in this order; None where one is missing."""
        if tuple(names) == self.variables:
            return self
        if not set(names) <= set(self.variables):
            return None
        order = [self.variables.index(name) for name in names]
        return self._replace(variables=tuple(names), moments=tuple(array[:, order] for array in self.moments))

    def to_bytes(self) -> bytes:
        """Return the table as the content of a file."""
        arrays = {name: np.asarray(getattr(self, name)) for name in _ARRAYS}
        arrays |= dict(zip(_MOMENTS, self.moments, strict=False))
        arrays |= {_DIAGNOSTIC + name: column for name, column in self.diagnostics.items()}
        buffer = io.BytesIO()
        np.savez(buffer, allow_pickle=False, **arrays)
        return buffer.getvalue()

    @classmethod
    def from_bytes(cls, content: bytes) -> "TaskResult":
        """Read the table that the content of a file holds; ValueError, KeyError or OSError where it holds none."""
        with np.load(io.BytesIO(content), allow_pickle=False) as file:
            keys, variables = (tuple(file[name].tolist()) for name in ("keys", "variables"))
            cell, first, size, pull_offs = (file[name] for name in _ARRAYS[2:])
            moments = tuple(file[name] for name in _MOMENTS if name in file)
            stated = {name.removeprefix(_DIAGNOSTIC): file[name] for name in file if name.startswith(_DIAGNOSTIC)}
        return cls(keys, variables, cell, first, size, moments, pull_offs, complete(stated, size.size))


class ResultRow(NamedTuple):
    """A realisation, or several that were merged."""

    cell: int  # index of the key
    first: int  # first realisation
    moments: Moments
    pull_off: KnownMoments  # of the numbers of ``PullOff``
    diagnostics: Row


def row_of(**known: Any) -> Row:
    """Return the diagnostics of a run: those that are known, and what stands for the others."""
    if undeclared := known.keys() - RUN_DIAGNOSTICS.keys():
        raise AssertionError(f"not declared in RUN_DIAGNOSTICS: {', '.join(undeclared)}")
    return {name: known.get(name, declared.missing) for name, declared in RUN_DIAGNOSTICS.items()}


def complete(stated: Columns, count: int) -> Columns:
    """Return the diagnostics of runs that are done, of which a file may not state all."""
    return {
        name: stated[name].astype(each.dtype) if name in stated else np.full(count, each.unstated, dtype=each.dtype)
        for name, each in RUN_DIAGNOSTICS.items()
    }


def not_run(shape: tuple[int, ...]) -> Columns:
    """Return the diagnostics of realisations that did not run; texts are objects, since any may be put there."""
    return {
        name: np.full(shape, each.missing, dtype=object if each.dtype is str else each.dtype)
        for name, each in RUN_DIAGNOSTICS.items()
    }


def merge(columns: Mapping[str, Sequence[Any] | NDArray[Any]]) -> Row:
    """Return the diagnostics of several runs together, which are in the order of their realisations."""
    return {
        name: next(filter(None, columns[name]), declared.missing)
        if declared.merge == "first"
        else getattr(np, declared.merge).reduce(columns[name])
        for name, declared in RUN_DIAGNOSTICS.items()
    }


def merge_rows(rows: Sequence[Row]) -> Row:
    """Merge rows as ``merge`` does columns."""
    return merge({name: [row[name] for row in rows] for name in RUN_DIAGNOSTICS})

"""The result of a task: a table that knows its cells by their keys, and can be stored as bytes."""

import io
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from roughmdr.batch.diagnostics import Columns, Row, columns_of
from roughmdr.batch.moments import Moments
from roughmdr.numerics.arguments import Floats
from roughmdr.variables import RUN_DIAGNOSTICS

Integers = NDArray[np.int64]
_DIAGNOSTIC = "diagnostic."  # before the name of each in a file, apart from those of the other arrays


class TaskResult(NamedTuple):
    """A row for each realisation, or for several that were merged (``moments.py``); all arrays begin with the rows."""

    keys: tuple[str, ...]
    """Keys of the cells (``resume/keys.py``)."""
    variables: tuple[str, ...]
    cell: Integers
    """Index of the key that a row belongs to."""
    first: Integers
    """First realisation of a row."""
    size: Integers
    """Number of realisations of a row."""
    values: Floats
    """[row, variable, step]; means, where there are several."""
    spread: Floats
    """Shape of ``values``, and so the next two, where moments are kept; [row, 0, 0] where curves are."""
    minimum: Floats
    maximum: Floats
    diagnostics: Columns

    @classmethod
    def of(
        cls,
        keys: Sequence[str],
        variables: Sequence[str],
        rows: Sequence[tuple[int, int, Moments, Row]],
        steps: int,
    ) -> "TaskResult":
        """Make the table of rows: index of the key, first realisation, moments [variable, step] and diagnostics."""
        cell, first, moments, diagnostics = zip(*rows, strict=True) if rows else ((), (), (), ())
        size = np.array([each.size for each in moments], dtype=np.int64)
        shape = (len(rows), len(variables), steps)

        def stacked(name: str) -> Floats:
            if name != "mean" and (size == 1).all():
                return np.empty((len(rows), 0, 0))
            return np.array([getattr(each, name) for each in moments]).reshape(shape)

        return cls(
            keys=tuple(keys),
            variables=tuple(variables),
            cell=np.array(cell, dtype=np.int64),
            first=np.array(first, dtype=np.int64),
            size=size,
            values=stacked("mean"),
            spread=stacked("spread"),
            minimum=stacked("minimum"),
            maximum=stacked("maximum"),
            diagnostics=columns_of(diagnostics),
        )

    @property
    def realizations(self) -> int:
        """Number of realisations in all rows."""
        return int(self.size.sum())

    @property
    def single(self) -> bool:
        """Whether every row is one realisation."""
        return bool((self.size == 1).all())

    def moments(self, row: int) -> Moments:
        """Return the moments of all variables of a row."""
        if self.size[row] == 1:
            return Moments.of(self.values[row])
        return Moments(int(self.size[row]), self.values[row], self.spread[row], self.minimum[row], self.maximum[row])

    def select_rows(self, rows: Integers) -> "TaskResult":
        """Return the table of some of the rows."""
        arrays = {name: getattr(self, name)[rows] for name in _ARRAYS}
        return self._replace(**arrays, diagnostics={name: each[rows] for name, each in self.diagnostics.items()})

    def with_variables(self, names: Sequence[str]) -> "TaskResult | None":
        """Return the table with these variables in this order; None where one is missing."""
        if tuple(names) == self.variables:
            return self
        if not set(names) <= set(self.variables):
            return None
        order = [self.variables.index(name) for name in names]
        moments = () if self.single else ("spread", "minimum", "maximum")
        arrays = {name: getattr(self, name)[:, order] for name in ("values", *moments)}
        return self._replace(variables=tuple(names), **arrays)

    def to_bytes(self) -> bytes:
        """Return the table as the content of a file."""
        arrays = {name: np.asarray(getattr(self, name)) for name in self._fields if name != "diagnostics"}
        arrays |= {_DIAGNOSTIC + name: column for name, column in self.diagnostics.items()}
        buffer = io.BytesIO()
        np.savez(buffer, allow_pickle=False, **arrays)
        return buffer.getvalue()

    @classmethod
    def from_bytes(cls, content: bytes) -> "TaskResult":
        """Read the table that the content of a file holds; ValueError, KeyError or OSError where it holds none."""
        with np.load(io.BytesIO(content), allow_pickle=False) as file:
            keys, variables = (tuple(file[name].tolist()) for name in ("keys", "variables"))
            arrays = {name: file[name] for name in _ARRAYS}
            diagnostics = {
                name: file[_DIAGNOSTIC + name]
                if _DIAGNOSTIC + name in file
                else np.full(arrays["size"].shape, declared.unstated, dtype=declared.dtype)
                for name, declared in RUN_DIAGNOSTICS.items()
            }
        return cls(keys, variables, **arrays, diagnostics=diagnostics)


_ARRAYS = tuple(name for name in TaskResult._fields if name not in ("keys", "variables", "diagnostics"))

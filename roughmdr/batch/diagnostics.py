"""Diagnostics of runs as ``RUN_DIAGNOSTICS`` declares them: of one run as a row, of several as columns."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from roughmdr.variables import RUN_DIAGNOSTICS

Row = Mapping[str, Any]
"""Diagnostics of one run, or of several that are merged, by name."""
Columns = dict[str, NDArray[Any]]


def row_of(**known: Any) -> Row:
    """Return the diagnostics of a run: those that are known, and what stands for the others."""
    if undeclared := known.keys() - RUN_DIAGNOSTICS.keys():
        raise AssertionError(f"not declared in RUN_DIAGNOSTICS: {', '.join(undeclared)}")
    return {name: known.get(name, declared.missing) for name, declared in RUN_DIAGNOSTICS.items()}


def columns_of(rows: Sequence[Row]) -> Columns:
    """Return the diagnostics of runs as arrays."""
    return {
        name: np.array([row[name] for row in rows], dtype=declared.dtype) for name, declared in RUN_DIAGNOSTICS.items()
    }


def not_run(shape: tuple[int, ...]) -> Columns:
    """Return the diagnostics of realisations that did not run; texts are objects, since any may be put there."""
    return {
        name: np.full(shape, declared.missing, dtype=object if declared.dtype is str else declared.dtype)
        for name, declared in RUN_DIAGNOSTICS.items()
    }


def merge(columns: Mapping[str, Sequence[Any] | NDArray[Any]]) -> Row:
    """Return the diagnostics of several runs together, which are in the order of their realisations."""
    merged = {}
    for name, declared in RUN_DIAGNOSTICS.items():
        column = columns[name]
        if declared.merge == "first":
            merged[name] = next(filter(None, column), declared.missing)
        else:
            merged[name] = column[0] if len(column) == 1 else getattr(np, declared.merge).reduce(column)
    return merged


def merge_rows(rows: Sequence[Row]) -> Row:
    """Merge rows as ``merge`` does columns."""
    return merge({name: [row[name] for row in rows] for name in RUN_DIAGNOSTICS})

"""Diagnostics of runs as ``RUN_DIAGNOSTICS`` declares them: of one run as a row, of several as columns."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from roughmdr.variables import RUN_DIAGNOSTICS

Row = Mapping[str, Any]  # diagnostics of one run, or of several that are merged, by name
Columns = dict[str, NDArray[Any]]


def row_of(**known: Any) -> Row:
    """Return the diagnostics of a run: those that are known, and what stands for the others."""
    if undeclared := known.keys() - RUN_DIAGNOSTICS.keys():
        raise AssertionError(f"not declared in RUN_DIAGNOSTICS: {', '.join(undeclared)}")
    return {name: known.get(name, declared.missing) for name, declared in RUN_DIAGNOSTICS.items()}


def columns_of(rows: Sequence[Row]) -> Columns:
    """Return the diagnostics of runs as arrays."""
    return {name: np.array([row[name] for row in rows], dtype=each.dtype) for name, each in RUN_DIAGNOSTICS.items()}


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

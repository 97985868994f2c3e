"""The cells of a result, one a line: what became of each, what it took, how right it is, what is to be said of it."""

import numpy as np

from roughmdr.result.layout import cell_label, cells_of, method_of
from roughmdr.schema.wording import printable, seconds_in_words
from roughmdr.storage.labelled import Labelled
from roughmdr.variables import DONE, FAILED

_HEAD = ("cell", "status", "realisations", "time", "numerical error", "standard error", "method", "")


def describe_cells(result: Labelled) -> str:
    """A table; the standard error of the mean force where it was asked for."""
    rows = [_HEAD, *(_row(result, number, cell) for number, cell in enumerate(cells_of(result)))]
    used = [column for column in range(len(_HEAD)) if any(row[column] for row in rows[1:])]
    widths = {column: max(len(row[column]) for row in rows) for column in used}
    return "\n".join("  ".join(f"{row[column]:<{widths[column]}}" for column in used).rstrip() for row in rows)


def _row(result: Labelled, number: int, cell: tuple[int, ...]) -> tuple[str, ...]:
    def of(name: str) -> np.ndarray:
        return np.atleast_1d(result.variables[name].values[cell])

    status = of("status")
    done, failed = int((status == DONE).sum()), int((status == FAILED).sum())
    count = int(of("realization_count")[0]) if "realization_count" in result.variables else status.size
    time, error = of("run_time"), of("numerical_error")
    reached = of("accuracy_reached")[0] if "accuracy_reached" in result.variables else np.nan
    what = "done" if not failed and done else "not run" if not failed else "failed"
    return (
        cell_label(result, cell) or str(number),
        what if not (failed and done) else f"{failed} failed",
        str(count),
        seconds_in_words(float(np.nansum(time))),
        f"{np.nanmax(error):.1e}" if np.isfinite(error).any() else "-",
        "" if np.isnan(reached) else f"{reached:.2g}",
        method_of(result, cell),
        _remark(result, cell),
    )


def _remark(result: Labelled, cell: tuple[int, ...]) -> str:
    """The first thing that was said of a cell, and in which realisation."""
    if "remark" not in result.coordinates:
        return ""
    remarks = np.atleast_1d(result.coordinates["remark"].values[cell])
    said = np.flatnonzero(remarks != "")
    if not said.size:
        return ""
    where = f"realisation {said[0]}: " if "realization" in result.coordinates["remark"].dims else ""
    return where + printable(str(remarks[said[0]]).split("\n")[0])

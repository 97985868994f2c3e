"""Table of the cells of a result: status, run time, errors, method and first remark of each."""

import numpy as np

from roughmdr.result.layout import cell_label, cells_of, method_of
from roughmdr.schema.wording import format_seconds, printable
from roughmdr.storage.labelled import Labelled
from roughmdr.variables import DONE, FAILED

_HEADINGS = ("cell", "status", "realisations", "time", "numerical error", "standard error", "method", "")


def describe_cells(result: Labelled) -> str:
    """Return a table with a line for each cell; columns that are empty for all cells are left out."""
    lines = [_HEADINGS, *(_line(result, number, cell) for number, cell in enumerate(cells_of(result)))]
    columns = [column for column in range(len(_HEADINGS)) if any(line[column] for line in lines[1:])]
    widths = {column: max(len(line[column]) for line in lines) for column in columns}
    return "\n".join("  ".join(f"{line[column]:<{widths[column]}}" for column in columns).rstrip() for line in lines)


def _line(result: Labelled, number: int, cell: tuple[int, ...]) -> tuple[str, ...]:
    def values(name: str) -> np.ndarray:
        return np.atleast_1d(result.variables[name].values[cell])

    status = values("status")
    done, failed = int((status == DONE).sum()), int((status == FAILED).sum())
    summary = "done" if done else "not run"
    if failed:
        summary = f"{failed} failed" if done else "failed"
    count = int(values("realization_count")[0]) if "realization_count" in result.variables else status.size
    time, error = values("run_time"), values("numerical_error")
    reached = values("accuracy_reached")[0] if "accuracy_reached" in result.variables else np.nan
    return (
        cell_label(result, cell) or str(number),
        summary,
        str(count),
        format_seconds(float(np.nansum(time))),
        f"{np.nanmax(error):.1e}" if np.isfinite(error).any() else "-",
        "" if np.isnan(reached) else f"{reached:.2g}",
        method_of(result, cell),
        _first_remark(result, cell),
    )


def _first_remark(result: Labelled, cell: tuple[int, ...]) -> str:
    """Return the first remark on a cell, and on which realisation it is."""
    if "remark" not in result.coordinates:
        return ""
    remarks = np.atleast_1d(result.coordinates["remark"].values[cell])
    present = np.flatnonzero(remarks != "")
    if not present.size:
        return ""
    prefix = f"realisation {present[0]}: " if "realization" in result.coordinates["remark"].dims else ""
    return prefix + printable(str(remarks[present[0]]).split("\n")[0])

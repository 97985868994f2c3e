"""The text and the table of ``roughmdr info OUT.nc.parts``: how far a batch is that is not over."""

import math
import shlex
from itertools import islice
from pathlib import Path

from roughmdr.batch.plan import Plan
from roughmdr.batch.resume.kept import Kept, LawSoFar, Progress, SoFar, progress_of
from roughmdr.report.documents import LawTable, PartCellTable, PartsTable
from roughmdr.report.result_document import swept_table
from roughmdr.scene.sweep import describe_cell
from roughmdr.schema.units import format_quantity
from roughmdr.schema.wording import format_seconds, format_table, printable
from roughmdr.variables import LAW_VARIABLES, STEP_COORDINATES

_MAX_CELLS = 30


def describe_parts(kept: Kept, *, cells: bool = False) -> str:
    """Return how many runs are done, of which cells, and what goes on from there; of all ``cells``, or of the first."""
    progress = progress_of(kept)
    lines = [] if kept.share is None else [("part", "{} of {}".format(*kept.share))]
    lines += [("kept", _counted(kept, progress))]
    lines += _cells(kept, progress, len(progress.done) if cells else _MAX_CELLS)
    law = SoFar(progress).law(kept)
    lines += [] if law is None else law_lines(progress, law)
    if kept.failed:
        reason = printable(kept.remark.partition("\n")[0])
        lines.append(("failed", f"{len(kept.failed)} runs ({reason}); the next batch repeats them"))
    if kept.began:
        lines.append(("begun", f"{kept.began}; something was kept last at {kept.last}"))
    lines.append(("at work", _at_work(kept)))
    if kept.complete:
        lines.append(("when all are", printable(f"roughmdr join {shlex.quote(str(kept.output))}")))
    else:
        lines.append(("goes on by", printable(kept.continued_by)))
    return format_table(lines)


def describe_progress(kept: Kept, progress: Progress, seconds: float) -> str:
    """Return how many runs are done and, where that is known, about how long the others take; one takes ``seconds``."""
    told = _counted(kept, progress)
    left = 0 if progress.total is None else progress.total - kept.runs
    return told if left <= 0 or not math.isfinite(seconds) else f"{told}; about {format_seconds(left * seconds)} left"


def describe_shares(folders: list[Path]) -> str:
    """Return how far each of the shares of a batch is, of those whose folders are there."""
    shares = [(folder, Kept(folder)) for folder in folders]
    return format_table(
        [(folder.name, f"{_counted(kept, progress_of(kept))}; at work: {_at_work(kept)}") for folder, kept in shares]
    )


def law_lines(progress: Progress, law: LawSoFar) -> list[tuple[str, str]]:
    """Return the mean law so far with its standard error, where it is known, at a few steps of the path."""
    assert progress.plan is not None  # or there would be no law
    plan, (mean, error) = progress.plan, (law.moments.mean, law.moments.standard_error)
    cell, branch, unit = plan.cells[law.cell], plan.coordinates()["branch"].values, LAW_VARIABLES[law.variable].units
    values = next(islice(plan.scene.sweep.cells(), law.cell, None))
    where = f", {printable(describe_cell(values))}" if values else ""
    name, some = law.variable.replace("_", " "), f" of {law.kept}" if law.moments.size < law.kept else ""
    runs = f"{law.moments.size}{some} run{'s' * (law.kept > 1)}"
    return [("law so far", f"mean {name} over {runs}{where}")] + [
        (
            "",
            f"{format_quantity(float(mean[number]), unit, error=float(error[number]))} at {plan.control} "
            f"{format_quantity(float(cell.values[step]), STEP_COORDINATES[plan.control])}, {branch[step]}",
        )
        for number, step in enumerate(law.steps.tolist())
        if math.isfinite(mean[number])
    ]


def parts_table(kept: Kept) -> PartsTable:
    """Return the same as a table for --json."""
    progress = progress_of(kept)
    scene, law = progress.scene, SoFar(progress).law(kept)
    return {
        "title": None if scene is None else scene.title,
        "folder": str(kept.folder),
        "output": str(kept.output),
        "part": None if kept.share is None else "{}/{}".format(*kept.share),
        "done": kept.runs,
        "total": progress.total,
        "failed": len(kept.failed),
        "remark": kept.remark or None,
        "cells": [_cell(progress, number) for number in range(len(progress.done))],
        "law": None if law is None else _law(progress, law),
        "began": kept.began or None,
        "last": kept.last or None,
        "holder": None if kept.holder is None else kept.holder._asdict(),
        "holder_known": kept.holder_known,
        "continued_by": kept.continued_by,
        "versions": kept.versions or None,
        "scene": kept.scene or None,
    }


def _law(progress: Progress, law: LawSoFar) -> LawTable:
    assert progress.plan is not None  # or there would be no law
    return {
        "swept": _swept(progress.plan, law.cell),
        "variable": law.variable,
        "runs": law.moments.size,
        "control": progress.plan.control,
        "values": progress.plan.cells[law.cell].values[law.steps].tolist(),
        "mean": law.moments.mean.tolist(),
        "standard_error": law.moments.standard_error.tolist(),
    }


def _swept(plan: Plan, number: int) -> dict[str, float | str]:
    return swept_table(plan.scene.sweep.coordinates(), plan.sizes, number)


def _cell(progress: Progress, number: int) -> PartCellTable:
    assert progress.plan is not None  # or there would be no cells
    return {
        "swept": _swept(progress.plan, number),
        "done": progress.done[number],
        "failed": progress.failed[number],
        "total": progress.realizations if progress.total is not None else None,
    }


def _counted(kept: Kept, progress: Progress) -> str:
    if not kept.scene:
        return "nothing: a run has just begun here, or has just ended"
    title = "" if progress.scene is None else f"{printable(progress.scene.title)}: "
    if progress.total is not None:
        return f"{title}{kept.runs} of {progress.total} runs"
    more = ", of as many as the error asked for takes" if progress.scene and progress.scene.accuracy else ""
    return f"{title}{kept.runs} runs{more}"


def _cells(kept: Kept, progress: Progress, most: int) -> list[tuple[str, str]]:
    """Return a line for each cell of a sweep."""
    if progress.plan is None:
        reason = "other versions began the batch" if progress.scene is not None else "its scene cannot be read here"
        return [("cells", f"not told: {reason}")] if kept.scene else []
    if not progress.plan.sizes:
        return []
    of = f" of {progress.realizations}" if progress.total is not None and progress.realizations is not None else ""
    lines = []
    for number, values in enumerate(progress.plan.scene.sweep.cells()):
        if number == most:
            lines.append(("", f"... and {len(progress.done) - most} more cells"))
            break
        fails = f", {progress.failed[number]} failed" if progress.failed[number] else ""
        told = f"{progress.done[number]}{of}{fails}  {printable(describe_cell(values))}"
        lines.append(("" if number else "cells", told))
    return lines


def _at_work(kept: Kept) -> str:
    if kept.complete and kept.holder is None:
        return "no run: this part is done"
    if kept.holder is None:
        ended = "runs failed, or it was interrupted" if kept.failed else "it was interrupted, or is about to end"
        return f"no run: {ended}"
    process, host, since = kept.holder
    if kept.holder_known:
        return f"process {process} since {since}"
    return f"perhaps process {process} on {printable(host)}, since {since}; that cannot be told from here"

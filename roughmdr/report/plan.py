"""A plan in words, and as a table for --json."""

from collections.abc import Iterator

import numpy as np

from roughmdr.batch.estimate import Estimate
from roughmdr.batch.foresee import Foreseen, Prospect
from roughmdr.batch.plan import Plan
from roughmdr.model_error.at_given import largest_at_force
from roughmdr.report.advice import advice_on
from roughmdr.report.contacts import describe_sample
from roughmdr.report.documents import ForeseenTable, PlanTable, trust_table
from roughmdr.report.prospect import implausible_lines, largest_tension, pressure_at_closest, prospect_lines
from roughmdr.report.result_document import coordinate_tables, swept_table
from roughmdr.report.summary import counted, motion_lines
from roughmdr.schema.units import format_quantity
from roughmdr.schema.wording import format_bytes, format_seconds, format_table, printable, under
from roughmdr.variables import LATERAL, SAMPLE, YIELDING


def describe_plan(plan: Plan, estimate: Estimate, prospect: Prospect, workers: int) -> str:
    """Return what a run will do, how long it will take and how much memory."""
    steps, output = plan.cells[0].path.separation.size, plan.scene.output
    unlikely = implausible_lines(plan, prospect)
    lines = [
        *under("implausible", unlikely),
        ("scene", printable(plan.scene.title)),
        ("runs", f"{counted(plan.sizes, estimate.runs // len(plan.cells), steps)}: {estimate.runs} in total"),
        *_required_accuracy(plan),
        *under("lattice", plan.lattice_lines),
        ("output", f"{', '.join(plan.variables)}; {output.keep}; {format_bytes(estimate.file)}"),
        ("tasks", f"{estimate.tasks} on {workers} worker{'s' * (workers > 1)}"),
        ("time", f"about {format_seconds(estimate.seconds)}, of which {format_seconds(estimate.start_up)} to start"),
        ("memory", _memory(estimate)),
        *_lateral(plan),
        *prospect_lines(prospect),
        *under("sample", _sample(plan, prospect).splitlines()),
        *(line for noted, lines in plan.stage_notes.items() for line in under(noted, lines)),
        *under("advice", advice_on(plan.scene.toml, _resolution(prospect)).splitlines()),
        *_beside(plan, estimate),
        *motion_lines(plan.coordinates()),
    ]
    map_lines = [text for text in plan.map_lines if text not in unlikely]
    lines += [*under("map", map_lines), *under("warning", plan.warnings), *under("cannot run", prospect.failures)]
    return format_table([*lines, *under("left out", plan.left_out)])


def _memory(estimate: Estimate) -> str:
    total, resident, available = map(format_bytes, (estimate.memory, estimate.resident, estimate.available_memory))
    too_much = estimate.memory - estimate.resident > estimate.available_memory
    warning = f"; it can get only {available} more" if too_much else ""
    return f"about {total}, of which {resident} for Python and its packages{warning}"


def _required_accuracy(plan: Plan) -> Iterator[tuple[str, str]]:
    """Yield what [accuracy] requires."""
    accuracy = plan.scene.accuracy
    if accuracy is None:
        return
    if plan.choice is None:
        text = f"standard error at most {accuracy.relative:g} of the largest mean force, method {accuracy.method!r};"
        yield "accuracy", text
    else:
        yield from under("accuracy", plan.choice.lines)
    if plan.scene.asperities.is_random:
        yield "", f"realisations are added to each cell until it is met, up to {accuracy.max_realizations};"
        yield "", "time, memory and tasks are those of the runs above"


def _beside(plan: Plan, estimate: Estimate) -> Iterator[tuple[str, str]]:
    """Yield what stages add to each run, and how long it may take."""
    longest, finest = format_seconds(estimate.longest), format_bytes(estimate.finest)
    for stage in plan.scene.stages:
        yield from under(stage.key, stage.plan_lines(longest, finest))


def _lateral(plan: Plan) -> Iterator[tuple[str, str]]:
    """Yield the range of the lateral displacements."""
    if plan.control == LATERAL.name:
        ends = [(float(cell.values.min()), float(cell.values.max())) for cell in plan.cells]
        lowest, highest = min(low for low, _ in ends), max(high for _, high in ends)
        yield "lateral", f"displacement from {format_quantity(lowest, 'm', to=highest)}, what is normal held"


def _resolution(prospect: Prospect) -> float:
    """Return the largest error by the resolution of a map that was foreseen; 0 where no cell was."""
    return max((cell.law.model_error.parts["resolution_error"] for cell in prospect.foreseen), default=0.0)


def _sample(plan: Plan, prospect: Prospect) -> str:
    """Return how far the sample of each cell that was foreseen stands for others; empty for several a cell."""
    scene, laws = plan.scene, [cell.law for cell in prospect.foreseen]
    if scene.accuracy is not None or scene.batch.realizations > 1 or scene.estimators == ("expected",):
        return ""
    return describe_sample({name: np.array([getattr(law, name) for law in laws]) for name in SAMPLE}, scene.toml)


def plan_table(plan: Plan, estimate: Estimate, prospect: Prospect, workers: int) -> PlanTable:
    """Return all that ``describe_plan`` tells, as numbers."""
    scene, accuracy = plan.scene, plan.scene.accuracy
    return {
        "implausible": implausible_lines(plan, prospect),
        "title": scene.title,
        "sizes": plan.sizes,
        "coordinates": coordinate_tables(scene.sweep.coordinates(), plan.sizes),
        "realizations": estimate.runs // len(plan.cells),
        "steps": plan.steps,
        "control": plan.control,
        "variables": plan.variables,
        "keep": scene.output.keep,
        "runs": estimate.runs,
        "tasks": estimate.tasks,
        "workers": workers,
        "time": {"total": estimate.seconds, "longest": estimate.longest, "start_up": estimate.start_up},
        "memory": {
            "total": estimate.memory,
            "resident": estimate.resident,
            "finest": estimate.finest,
            "available": estimate.available_memory,
        },
        "file_size": estimate.file,
        "accuracy": None if accuracy is None else accuracy.model_dump(exclude_none=True),
        "choice": [] if plan.choice is None else list(plan.choice.lines),
        "cells": [_foreseen(plan, cell) for cell in prospect.foreseen],
        "path": list(plan.path_notes),
        "lattice": plan.lattice_lines,
        "map": plan.map_lines,
        "trust": trust_table(prospect_lines(prospect)),
        "sample": _sample(plan, prospect) or None,
        "advice": advice_on(scene.toml, _resolution(prospect)) or None,
        "warnings": plan.warnings,
        "failures": list(prospect.failures),
        "left_out": list(plan.left_out),
    }


def _foreseen(plan: Plan, cell: Foreseen) -> ForeseenTable:
    separation, error, has_area = cell.path.separation, cell.law.model_error, "pressure" in cell.law.variables
    return {
        "swept": swept_table(plan.scene.sweep.coordinates(), plan.sizes, cell.cell),
        "start": float(separation[0]),
        "closest": float(separation.min()),
        "end": float(separation[-1]),
        "pressure": pressure_at_closest(cell) if has_area else np.nan,
        "tension": largest_tension(cell) if has_area else np.nan,
        "yielding": dict.fromkeys(YIELDING, np.nan) | cell.law.yielding(),
        "tabor_number": cell.law.tabor,
        "adhesion": cell.law.model,
        "model_error": error.named["model_error"],
        "parts": error.parts,
        "at_given_pressure": largest_at_force(
            {**error.named, "grid_points": cell.law.grid_points, "tabor_number": cell.law.tabor}
        ),
        "largest_contact_fraction": error.named["largest_contact_fraction"],
        "effective_contacts": cell.law.effective_contacts,
        "sampling_error": cell.law.sampling_error,
        "area_sampling_error": cell.law.area_sampling_error,
        "contact_fraction_at_pull_off": cell.fraction_at_pull_off,
        "trusted_separation": error.named["trusted_separation"],
    }

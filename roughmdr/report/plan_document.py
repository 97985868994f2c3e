"""A plan as a table for --json."""

import numpy as np

from roughmdr.batch.estimate import Estimate
from roughmdr.batch.foresee import Foreseen, Prospect
from roughmdr.batch.plan import Plan
from roughmdr.report.advice import advice_lines
from roughmdr.report.documents import ForeseenTable, PlanTable, paragraphs, trust_table
from roughmdr.report.few_contacts import foreseen_sample
from roughmdr.report.prospect import implausible_lines, largest_tension, pressure_at_closest, prospect_lines
from roughmdr.report.result_document import coordinate_tables, swept_table
from roughmdr.report.summary import foreseen_resolution


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
        "accuracy": None if accuracy is None else accuracy.model_dump(),
        "cells": [_foreseen(plan, cell) for cell in prospect.foreseen],
        "path": list(plan.path_notes),
        "lattice": plan.lattice_lines,
        "map": plan.map_lines,
        "trust": trust_table(prospect_lines(prospect)),
        "sample": paragraphs(foreseen_sample(plan, prospect)).get("sample"),
        "advice": paragraphs(advice_lines(scene.toml, foreseen_resolution(prospect))).get("advice"),
        "warnings": plan.warnings,
        "failures": list(dict.fromkeys([*estimate.failures, *prospect.failures])),
        "left_out": list(plan.left_out),
    }


def _foreseen(plan: Plan, cell: Foreseen) -> ForeseenTable:
    sizes = plan.sizes
    number = tuple(int(each) for each in np.unravel_index(cell.cell, tuple(sizes.values()))) if sizes else ()
    separation, error, has_area = cell.path.separation, cell.law.model_error, "pressure" in cell.law.variables
    return {
        "swept": swept_table(plan.scene.sweep.coordinates(), sizes, number),
        "start": float(separation[0]),
        "closest": float(separation.min()),
        "end": float(separation[-1]),
        "pressure": pressure_at_closest(cell) if has_area else np.nan,
        "tension": largest_tension(cell) if has_area else np.nan,
        "tabor_number": cell.law.tabor,
        "adhesion": cell.law.model,
        "model_error": error.named["model_error"],
        "parts": dict(error.parts),
        "largest_contact_fraction": error.largest_fraction,
        "effective_contacts": cell.law.effective_contacts,
        "contact_fraction_at_pull_off": cell.fraction_at_pull_off,
        "trusted_separation": error.trusted_separation,
    }

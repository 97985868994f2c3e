"""A plan in words, and as a table for --json."""

import math
from collections.abc import Callable, Iterator

import numpy as np

from roughmdr.batch.estimate import Estimate
from roughmdr.batch.foresee import Foreseen, Prospect
from roughmdr.batch.plan import Plan
from roughmdr.ensemble.maps.words import IMPLAUSIBLE
from roughmdr.model_error.at_given import largest_at_force
from roughmdr.report.advice import advice_on
from roughmdr.report.contacts import describe_sample
from roughmdr.report.documents import ForeseenTable, PlanTable, trust_table
from roughmdr.report.result_document import coordinate_tables, swept_table
from roughmdr.report.summary import counted, motion_lines
from roughmdr.result.hardness import hardness_lines
from roughmdr.result.trust import trust_lines
from roughmdr.schema.units import format_quantity
from roughmdr.schema.wording import format_bytes, format_seconds, format_table, printable, under
from roughmdr.variables import LATERAL, SAMPLE, YIELDED, YIELDING

_ROUNDING = 1e-9  # difference of pressures, over the largest, that is rounding
_HARDEST = 1e11  # hardness of diamond [Pa]; no mean pressure of a contact is larger


def prospect_lines(prospect: Prospect) -> Iterator[tuple[str, str]]:
    """Yield the lines of the cells that were foreseen; only that nothing is known where none could be."""
    cells = prospect.foreseen
    if not cells:
        yield "trust", "not known: no cell that was tried can be computed"
        return

    def over_cells(unit: str, value: Callable[[Foreseen], float]) -> str:
        values = [value(cell) for cell in cells]
        return format_quantity(min(values), unit, to=max(values))

    start = over_cells("m", lambda cell: float(cell.path.separation[0]))
    closest = over_cells("m", lambda cell: float(cell.path.separation.min()))
    returns = any(cell.path.separation[-1] > cell.path.separation.min() for cell in cells)
    end = over_cells("m", lambda cell: float(cell.path.separation[-1]))
    if all(np.ptp(cell.path.separation) == 0.0 for cell in cells):
        yield "path", f"at h = {start}"
    else:
        yield "path", f"from h = {start} down to {closest}{f', and back to {end}' if returns else ''}"
    if all("pressure" in cell.law.variables for cell in cells):
        paired = prospect.interaction is not None and prospect.interaction.model == "pairwise"
        told = "estimated from a small part of the asperities" if paired else "as expected"
        if lost := sum(math.isnan(pressure_at_closest(cell)) for cell in cells):
            none = f"no equilibrium is found there in {lost} of {len(cells)} cells"
            yield "pressure", f"not known at closest approach: {none}"
        else:
            yield "pressure", f"{over_cells('Pa', pressure_at_closest)} at closest approach, {told}"
        if any(largest_tension(cell) > 0.0 for cell in cells):
            yield "", f"{over_cells('Pa', largest_tension)} is about the largest tension"
    tabor = min(cell.law.tabor for cell in cells)
    if tabor < math.inf:
        yield "adhesion", f"Tabor number from {tabor:.3g} on: {', '.join(sorted({cell.law.model for cell in cells}))}"
    names = cells[0].law.model_error.named
    numbers = {name: np.array([cell.law.model_error.named[name] for cell in cells]) for name in names}
    numbers["grid_points"] = np.array([cell.law.grid_points for cell in cells])
    model = None if prospect.interaction is None else prospect.interaction.model
    advise = prospect.coupled_seconds < math.inf
    curved = all("nominal_contact_radius" in cell.law.variables for cell in cells)
    at_pull_off = [cell.fraction_at_pull_off for cell in cells]
    summits = all(cell.summits for cell in cells)
    yield from trust_lines(numbers, at_pull_off, interaction=model, advise=advise, curved=curved, summits=summits)
    marked = sum(cell.law.marked_steps > 0.0 for cell in cells)
    if marked and prospect.interaction is not None:
        on_grid = prospect.interaction.beyond == "boundary_elements"
        becomes = "realisations are computed by boundary elements" if on_grid else "steps are marked"
        yield "", f"too much overlap or contact for pairs in {marked} of {len(cells)} cells: {becomes}"
    touches = any(cell.law.model_error.named["largest_contact_fraction"] > 0.0 for cell in cells)
    if model is None and touches and advise:
        parts = any(not math.isnan(cell.fraction_at_pull_off) for cell in cells)
        how = 'with [interaction] model = "pairwise" it would be found ' if parts else ""
        yield "", f"{how}at about {format_quantity(prospect.coupled_seconds, 's')} a realisation on one core"
    of_cells = [cell.law.yielding() for cell in cells]
    yield from hardness_lines({name: [each.get(name, math.nan) for each in of_cells] for name in (*YIELDING, *YIELDED)})


def pressure_at_closest(cell: Foreseen) -> float:
    """Return the pressure of a cell with a nominal area at its closest approach [Pa]; NaN without an equilibrium."""
    return float(cell.law.variables["pressure"][np.argmin(cell.path.separation)])


def largest_tension(cell: Foreseen) -> float:
    """Return the largest tension of a cell with a nominal area [Pa]; 0 for none, or for what is but rounding."""
    pressure = cell.law.variables["pressure"]
    tension = -float(np.nanmin(pressure, initial=0.0))
    return tension if tension > _ROUNDING * float(np.nanmax(pressure, initial=0.0)) else 0.0


def implausible_lines(plan: Plan, prospect: Prospect) -> list[str]:
    """Return what is implausible of the maps of a plan, and of the mean pressure in its contacts."""
    lines = [text for text in plan.map_lines if IMPLAUSIBLE in text]
    for cell in prospect.foreseen:
        pressure, modulus = _mean_in_contacts(cell), plan.cells[cell.cell].scene.effective_modulus
        if pressure > min(_HARDEST, modulus):
            limit = "E*" if modulus < _HARDEST else "the hardness of diamond"
            bear = f"contacts would bear {format_quantity(pressure, 'Pa')} on average at closest approach, more than"
            return [*lines, f"a {IMPLAUSIBLE}: {bear} {limit}, {format_quantity(min(_HARDEST, modulus), 'Pa')}"]
    return lines


def _mean_in_contacts(cell: Foreseen) -> float:
    """Return the mean pressure in the contacts at closest approach [Pa]; 0 where it is not known."""
    variables = cell.law.variables
    if not {"pressure", "contact_fraction"} <= variables.keys():
        return 0.0
    closest = int(np.argmin(cell.path.separation))
    pressure, fraction = (float(variables[name][closest]) for name in ("pressure", "contact_fraction"))
    return pressure / fraction if fraction > 0.0 else 0.0


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

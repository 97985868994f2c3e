"""Summaries of plans, results and ensembles, for the command line."""

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

import numpy as np

from roughmdr.ensemble.maps.words import describe_map
from roughmdr.report.advice import advice_lines
from roughmdr.report.contact_pressure import conduction_lines, contact_pressure_lines
from roughmdr.report.few_contacts import foreseen_sample, sample_of_result
from roughmdr.report.prospect import implausible_lines, prospect_lines
from roughmdr.report.pull_off import describe_pull_off
from roughmdr.result.trust import trust_of_result
from roughmdr.result.view import ResultView
from roughmdr.schema.units import format_quantity
from roughmdr.schema.wording import format_bytes, format_seconds, format_table, printable, under
from roughmdr.stages import STAGES
from roughmdr.storage.labelled import Array, Labelled
from roughmdr.variables import DONE, FAILED, LATERAL, TIME

if TYPE_CHECKING:
    from roughmdr.batch.estimate import Estimate
    from roughmdr.batch.foresee import Prospect
    from roughmdr.batch.plan import Plan

_NOT_KNOWN = "not known: no run was computed"
_HEADINGS = ("cell", "status", "realisations", "time", "numerical error", "standard error", "method", "")


def describe_plan(plan: "Plan", estimate: "Estimate", prospect: "Prospect", workers: int) -> str:
    """Return what a run will do, how long it will take and how much memory."""
    steps, output = plan.cells[0].path.separation.size, plan.scene.output
    unlikely = implausible_lines(plan, prospect)
    lines = [
        *under("implausible", unlikely),
        ("scene", printable(plan.scene.title)),
        ("runs", f"{_sizes(plan.sizes, estimate.runs // len(plan.cells), steps)}: {estimate.runs} in total"),
        *_required_accuracy(plan),
        *under("lattice", plan.lattice_lines),
        ("output", f"{', '.join(plan.variables)}; {output.keep}; {format_bytes(estimate.file)}"),
        ("tasks", f"{estimate.tasks} on {workers} worker{'s' * (workers > 1)}"),
        ("time", f"about {format_seconds(estimate.seconds)}, of which {format_seconds(estimate.start_up)} to start"),
        ("memory", _memory(estimate)),
        *_lateral(plan),
        *prospect_lines(prospect),
        *foreseen_sample(plan, prospect),
        *(line for noted, lines in plan.stage_notes.items() for line in under(noted, lines)),
        *advice_lines(plan.scene.toml, foreseen_resolution(prospect)),
        *_beside(plan, estimate),
        *_motion(plan.coordinates()),
    ]
    failures = dict.fromkeys([*estimate.failures, *prospect.failures])
    map_lines = [text for text in plan.map_lines if text not in unlikely]
    lines += [*under("map", map_lines), *under("warning", plan.warnings), *under("cannot run", failures)]
    return format_table([*lines, *under("left out", plan.left_out)])


def _memory(estimate: "Estimate") -> str:
    total, resident, available = map(format_bytes, (estimate.memory, estimate.resident, estimate.available_memory))
    too_much = estimate.memory - estimate.resident > estimate.available_memory
    warning = f"; it can get only {available} more" if too_much else ""
    return f"about {total}, of which {resident} for Python and its packages{warning}"


def _required_accuracy(plan: "Plan") -> Iterator[tuple[str, str]]:
    """Yield what [accuracy] requires."""
    accuracy = plan.scene.accuracy
    if accuracy is not None:
        text = f"standard error at most {accuracy.relative:g} of the largest mean force, method {accuracy.method!r};"
        yield "accuracy", text
        yield "", f"realisations are added to each cell until it is met, up to {accuracy.max_realizations};"
        yield "", "time, memory and tasks are those of the runs above"


def _beside(plan: "Plan", estimate: "Estimate") -> Iterator[tuple[str, str]]:
    """Yield what stages add to each run, and how long it may take."""
    longest, finest = format_seconds(estimate.longest), format_bytes(estimate.finest)
    for stage in plan.scene.stages:
        yield from under(stage.key, stage.plan_lines(longest, finest))


def _motion(coordinates: Mapping[str, Array]) -> Iterator[tuple[str, str]]:
    """Yield how long a viscoelastic body is pressed and released."""
    if TIME.name in coordinates:
        last = coordinates[TIME.name].values[..., -1]
        yield (
            "motion",
            f"{format_quantity(float(last.min()), 's', to=float(last.max()))} from the first step to the last",
        )


def _lateral(plan: "Plan") -> Iterator[tuple[str, str]]:
    """Yield the range of the lateral displacements."""
    if plan.control == LATERAL.name:
        ends = [(float(cell.values.min()), float(cell.values.max())) for cell in plan.cells]
        lowest, highest = min(low for low, _ in ends), max(high for _, high in ends)
        yield "lateral", f"displacement from {format_quantity(lowest, 'm', to=highest)}, what is normal held"


def describe_result(result: ResultView, elapsed: float | None = None, *, left_out: bool = True) -> str:
    """Return what a result holds; ``elapsed`` [s] is the time of the whole run, ``left_out`` whether to say why."""
    left_out_lines = result.attrs["left_out"].splitlines() if left_out else ()
    return format_table([*summary_lines(result, elapsed), *under("left out", left_out_lines)])


def summary_lines(result: ResultView, elapsed: float | None = None) -> Iterator[tuple[str, str]]:
    """Yield what a result holds: names, empty where the line before goes on, and texts."""
    attrs = result.attrs
    realizations, steps = result.realizations, result.sizes["step"]
    time = f"{format_seconds(float(np.nansum(_values(result, 'run_time'))))} of work in the realisations"
    if elapsed is not None:
        time = f"{format_seconds(elapsed)}; {time}, over all workers"
    yield "computed", f"{printable(attrs['title'])}: {_sizes(result.sweep, realizations, steps)}"
    yield "variables", ", ".join(result.curves)
    yield from under("path", attrs.get("path", "").splitlines())
    yield from _motion(result.coordinates)
    yield from under("lattice", attrs.get("lattice", "").splitlines())
    yield from under("map", attrs.get("map", "").splitlines())
    yield from describe_pull_off(result, _NOT_KNOWN)
    yield from _avalanches(result)
    yield from _contacts_at_ends(result)
    yield from trust_of_result(result)
    yield from sample_of_result(result)
    yield from contact_pressure_lines(result)
    yield from conduction_lines(result)
    for noted in [stage.noted for stage in STAGES if stage.noted in attrs]:
        yield from under(noted, attrs[noted].splitlines())
    yield from advice_lines(attrs["scene"], result.largest("resolution_error"))
    yield from (line for stage in STAGES for line in stage.result_lines(result))
    yield from _adhesion(result)
    yield from under("accuracy", attrs.get("accuracy", "").splitlines())
    yield from under("failed", describe_failed(result).splitlines())
    yield from under("warning", attrs.get("warnings", "").splitlines())
    yield _numerical_error(result)
    yield "run time", time


def foreseen_resolution(prospect: "Prospect") -> float:
    """Return the largest error by the resolution of a map that was foreseen; 0 where no cell was."""
    return max((cell.law.model_error.parts["resolution_error"] for cell in prospect.foreseen), default=0.0)


def _numerical_error(result: ResultView) -> tuple[str, str]:
    """Return the line of the numerical error: of sums their rounding, of integrals over heights or time theirs."""
    integrated = result.estimator == "expected" or TIME.name in result.coordinates
    name = "integration" if integrated else "rounding"
    errors = _values(result, "numerical_error")[result.done]
    if not errors.size:
        return name, _NOT_KNOWN
    return name, f"at most {errors.max():.1e} of the largest force (not the error of the model)"


def describe_ensemble(ensemble: Labelled) -> str:
    """Return the number of asperities and, if they are from a height map, how well it resolves them."""
    attrs = ensemble.attrs
    lines = [("asperities", f"{ensemble.sizes['asperity']} of shape {attrs['shape']}")]
    if "points_per_summit" in attrs:
        lines += under("map", describe_map(attrs))
        lines += [
            ("hills", "each has the profile of its best contacts, by size: ellipses on its own part of the map")
            if attrs.get("asperity_model") == "hills"
            else ("summits", "each is a paraboloid through a point above its eight neighbours, fitted to these")
        ]
    return format_table([*lines, *under("warning", attrs.get("warnings", "").splitlines())])


def describe_origin(result: ResultView, size: float | None) -> str:
    """Return seed, versions, history and scene of a result of ``size`` bytes, None where it is in no file."""
    attrs = result.attrs
    lines = [
        *([] if size is None else [("size", format_bytes(size))]),
        ("seed", str(attrs["seed"])),
        ("made by", f"{attrs['source']}; {attrs['packages']}"),
        ("history", attrs["history"]),
    ]
    return format_table([*lines, *under("scene", attrs["scene"].strip().splitlines())])


def describe_cells(result: ResultView) -> str:
    """Return a table with a line for each cell; columns that are empty for all cells are left out."""
    lines = [_HEADINGS, *(_cell_line(result, number, cell) for number, cell in enumerate(result.cells))]
    columns = [column for column in range(len(_HEADINGS)) if any(line[column] for line in lines[1:])]
    widths = {column: max(len(line[column]) for line in lines) for column in columns}
    return "\n".join("  ".join(f"{line[column]:<{widths[column]}}" for column in columns).rstrip() for line in lines)


def _values(result: ResultView, name: str) -> np.ndarray:
    return result.variables[name].values


def _sizes(swept: dict[str, int], realizations: int, steps: int) -> str:
    parts = [f"{size} {name}" for name, size in swept.items()]
    return " x ".join([*parts, f"{realizations} realisation{'s' * (realizations > 1)}", f"{steps} steps"])


def _adhesion(result: ResultView) -> Iterator[tuple[str, str]]:
    """Yield which adhesion models were used, if the Tabor number is known."""
    if {"tabor_number", "adhesion_law"} <= set(result.variables):
        names = result.variables["adhesion_law"].attrs["flag_meanings"].split()
        values = _values(result, "adhesion_law")[result.done]
        counts = ", ".join(f"{names[i]} in {int((values == i).sum())}" for i in np.unique(values))
        tabor = _values(result, "tabor_number")
        if np.isfinite(tabor).any():
            yield "adhesion", f"{counts} of {values.size}; smallest Tabor number {np.nanmin(tabor):.3g}"


def describe_failed(result: ResultView) -> str:
    """Return how many runs failed, which was the first, and why; empty if none did."""
    status = _values(result, "status")
    failed, reason = status == FAILED, ""
    if not failed.any():
        return ""
    if "remark" in result.coordinates:
        first = tuple(map(int, np.argwhere(failed)[0]))
        label = result.label(first[:-1] if result.keeps_runs else first)
        names = [each for each in (label, f"realisation {first[-1]}" if result.keeps_runs else "") if each]
        said = str(result.coordinates["remark"].values[failed][0]).split("\n")[0]
        reason = f" ({': '.join(filter(None, [', '.join(names), printable(said)]))})"
    counted = "runs" if result.keeps_runs else "cells"
    again = "the same command tries them again, which helps where a worker or its memory failed"
    return f"{int(failed.sum())} of {status.size} {counted} failed{reason}; {again}"


def _contacts_at_ends(result: ResultView) -> Iterator[tuple[str, str]]:
    """Yield a note if a path that unloads begins or ends in contact; fewer than half a contact, expected, are none."""
    name = "contact_count" if "contact_count" in result.variables else "contact_count_max"
    if name not in result.variables or "unloading" not in result.branches:
        return
    if result.control == LATERAL.name:  # which is in contact throughout
        return
    count = result.variables[name].values
    first, last = (int((count[..., step] >= 0.5).sum()) for step in (0, -1))
    if first or last:
        total = f"{int(result.done.sum())} {'runs' if name == 'contact_count' else 'cells'}"
        yield "note", f"in contact at the first step in {first}, at the last in {last} of {total}"


def _avalanches(result: ResultView) -> Iterator[tuple[str, str]]:
    """Yield the number of avalanches of adhesive contacts that feel each other, and the largest."""
    most, largest = (result.largest(f"avalanche_{name}") for name in ("count", "size_max"))
    if result.attrs.get("interaction") == "pairwise" and most > 0.0:
        yield "avalanches", f"up to {most:.0f} in a realisation; contacts that jump in the largest: {largest:.0f}"


def _cell_line(result: ResultView, number: int, cell: tuple[int, ...]) -> tuple[str, ...]:
    def values(name: str) -> np.ndarray:
        return np.atleast_1d(result.variables[name].values[cell])

    status = values("status")
    done, failed = int((status == DONE).sum()), int((status == FAILED).sum())
    outcome = (f"{failed} failed" if done else "failed") if failed else ("done" if done else "not run")
    if "marked_steps" in result.variables and (marked := np.nanmax(values("marked_steps"), initial=0.0)) > 0.0:
        outcome += f", {marked:.0f} steps marked"
    count = int(values("realization_count")[0]) if "realization_count" in result.variables else status.size
    time, error = values("run_time"), values("numerical_error")
    reached = values("accuracy_reached")[0] if "accuracy_reached" in result.variables else np.nan
    return (
        result.label(cell) or str(number),
        outcome,
        str(count),
        format_seconds(float(np.nansum(time))),
        f"{np.nanmax(error):.1e}" if np.isfinite(error).any() else "-",
        "" if np.isnan(reached) else f"{reached:.2g}",
        result.method(cell),
        first_remark(result, cell),
    )


def first_remark(result: ResultView, cell: tuple[int, ...]) -> str:
    """Return the first remark on a cell, and on which realisation it is."""
    if "remark" not in result.coordinates:
        return ""
    remarks = np.atleast_1d(result.coordinates["remark"].values[cell])
    present = np.flatnonzero(remarks != "")
    if not present.size:
        return ""
    prefix = f"realisation {present[0]}: " if "realization" in result.coordinates["remark"].dims else ""
    return prefix + printable(str(remarks[present[0]]).split("\n")[0])

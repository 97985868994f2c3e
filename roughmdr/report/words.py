"""Plans and results in words, for the command line."""

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from roughmdr.result.layout import (
    cell_label,
    cells_of,
    done_of,
    estimator_of,
    realizations_of,
    stored_variables,
    swept_sizes,
)
from roughmdr.result.pull_off import PullOff, pull_off_force
from roughmdr.schema.wording import bytes_in_words, printable, seconds_in_words
from roughmdr.storage.labelled import Labelled
from roughmdr.variables import FAILED

if TYPE_CHECKING:
    from roughmdr.batch.estimate import Estimate
    from roughmdr.batch.plan import Plan

_MOST_CELLS = 30


def describe_plan(plan: "Plan", estimate: "Estimate", workers: int) -> str:
    """What a run will do, how long it will take and how much memory."""
    steps, output = plan.cells[0].path.separation.size, plan.scene.output
    lines = [
        ("scene", printable(plan.scene.title)),
        ("runs", f"{_sizes(plan.sizes, estimate.runs // len(plan.cells), steps)}: {estimate.runs} in all"),
        *_until(plan),
        ("output", f"{', '.join(output.variables)}; {output.keep}; {bytes_in_words(estimate.file)}"),
        ("tasks", f"{estimate.tasks} on {workers} worker{'s' * (workers > 1)}"),
        ("time", f"about {seconds_in_words(estimate.seconds)}, of them {seconds_in_words(estimate.start_up)} to start"),
        ("memory", _memory(estimate)),
    ]
    lines += [*_several("warning", tuple(plan.warnings)), *_several("cannot run", estimate.failures)]
    return _table([*lines, *_several("left out", plan.left_out)])


def _memory(estimate: "Estimate") -> str:
    all_of_it, resident = bytes_in_words(estimate.memory), bytes_in_words(estimate.resident)
    more = f"; it can have only {bytes_in_words(estimate.room)} more than those here"
    too_much = estimate.memory - estimate.resident > estimate.room
    return f"about {all_of_it}, of them {resident} for Python and its packages{more if too_much else ''}"


def _until(plan: "Plan") -> Iterator[tuple[str, str]]:
    """What is asked for with [accuracy]."""
    accuracy = plan.scene.accuracy
    if accuracy is not None:
        yield (
            "accuracy",
            f"standard error of {accuracy.relative:g} of the largest mean force, method {accuracy.method!r}",
        )
        yield "", f"these runs first, then more, cell by cell, up to {accuracy.max_realizations} realisations each;"
        yield "", "time, memory and tasks are those of the first"


def describe_result(result: Labelled, elapsed: float | None = None) -> str:
    """What a result holds; ``elapsed`` [s] is the time that it took in all."""
    attrs = result.attrs
    realizations, steps = realizations_of(result), result.sizes["step"]
    lines = [
        ("computed", f"{printable(attrs['title'])}: {_sizes(swept_sizes(result), realizations, steps)}"),
        ("variables", ", ".join(stored_variables(result))),
        *_pull_off(result),
        *_open_ends(result),
        *_adhesion(result),
        *_several("accuracy", tuple(attrs.get("accuracy", "").splitlines())),
        *_several("failed", tuple(describe_failed(result).splitlines())),
        *_several("warning", tuple(attrs.get("warnings", "").splitlines())),
        ("run time", _run_time(result, elapsed)),
        ("error", _error(result)),
    ]
    return _table([*lines, *_several("left out", tuple(attrs["left_out"].splitlines()))])


def describe_ensemble(ensemble: Labelled) -> str:
    """How many asperities there are and, of those of a height map, how well it resolves them."""
    attrs = ensemble.attrs
    lines = [("asperities", f"{ensemble.sizes['asperity']} of shape {attrs['shape']}")]
    if "points_per_summit" in attrs:
        cut = f", without waves below {attrs['cutoff']:.4g} m" if "cutoff" in attrs else ""
        lines += [
            ("map", f"{attrs['patch_x']:.4g} m x {attrs['patch_y']:.4g} m, {attrs['undefined_share']:.2%} undefined"),
            ("", f"{'periodic, ' * attrs['periodic']}detrended: {attrs['detrend']}{cut}"),
            ("", f"r.m.s. height {attrs['rms_height']:.4g} m, r.m.s. slope {attrs['rms_slope']:.3g}"),
            ("summits", f"{attrs['points_per_summit']:.3g} points a summit; {attrs['saddles']} saddles left out"),
            ("", "each a paraboloid through the point above its eight neighbours, fitted to these"),
            ("", f"misfit {attrs['misfit']:.2g}: up to 0.15, noise and spacing change the curvatures by 15 % at most"),
        ]
    return _table([*lines, *_several("warning", tuple(attrs.get("warnings", "").splitlines()))])


def describe_origin(result: Labelled, size: float) -> str:
    """Which scene made a result, of ``size`` bytes, with which seed and versions, and when."""
    attrs = result.attrs
    lines = [
        ("size", bytes_in_words(size)),
        ("seed", str(attrs["seed"])),
        ("made by", f"{attrs['source']}; {attrs['packages']}"),
        ("history", attrs["history"]),
    ]
    return _table([*lines, *_several("scene", tuple(attrs["scene"].strip().splitlines()))])


def _array(result: Labelled, name: str) -> np.ndarray:
    return result.variables[name].values


def _sizes(swept: dict[str, int], realizations: int, steps: int) -> str:
    parts = [f"{size} {name}" for name, size in swept.items()]
    return " x ".join([*parts, f"{realizations} realisation{'s' * (realizations > 1)}", f"{steps} steps"])


def _run_time(result: Labelled, elapsed: float | None) -> str:
    inside = f"{seconds_in_words(float(np.nansum(_array(result, 'run_time'))))} of work in the realisations"
    return inside if elapsed is None else f"{seconds_in_words(elapsed)}; {inside}, over all workers"


def _error(result: Labelled) -> str:
    known = _array(result, "numerical_error")[done_of(result)]
    if not known.size:
        return "not known: no run was computed"
    return f"numerical error at most {known.max():.1e} of the largest force"


def _pull_off(result: Labelled) -> Iterator[tuple[str, str]]:
    """The pull-off force of each cell, and what it is."""
    if "force" not in stored_variables(result):
        return
    if "unloading" not in result.coordinates["branch"].values:
        yield "pull-off", "none: the flat never retracts"
        return
    pull_off = pull_off_force(result)
    cells = cells_of(result)
    forces = [_force(pull_off, cell) for cell in cells[:_MOST_CELLS]]
    width = max(map(len, forces))
    for number, (force, cell) in enumerate(zip(forces, cells, strict=False)):
        yield "" if number else "pull-off", f"{force:<{width}}  {cell_label(result, cell)}".rstrip()
    if len(cells) > _MOST_CELLS:
        yield "", f"... and {len(cells) - _MOST_CELLS} cells more"
    what = "largest tension of each realisation on the way back, or 0: mean ± standard error"
    if "force" not in result.variables:
        what = "largest tension of the mean curve on the way back ± its standard error there"
    elif estimator_of(result) == "expected":
        what = "lowest point of the expected law; realisations let go one by one, and each reaches a little deeper"
    elif realizations_of(result) == 1:
        what = "largest tension on the way back; one realisation has no standard error"
    yield "", f"({what}; in brackets its change there from step to step of the path)"


def _force(pull_off: PullOff, cell: tuple[int, ...]) -> str:
    mean, error = float(pull_off.mean[cell]), float(pull_off.standard_error[cell])
    tensile = int(pull_off.tensile[cell])
    if tensile == 0:
        return "none: never tensile" if pull_off.curves[cell] else "not known: no run was computed"
    some = "" if tensile == pull_off.curves[cell] else f", {tensile} of {pull_off.curves[cell]} tensile"
    return f"{mean:.4g} N{'' if math.isnan(error) else f' ± {error:.2g} N'} [{pull_off.change[cell]:.1g} N]{some}"


def _adhesion(result: Labelled) -> Iterator[tuple[str, str]]:
    """Which laws of adhesion were taken, where the Tabor number is known."""
    if {"tabor_number", "adhesion_law"} <= set(result.variables):
        law = result.variables["adhesion_law"]
        names = law.attrs["flag_meanings"].split()
        values = law.values[done_of(result)]
        taken = ", ".join(f"{names[i]} in {int((values == i).sum())}" for i in np.unique(values))
        tabor = _array(result, "tabor_number")
        if np.isfinite(tabor).any():
            yield "adhesion", f"{taken} of {values.size}; least Tabor number {np.nanmin(tabor):.3g}"


def describe_failed(result: Labelled) -> str:
    """How much failed, and why the first of it did; empty where nothing did."""
    status = _array(result, "status")
    failed = status == FAILED
    if not failed.any():
        return ""
    what = "runs" if "realization" in result.sizes else "cells"
    reason = ""
    if "remark" in result.coordinates:
        reason = f" ({printable(str(result.coordinates['remark'].values[failed][0]).split(chr(10))[0])})"
    return f"{int(failed.sum())} of {status.size} {what} failed{reason}; the same command computes them again"


def _open_ends(result: Labelled) -> Iterator[tuple[str, str]]:
    """A remark where the path begins or ends with contacts; less than half of one, as expected laws have, is none."""
    name = "contact_count" if "contact_count" in result.variables else "contact_count_max"
    if name not in result.variables:
        return
    count = result.variables[name].values
    first, last = (int((count[..., step] >= 0.5).sum()) for step in (0, -1))
    if first or last:
        what = f"{int(done_of(result).sum())} {'runs' if name == 'contact_count' else 'cells'}"
        yield "note", f"in contact at the first step in {first}, at the last in {last} of {what}"


def _several(name: str, lines: tuple[str, ...]) -> list[tuple[str, str]]:
    return [(name if i == 0 else "", line) for i, line in enumerate(lines)]


def _table(lines: list[tuple[str, str]]) -> str:
    return "\n".join(f"{name:<12} {text}".rstrip() for name, text in lines)

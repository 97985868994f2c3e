"""Results and ensembles in words, as commands print them."""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from roughmdr.ensemble.maps.words import describe_map
from roughmdr.fitting.stored import given_fit
from roughmdr.fitting.words import describe_fit
from roughmdr.report.advice import advice_on
from roughmdr.report.contacts import conduction_lines, contact_pressure_lines, describe_pull_off, sample_of_result
from roughmdr.result.given import given_result
from roughmdr.result.trust import trust_of_result
from roughmdr.result.view import ResultView
from roughmdr.schema.keywords import named_keywords
from roughmdr.schema.units import format_quantity
from roughmdr.schema.wording import format_bytes, format_seconds, format_table, printable, under
from roughmdr.stages import STAGES
from roughmdr.storage.files import size_of
from roughmdr.storage.labelled import Array, Labelled
from roughmdr.variables import DONE, FAILED, LATERAL, TIME

if TYPE_CHECKING:
    import xarray as xr

_NOT_KNOWN = "not known: no run was computed"
_HEADINGS = ("cell", "status", "realisations", "time", "numerical error", "standard error", "method", "")


def motion_lines(coordinates: Mapping[str, Array]) -> Iterator[tuple[str, str]]:
    """Yield how long a viscoelastic body is pressed and released."""
    if TIME.name in coordinates:
        last = coordinates[TIME.name].values[..., -1]
        times = format_quantity(float(last.min()), "s", to=float(last.max()))
        yield "motion", f"{times} from the first step to the last"


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
    yield "computed", f"{printable(attrs['title'])}: {counted(result.sweep, realizations, steps)}"
    yield "variables", ", ".join(result.curves)
    if "parameter" in result.coordinates:
        yield "derivatives", f"by {', '.join(result.coordinates['parameter'].values)}"
    yield from under("path", attrs.get("path", "").splitlines())
    yield from motion_lines(result.coordinates)
    yield from under("lattice", attrs.get("lattice", "").splitlines())
    yield from under("map", attrs.get("map", "").splitlines())
    yield from describe_pull_off(result, _NOT_KNOWN)
    yield from _avalanches(result)
    yield from _contacts_at_ends(result)
    yield from trust_of_result(result)
    yield from under("sample", sample_of_result(result).splitlines())
    yield from contact_pressure_lines(result)
    yield from conduction_lines(result)
    for noted in [stage.noted for stage in STAGES if stage.noted in attrs]:
        yield from under(noted, attrs[noted].splitlines())
    yield from under("advice", advice_on(attrs["scene"], result.largest("resolution_error")).splitlines())
    yield from (line for stage in STAGES for line in stage.result_lines(result))
    yield from _adhesion(result)
    yield from under("accuracy", attrs.get("accuracy", "").splitlines())
    yield from under("failed", describe_failed(result).splitlines())
    yield from under("warning", attrs.get("warnings", "").splitlines())
    yield _numerical_error(result)
    yield "run time", time


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


def counted(swept: dict[str, int], realizations: int, steps: int) -> str:
    """Return the numbers of swept values, realisations and steps, as factors."""
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


@named_keywords
def info(result: "str | Path | xr.Dataset", *, cells: bool = False) -> str:
    """Return the text that ``roughmdr info`` prints of a result; nothing is printed.

    Parameters
    ----------
    result : path or xarray.Dataset
        A result file, or what ``run`` returned; of a fit, what ``fit`` did.
    cells : bool, optional
        Whether to list the cells of the sweep instead: status, time, errors and remarks.

    Returns
    -------
    str
        Lines with sizes, forces, errors, run time, seed, versions and the scene; of a fit its parameters.

    Raises
    ------
    StoreError
        Where there is no such file, or no result in it.

    Examples
    --------
    >>> import roughmdr as rm
    >>> result = rm.run({
    ...     "title": "One patch", "material": {"effective_modulus": "1 GPa"}, "path": {"separation": ["3 um", "2 um"]},
    ...     "asperities": {
    ...         "source": "random", "shape": "paraboloid", "count": 500, "patch": "1 mm", "radius": "50 um",
    ...         "height": {"distribution": "normal", "std": "1 um"},
    ...     },
    ... })
    >>> print(rm.info(result).splitlines()[0])
    computed     One patch: 1 realisation x 2 steps
    """
    fit = given_fit(result)
    return describe_fit(fit) if fit is not None else describe(*given_result(result), cells=cells)


def describe(result: ResultView, file: Path | None, *, cells: bool) -> str:
    """Return that text of a result that was read, from ``file`` unless that is None."""
    if cells:
        return describe_cells(result)
    return f"{describe_result(result)}\n{describe_origin(result, None if file is None else size_of(file))}"

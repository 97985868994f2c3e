"""A result as a table for --json."""

from collections.abc import Mapping
from pathlib import Path
from typing import cast

import numpy as np

from roughmdr.model_error.parts import ALL_PARTS
from roughmdr.report.advice import advice_on
from roughmdr.report.contacts import sample_of_result
from roughmdr.report.documents import CellTable, CoordinateTable, PullOffTable, ResultTable, paragraphs, trust_table
from roughmdr.report.summary import describe_failed, first_remark
from roughmdr.result.model_errors import largest_of_result
from roughmdr.result.trust import trust_of_result
from roughmdr.result.view import ResultView, swept_values
from roughmdr.stages import STAGES
from roughmdr.storage.files import size_of
from roughmdr.storage.labelled import Array
from roughmdr.variables import RUN_DIAGNOSTICS, STATUSES, YIELDED, YIELDING


def result_table(result: ResultView, file: Path | None, elapsed: float | None = None) -> ResultTable:
    """Return all that ``describe_result`` tells, as numbers; ``elapsed`` [s] is the time of the whole run."""
    attrs, sizes = result.attrs, result.sweep
    table: ResultTable = {
        "title": attrs["title"],
        "file": None if file is None else str(file),
        "file_size": None if file is None else size_of(file),
        "sizes": sizes,
        "coordinates": coordinate_tables(result.coordinates, sizes),
        "realizations": result.realizations,
        "steps": result.sizes["step"],
        "control": result.control,
        "variables": result.curves,
        "cells": [_cell(result, number, cell) for number, cell in enumerate(result.cells)],
        "path": attrs.get("path", "").splitlines(),
        "lattice": attrs.get("lattice", "").splitlines(),
        "map": attrs.get("map", "").splitlines(),
        "trust": trust_table(trust_of_result(result)),
        "sample": sample_of_result(result) or None,
        "advice": advice_on(attrs["scene"], result.largest("resolution_error")) or None,
        "reference": None,
        "accuracy": attrs.get("accuracy") or None,
        "failed": describe_failed(result) or None,
        "warnings": attrs.get("warnings", "").splitlines(),
        "left_out": attrs["left_out"].splitlines(),
        "run_time": float(np.nansum(result.variables["run_time"].values)),
        "elapsed": elapsed,
        "seed": int(attrs["seed"]),
        "versions": {"source": attrs["source"], "packages": attrs["packages"], "numbers": attrs.get("versions", "")},
        "history": attrs["history"].splitlines(),
        "scene": attrs["scene"],
    }
    return cast("ResultTable", table | paragraphs(line for stage in STAGES for line in stage.result_lines(result)))


def coordinate_tables(coordinates: Mapping[str, Array], sizes: dict[str, int]) -> dict[str, CoordinateTable]:
    """Return the coordinates of the swept keys."""
    return {
        name: {"units": coordinates[name].attrs.get("units", ""), "values": coordinates[name].values.tolist()}
        for name in swept_values(coordinates, list(sizes), (0,) * len(sizes))
    }


def swept_table(coordinates: Mapping[str, Array], sizes: dict[str, int], number: int) -> dict[str, float | str]:
    """Return the values of the swept keys in the cell of this number."""
    cell = tuple(map(int, np.unravel_index(number, tuple(sizes.values()))))
    return {name: array.values.item() for name, array in swept_values(coordinates, list(sizes), cell).items()}


def _cell(result: ResultView, number: int, cell: tuple[int, ...]) -> CellTable:
    def values(name: str) -> np.ndarray:
        return np.atleast_1d(result.variables[name].values[cell]) if name in result.variables else np.array([np.nan])

    def largest(name: str) -> float:
        return float(np.fmax.reduce(values(name)))

    yielding = [*YIELDING, *(name for name in YIELDED if name in result.variables)]
    status, counts = values("status"), values("realization_count")
    method = result.method(cell)
    return {
        "swept": swept_table(result.coordinates, result.sweep, number),
        "realizations": status.size if np.isnan(counts).any() else int(counts[0]),
        "status": {name: int((status == code).sum()) for code, name in enumerate(STATUSES)},
        "remark": first_remark(result, cell),
        "pull_off": _pull_off(result, cell),
        "model_error": largest("model_error"),
        "parts": {name: largest(name) for name in ALL_PARTS if name in result.variables},
        "at_given_pressure": largest_of_result(result, cell),
        "largest_contact_fraction": largest("largest_contact_fraction"),
        "effective_contacts": float(np.fmin.reduce(values("effective_contacts"))),
        "sampling_error": largest("sampling_error"),
        "area_sampling_error": largest("area_sampling_error"),
        "trusted_separation": largest("trusted_separation"),
        "yielding": {name: float(getattr(np, RUN_DIAGNOSTICS[name].merge).reduce(values(name))) for name in yielding},
        "numerical_error": largest("numerical_error"),
        "run_time": float(np.nansum(values("run_time"))),
        "accuracy": {"reached": largest("accuracy_reached"), "method": method} if method else None,
    }


def _pull_off(result: ResultView, cell: tuple[int, ...]) -> PullOffTable | None:
    """Return the pull-off of a cell; None where no realisation has one."""
    if "pull_off_count" not in result.variables or not (count := int(result.pull_off_counts[cell])):
        return None

    def mean(name: str, statistic: int = 0) -> float:
        return float(result.mean(name)[statistic][cell]) if result.holds(name) else np.nan

    return {
        "count": count,
        "force": mean("pull_off_force"),
        "standard_error": mean("pull_off_force", 1),
        "of_mean": float(result.variables["pull_off_force_of_mean"].values[cell]),
        "separation": mean("pull_off_separation"),
        "pressure": mean("pull_off_pressure"),
        "contacts": mean("pull_off_contacts"),
        "contact_fraction": mean("pull_off_contact_fraction"),
    }

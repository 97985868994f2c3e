"""Validation of a result when it is read, so that no other code has to check its content.

Anyone may have changed the file. A result may hold more than is declared; declared arrays must have their form.
"""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from roughmdr.storage.labelled import Labelled, is_text
from roughmdr.storage.result_form import (
    attribute_faults,
    companions,
    control_forms,
    forms_of,
    refuse,
    statistics_of,
    with_units,
)
from roughmdr.storage.result_scene import scene_faults
from roughmdr.variables import (
    AUXILIARY_COORDINATES,
    BRANCHES,
    DONE,
    FAILED,
    LAW_VARIABLES,
    NOT_RUN,
    OUTPUT_VARIABLES,
    PULL_OFF,
    PULL_OFF_NUMBERS,
    PULL_OFF_PER_AREA,
    REFERENCE_VARIABLES,
    RESULT_ATTRIBUTES,
    RUN_DIAGNOSTICS,
    RUN_VARIABLES,
    SAMPLE,
    STEP_COORDINATES,
)

_REQUIRED_VARIABLES = ("status", "run_time", "numerical_error")
_COUNTS = ("realization_count", "pull_off_count")
_CODES = ("adhesion_law", "accuracy_method", "asperity_origin")
_OF_GRIDS = ("reference_error", "reference_area_error")
_KNOWN_TOGETHER = {
    "largest_contact_fraction": [name for name in RUN_DIAGNOSTICS if name.endswith("_error") and name not in SAMPLE],
    "avalanche_count": ["avalanche_size_max"],
    **{name: [*_OF_GRIDS] for name in REFERENCE_VARIABLES},
    **{f"{name}_mean": [f"{each}_mean" for each in _OF_GRIDS] for name in REFERENCE_VARIABLES},
}
"""Variables that are known where another is."""
_LARGEST = 1e150  # magnitude of a variable of a law in SI: products of larger ones overflow
_NOT_NEGATIVE = {
    *(name for name, declared in (PULL_OFF | RUN_VARIABLES).items() if declared.units in ("1", "m2", "s")),
    *(name for name in LAW_VARIABLES if name.endswith(("_count", "_error", "_error_curve")) or name == "time"),
}
"""Diagnostics of runs, and errors, counts and times of laws; the difference of two laws may have negative areas."""
_ROUNDING = 1e-9  # share of the largest magnitude by which a sum may be off its bounds


def as_result(data: Labelled, file: Path | None = None) -> Labelled:
    """Return arrays, of a file or not, as a result, with the declared units where they have none; StoreError if they
    are none.
    """
    checks = (_missing, _attributes, _dimensions, _arrays, _companions, _values)
    refuse((fault for check in checks for fault in check(data)), "run", "result", file)
    return with_units(data, forms_of(data.variables["status"].dims) | control_forms(data))


def _missing(data: Labelled) -> Iterator[str]:
    required = ((("branch",), data.coordinates), (_REQUIRED_VARIABLES, data.variables))
    if missing := [name for names, present in required for name in names if name not in present]:
        yield f"it has no {', '.join(missing)}"
    if not any(name in data.coordinates for name in STEP_COORDINATES):
        yield f"it has none of {', '.join(STEP_COORDINATES)} as a coordinate"


def _attributes(data: Labelled) -> Iterator[str]:
    yield from attribute_faults(data.attrs, RESULT_ATTRIBUTES)
    yield from scene_faults(data.attrs["scene"])
    if data.attrs.get("interaction") == "pairwise" and "grid_points" not in data.variables:
        yield "its interaction is pairwise, and it has no grid_points"


def _dimensions(data: Labelled) -> Iterator[str]:
    if not all(data.sizes.values()):
        yield "a dimension has no length"
    runs = data.variables["status"].dims
    if "step" in runs or "realization" in runs[:-1] or len(set(runs)) < len(runs):
        yield f"status has the dimensions {', '.join(runs)}; it must have the swept keys, each once, and realization"
    if "realization" in data.sizes and "realization" not in runs:
        yield "status lacks the dimension realization"
    if "realization" not in data.sizes and "realization_count" not in data.variables:
        yield "it has neither a dimension realization nor a realization_count"


def _arrays(data: Labelled) -> Iterator[str]:
    """Find arrays of the wrong type, unit or dimensions."""
    for name, form in forms_of(data.variables["status"].dims).items():
        holder = data.coordinates if form.kind == "text" else data.variables
        if name in holder:
            yield from form.mismatches(name, holder[name])
    for name, form in control_forms(data).items():
        yield from form.mismatches(name, data.coordinates[name])
    for name, array in data.coordinates.items():
        if name not in AUXILIARY_COORDINATES and not is_text(array.attrs.get("units", "")):
            yield f"the units of {name} are no text"


def _companions(data: Labelled) -> Iterator[str]:
    """Find arrays that lack others; at least one curve is needed."""
    for alike in companions(data):
        here = [name for name in alike if name in data.variables]
        if 0 < len(here) < len(alike):
            yield f"it has {here[0]} but no {', '.join(name for name in alike if name not in here)}"
    elements = [each for name in REFERENCE_VARIABLES for each in (name, f"{name}_mean") if each in data.variables]
    if elements and not (
        "reference_points" in data.variables and any(each.startswith("reference_error") for each in elements)
    ):
        yield f"it has {elements[0]}, and no reference_error or no reference_points"
    if (data.variables["status"].values == FAILED).any() and "remark" not in data.coordinates:
        yield "runs failed, and no remark says why"
    curves = {each for name in LAW_VARIABLES for each in (name, *statistics_of(name))}
    if curves.isdisjoint(data.variables):
        yield f"it has none of {', '.join(OUTPUT_VARIABLES)}"


def _values(data: Labelled) -> Iterator[str]:
    """Find values that no run writes, in arrays that are known to have the right types and dimensions."""
    if not np.isin(data.variables["status"].values, (DONE, FAILED, NOT_RUN)).all():
        yield f"status must be {DONE}, {FAILED} or {NOT_RUN}"
    if not np.isin(data.coordinates["branch"].values, BRANCHES).all():
        yield f"branch must be {' or '.join(BRANCHES)}"
    for name, array in data.coordinates.items():
        if array.values.dtype.kind == "f" and not np.isfinite(array.values).all():
            yield f"{name} is not finite"
    yield from _computed(data)
    yield from _magnitudes(data)
    yield from _statistics(data)
    yield from _pull_offs(data)
    for name in _CODES:
        if name in data.variables:
            array = data.variables[name]
            meanings = array.attrs.get("flag_meanings")
            if not is_text(meanings):
                yield f"{name} has no flag_meanings"
            elif not ((array.values >= 0) & (array.values < len(str(meanings).split()))).all():
                yield f"{name} has a value that is none of its flags"


def _computed(data: Labelled) -> Iterator[str]:
    """Find numbers that are not known although they were computed; marked steps may have no value."""
    status = data.variables["status"].values
    marked = data.variables["marked_steps"].values if "marked_steps" in data.variables else np.zeros_like(status)
    whole = (status == DONE) & (marked == 0.0)
    diagnostics = ("run_time", "numerical_error", "reference_points")
    for name in (*diagnostics, *OUTPUT_VARIABLES, *(f"{name}_mean" for name in OUTPUT_VARIABLES)):
        if name in data.variables and not _finite(data.variables[name].values, whole):
            yield f"{name} is not finite, and status says that it was computed"
    for name, others in _KNOWN_TOGETHER.items():
        if name in data.variables:
            array = data.variables[name]
            done = (status == DONE)[..., None] if array.dims[-1:] == ("step",) else status == DONE
            known = np.isfinite(array.values) & done
            for other in others:
                if other in data.variables and not np.isfinite(data.variables[other].values[known]).all():
                    yield f"{other} is not finite where {name} is known"


def _finite(values: NDArray[Any], runs: NDArray[np.bool_]) -> bool:
    """Return whether all numbers of some runs are finite, without a copy of those over the steps."""
    ends = (values.min(axis=-1), values.max(axis=-1)) if values.ndim > runs.ndim else (values,)
    return all(bool(np.isfinite(each[runs]).all()) for each in ends)


def _pull_offs(data: Labelled) -> Iterator[str]:
    """Find statistics of pull-offs where no realisation has one, or none where some have."""
    if "pull_off_count" in data.variables and "pull_off_force_mean" in data.variables:
        having = data.variables["pull_off_count"].values > 0.0
        if not (having == np.isfinite(data.variables["pull_off_force_mean"].values)).all():
            yield "pull_off_count is not that of pull_off_force_mean"


def _magnitudes(data: Labelled) -> Iterator[str]:
    """Find numbers that are too large, and negative ones in variables that cannot be negative."""
    for name in (*LAW_VARIABLES, *PULL_OFF, *RUN_VARIABLES):
        for each in [held for held in (name, *statistics_of(name)) if held in data.variables]:
            values = data.variables[each].values
            if values.dtype.kind != "f":
                continue
            least = float(np.fmin.reduce(values, axis=None, initial=0.0))
            largest = max(-least, float(np.fmax.reduce(values, axis=None, initial=0.0)))
            if largest > _LARGEST:
                yield f"{each} is above {_LARGEST:g} in SI"
            if name in _NOT_NEGATIVE and least < -_ROUNDING * largest:
                yield f"{each} must be at least 0"
    for name in [name for name in _COUNTS if name in data.variables]:
        if not np.isfinite(data.variables[name].values).all():
            yield f"{name} must be at least 0, and finite"


def _statistics(data: Labelled) -> Iterator[str]:
    """Find means that do not lie between the least and the greatest, and standard errors below 0."""
    for name in (*LAW_VARIABLES, *PULL_OFF_NUMBERS, *PULL_OFF_PER_AREA):
        if f"{name}_mean" in data.variables:
            mean, error, least, greatest = (data.variables[each].values for each in statistics_of(name))
            slack = _ROUNDING * np.fmax(np.abs(least), np.abs(greatest))
            if ((mean < least - slack) | (mean > greatest + slack)).any():
                yield f"{name}_mean does not lie between {name}_min and {name}_max"
            if (error < 0.0).any():
                yield f"{name}_sem must be at least 0"

"""Validation of a result when it is read, so that no other code has to check its content.

Anyone may have changed the file. A result may hold more than is declared; declared arrays must have their form.
"""

from collections.abc import Iterator
from pathlib import Path

from roughmdr.storage.labelled import Labelled
from roughmdr.storage.result_form import (
    attribute_faults,
    companions,
    control_forms,
    forms_of,
    is_text,
    refuse,
    statistics_of,
    with_units,
)
from roughmdr.storage.result_scene import scene_faults
from roughmdr.storage.result_values import value_faults
from roughmdr.variables import (
    AUXILIARY_COORDINATES,
    FAILED,
    LAW_VARIABLES,
    OUTPUT_VARIABLES,
    REFERENCE_VARIABLES,
    RESULT_ATTRIBUTES,
    STEP_COORDINATES,
)

_REQUIRED_VARIABLES = ("status", "run_time", "numerical_error")


def as_result(data: Labelled, file: Path | None = None) -> Labelled:
    """Return arrays, of a file or not, as a result, with the declared units where they have none; StoreError if they
    are none.
    """
    checks = (_missing, _attributes, _dimensions, _arrays, _companions, value_faults)
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

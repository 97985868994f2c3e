"""Assembles the result of a batch: its variables, coordinates and the attributes on its origin."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from roughmdr.asperity.validity import ValidityLimits
from roughmdr.batch.collect import CollectedResults
from roughmdr.batch.derivatives import derivatives_of
from roughmdr.batch.plan import Plan
from roughmdr.batch.resume.keys import versions
from roughmdr.batch.rounds import CellMethod
from roughmdr.model_error.at_given import FORCES
from roughmdr.model_error.coupling import coupling_warnings
from roughmdr.model_error.refusal import fraction_warnings
from roughmdr.numerics.arguments import Floats
from roughmdr.result.accuracy import reached
from roughmdr.result.model_errors import errors_along
from roughmdr.result.pull_off import pull_off_numbers
from roughmdr.result.view import ResultView
from roughmdr.schema.wording import merged
from roughmdr.storage.labelled import Array, Labelled
from roughmdr.storage.result_file import provenance
from roughmdr.variables import (
    ADHESION_CODES,
    DONE,
    ESTIMATORS,
    FAILED,
    INFINITE_VARIANCE,
    LAW_VARIABLES,
    RUN_DIAGNOSTICS,
    RUN_VARIABLES,
    STATISTICS,
    TRAVEL,
    Variable,
)

_REFERENCES = (
    "M. Hess, On the reduction method of dimensionality: the exact mapping of axisymmetric contact problems "
    "with and without adhesion (2012)"
)


def assemble(
    plan: Plan, methods: Sequence[CellMethod], collected: CollectedResults, variables: Sequence[str], command: str
) -> Labelled:
    """Return the result from the collected ``variables``; ``methods`` are those of each cell."""
    scene, diagnostics = plan.scene, collected.diagnostics
    swept, sizes = tuple(plan.sizes), tuple(plan.sizes.values())
    runs = swept if plan.keeps_statistics else (*swept, "realization")
    data, coordinates = _curves(plan, collected.values, variables, runs), plan.coordinates()

    if plan.unloads:
        # The mean over realisations at equal travel, each at a separation of its own, has no pull-off.
        with_mean = "force" in variables and plan.control != TRAVEL.name
        force = list(variables).index("force") if with_mean else None
        data |= pull_off_numbers(plan, methods, collected, force)

    def of_cells(name: str, values: list[Any]) -> Array:
        return _array(
            RUN_VARIABLES[name], swept, np.array(values, dtype=object if name == "cell_key" else None).reshape(sizes)
        )

    if plan.keeps_statistics or scene.accuracy is not None:
        data["realization_count"] = of_cells("realization_count", [float(each.realizations) for each in methods])
    areas = [cell.scene.nominal_area for cell in plan.cells]
    if not any(area is None for area in areas):
        data["nominal_area"] = of_cells("nominal_area", areas)
    coordinates["cell_key"] = of_cells("cell_key", [each.key for each in methods])
    for name, declared in RUN_DIAGNOSTICS.items():
        array = _array(declared, runs, diagnostics[name].reshape((*sizes, *diagnostics[name].shape[1:])))
        if declared.dtype is str:  # texts are coordinates, so that one can calculate with the variables
            coordinates |= {name: array} if (array.values != "").any() else {}
        elif any(declared.in_result(cell.scene) for cell in plan.cells):
            data[name] = array
    warnings = _warnings(plan, diagnostics)
    attrs: dict[str, Any] = {
        "references": _REFERENCES,
        "seed": scene.seed,
        "scene": scene.toml,
        "left_out": "\n".join(plan.left_out),
        "versions": versions(),
    }
    if scene.interaction is not None:
        attrs["interaction"] = scene.interaction.model
    for stage in scene.stages:
        attrs |= stage.attributes()
    notes = {"path": plan.path_notes, "lattice": plan.lattice_lines, "map": plan.map_lines}
    attrs |= {name: "\n".join(lines) for name, lines in {**notes, **plan.stage_notes}.items() if lines}
    result = Labelled(data, coordinates, {**provenance(scene.title, command), **attrs})
    if scene.accuracy is not None:
        failed = (diagnostics["status"].reshape(len(methods), -1) == FAILED).any(axis=1)
        errors, result.attrs["accuracy"], more = reached(plan, methods, ResultView(result), failed)
        data["accuracy_reached"] = of_cells("accuracy_reached", errors)
        data["accuracy_method"] = of_cells("accuracy_method", [ESTIMATORS.index(each.estimator) for each in methods])
        warnings += more
    if scene.output.derivatives:
        derivatives, parameters, more = derivatives_of(plan)
        data |= derivatives
        coordinates |= parameters
        warnings += more
    if warnings:
        result.attrs["warnings"] = "\n".join(warnings)
    if plan.control in FORCES:
        data |= errors_along(ResultView(result))
    return result._replace(attrs={**result.attrs, "checksum": result.checksum()})


def curves_so_far(plan: Plan, collected: CollectedResults, variables: Sequence[str]) -> Labelled:
    """Return what is known of a result while its curves are computed: they, with the coordinates."""
    curves = _curves(plan, collected.values, variables, (*plan.sizes, "realization"))
    return Labelled(curves, plan.coordinates(), {"title": plan.scene.title})


def _curves(
    plan: Plan, collected: dict[str, Floats], variables: Sequence[str], runs: tuple[str, ...]
) -> dict[str, Array]:
    """Return the variables that were asked for: ``NAME`` over runs and steps, or ``NAME_mean`` and so on over cells.

    NaN stands for a standard error that is not computed: that of a single realisation, and of the stiffness where
    contacts may be at the point of detachment, since its variance is infinite.
    """
    # Behind a machine the stiffness of contacts is bounded below, by minus that of the machine.
    at_detachment = np.array([cell.path.at_detachment() & cell.controlled.rigid for cell in plan.cells])
    data: dict[str, Array] = {}
    for name in plan.variables:
        variable, number = LAW_VARIABLES[name], list(variables).index(name)
        for statistic, array in collected.items():
            values, attrs = array[..., number, :], variable.attrs
            if statistic in STATISTICS:
                attrs["long_name"] = f"{STATISTICS[statistic]} of {variable.long_name}"
            if statistic == "mean":
                attrs["ancillary_variables"] = f"{name}_sem"
            if (name, statistic) == ("stiffness", "sem") and at_detachment.any():
                values[at_detachment] = math.nan
                attrs["comment"] = INFINITE_VARIANCE
            key = f"{name}_{statistic}" if statistic in STATISTICS else name
            data[key] = Array((*runs, "step"), values.reshape((*plan.sizes.values(), *values.shape[1:])), attrs)
    return data


def _array(variable: Variable, dims: tuple[str, ...], values: NDArray[Any]) -> Array:
    """Return values with the attributes of a variable: texts have no units, and codes have flags in place of them."""
    if variable.codes:
        meanings = " ".join(variable.codes)
        flags = {"flag_values": np.arange(len(variable.codes), dtype=np.int8), "flag_meanings": meanings}
        return Array(dims, values.astype(np.int8), {"long_name": variable.long_name, **flags})
    return Array(dims, values, variable.attrs if variable.units else {"long_name": variable.long_name})


def _warnings(plan: Plan, diagnostics: dict[str, NDArray[Any]]) -> list[str]:
    """Return warnings of numbers that are doubtful: because of the scene, its ensembles, or the largest contacts."""
    done = diagnostics["status"] == DONE
    diagnostics = {name: column[done] for name, column in diagnostics.items()}
    remarks = [line for text in diagnostics["remark"] for line in text.split("\n") if line]
    warnings = [*plan.warnings, *merged(remarks)]
    if not done.any():
        return warnings
    jkr = diagnostics["adhesion_law"] == ADHESION_CODES.index("jkr")
    tabor = float(np.fmin.reduce(diagnostics["tabor_number"][jkr], initial=math.inf))
    slope, extent = (float(diagnostics[name].max()) for name in ("edge_slope", "profile_extent"))
    fraction = diagnostics["largest_contact_fraction"]
    coupled, on_grid = np.isfinite(diagnostics["overlap_count"]), diagnostics["grid_points"] > 0.0
    warnings += ValidityLimits(slope, extent, tabor).warnings
    warnings += fraction_warnings(float(np.fmax.reduce(fraction[~coupled], initial=0.0)))
    numbers = (fraction, diagnostics["overlap_fraction"], diagnostics["marked_steps"])
    for runs, grid in ((coupled & ~on_grid, False), (on_grid, True)):
        largest = (float(np.fmax.reduce(each[runs], initial=0.0)) for each in numbers)
        area = "the nominal area" if plan.scene.flat else "the area that they crowd on"
        warnings += coupling_warnings(*largest, on_grid=grid, area=area)
    return warnings

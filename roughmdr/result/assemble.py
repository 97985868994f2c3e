"""What a batch found out, put together: variables, coordinates and the attributes that say where it comes from."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from roughmdr.asperity.validity import ValidityLimits
from roughmdr.batch.collect import CollectedResults
from roughmdr.batch.plan import Plan
from roughmdr.batch.resume.keys import versions
from roughmdr.batch.rounds import CellMethod
from roughmdr.result.statistics import summarise
from roughmdr.scene.sections import Accuracy
from roughmdr.storage.labelled import Array, Labelled
from roughmdr.storage.store import provenance
from roughmdr.variables import (
    ADHESION_CODES,
    CURVE_VARIABLES,
    DONE,
    ESTIMATORS,
    FAILED,
    RUN_DIAGNOSTICS,
    RUN_VARIABLES,
    Variable,
)

_REFERENCES = (
    "M. Hess, On the reduction method of dimensionality: the exact mapping of axisymmetric contact problems "
    "with and without adhesion (2012)"
)
_MOSTLY_MET = 0.9  # of an error, what the draws alone show, where nothing need be said of what they have not met


def assemble(
    plan: Plan, choices: Sequence[CellMethod], found: CollectedResults, variables: Sequence[str], command: str
) -> Labelled:
    """The result, from all that was found in ``variables``; ``choices`` tell how each cell was computed."""
    scene = plan.scene
    swept = tuple(plan.sizes)
    statistics = scene.output.keep == "statistics"
    cells = tuple(plan.sizes.values())
    dims = swept if statistics else (*swept, "realization")
    shape = cells if statistics else (*cells, found.values.shape[1])
    snaps = np.array([cell.path.snaps() for cell in plan.cells])
    data: dict[str, Array] = {}
    for name in scene.output.variables:
        row = list(variables).index(name)
        if statistics:
            of_variable, sem = found.moments.select(np.s_[:, row]), found.sem[:, row]
            over = summarise(name, (*dims, "step"), of_variable, sem, snaps)
            data |= {key: array._replace(values=array.values.reshape(*cells, -1)) for key, array in over.items()}
        else:
            data[name] = Array(
                (*dims, "step"), found.values[:, :, row].reshape(*shape, -1), CURVE_VARIABLES[name].attrs
            )
    if statistics or scene.accuracy is not None:
        count = np.array([choice.realizations for choice in choices], dtype=float).reshape(cells)
        data["realization_count"] = Array(swept, count, RUN_VARIABLES["realization_count"].attrs)
    for declared in RUN_DIAGNOSTICS.values():
        if declared.dtype is not str and any(declared.in_result(cell.scene) for cell in plan.cells):
            data[declared.name] = _array(declared, dims, found.diagnostics[declared.name].reshape(shape))
    # Texts are coordinates, so that one can calculate with the variables.
    keys = np.array([choice.key for choice in choices], dtype=object).reshape(cells)
    coordinates = {**plan.coordinates(), "cell_key": _array(RUN_VARIABLES["cell_key"], swept, keys)}
    for declared in RUN_DIAGNOSTICS.values():
        texts = found.diagnostics[declared.name].reshape(shape)
        if declared.dtype is str and (texts != "").any():
            coordinates[declared.name] = _array(declared, dims, texts)
    attrs: dict[str, Any] = {
        "references": _REFERENCES,
        "seed": scene.seed,
        "scene": scene.toml,
        "left_out": "\n".join(plan.left_out),
        "versions": versions(),
    }
    warnings = _warnings(plan, found)
    if scene.accuracy is not None:
        data |= _reached(swept, cells, choices)
        attrs["accuracy"] = _in_words(scene.accuracy, choices)
        failed = (found.diagnostics["status"].reshape(len(choices), -1) == FAILED).any(axis=1)
        warnings += _missed(scene.accuracy, choices, failed)
    if warnings:
        attrs["warnings"] = "\n".join(warnings)
    result = Labelled(data, coordinates, {**provenance(scene.title, command), **attrs})
    return result._replace(attrs={**result.attrs, "checksum": result.checksum()})


def _array(variable: Variable, dims: tuple[str, ...], values: NDArray[Any]) -> Array:
    """Return values with the attributes of a variable: texts have no units, and codes have flags in place of them."""
    if variable.codes:
        flags = {
            "flag_values": np.arange(len(variable.codes), dtype=np.int8),
            "flag_meanings": " ".join(variable.codes),
        }
        return Array(dims, values.astype(np.int8), {"long_name": variable.long_name, **flags})
    return Array(dims, values, variable.attrs if variable.units else {"long_name": variable.long_name})


def _warnings(plan: Plan, found: CollectedResults) -> list[str]:
    """Return warnings of numbers that are doubtful: because of the scene, its ensembles, or the largest contacts."""
    done = found.diagnostics["status"] == DONE
    diagnostics = {name: column[done] for name, column in found.diagnostics.items()}
    remarks = [line for text in diagnostics["remark"] for line in text.split("\n") if line]
    warnings = [*plan.doubts, *dict.fromkeys(remarks)]
    if not done.any():
        return warnings
    jkr = diagnostics["adhesion_law"] == ADHESION_CODES.index("jkr")
    tabor = float(np.fmin.reduce(diagnostics["tabor_number"][jkr], initial=math.inf))
    slope, extent = (float(diagnostics[name].max()) for name in ("edge_slope", "profile_extent"))
    return [*warnings, *ValidityLimits(slope, extent, tabor).warnings]


def _reached(swept: tuple[str, ...], cells: tuple[int, ...], choices: Sequence[CellMethod]) -> dict[str, Array]:
    """Which error each cell came to, and by which method."""
    error = np.array([choice.error for choice in choices]).reshape(cells)
    method = np.array([ESTIMATORS.index(choice.estimator) for choice in choices]).reshape(cells)
    return {
        "accuracy_reached": _array(RUN_VARIABLES["accuracy_reached"], swept, error),
        "accuracy_method": _array(RUN_VARIABLES["accuracy_method"], swept, method),
    }


def _in_words(accuracy: Accuracy, choices: Sequence[CellMethod]) -> str:
    """The error asked for, what it took, and where the expected law was used."""
    known = [choice for choice in choices if not math.isnan(choice.error)]
    drawn = [choice.realizations for choice in known if choice.estimator != "expected"]
    parts = [f"asked {accuracy.relative:g} of the largest mean force"]
    if known:
        parts.append(f"reached {max(choice.error for choice in known):.2g} in {len(known)} of {len(choices)} cells")
    if drawn:
        few, many = min(drawn), max(drawn)
        parts.append(f"{few if few == many else f'{few} to {many}'} realisations in {len(drawn)} of them")
    if len(drawn) < len(known):
        parts.append(f"the expected law, which has no noise, in {len(known) - len(drawn)} of them")
    return "; ".join(parts)


def _missed(accuracy: Accuracy, choices: Sequence[CellMethod], failed: NDArray[np.bool_]) -> list[str]:
    """What to say of cells that did not reach the error; those that failed say so themselves."""
    said = []
    missed = [choice for choice in choices if choice.error > accuracy.relative]
    if missed:
        why = (
            "the expected law is not right enough, with accuracy.method 'auto' or 'sampled' more is drawn instead"
            if accuracy.method == "expected"
            else f"accuracy.max_realizations, {accuracy.max_realizations}, is too low"
        )
        said.append(
            f"the error asked for, {accuracy.relative:g}, was not reached in {len(missed)} of {len(choices)} cells "
            f"(up to {max(choice.error for choice in missed):.2g}): {why}"
        )
    rare = [choice for choice in missed if choice.met < _MOSTLY_MET * choice.error]
    if rare:
        said.append(
            f"in {len(rare)} of {len(choices)} cells asperities too rare to be met by so many draws may bear much of "
            f"the force: without them the error would seem to be {max(choice.met for choice in rare):.2g}"
        )
    without = [choice for choice, fails in zip(choices, failed, strict=True) if math.isnan(choice.error) and not fails]
    if without:
        said.append(
            f"in {len(without)} of {len(choices)} cells none of {without[0].realizations} realisations had any force: "
            "the error of the mean is not known"
        )
    return said

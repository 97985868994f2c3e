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
from roughmdr.storage.result_file import provenance
from roughmdr.variables import ADHESION_CODES, CURVE_VARIABLES, DONE, FAILED, RUN_VARIABLES, STATUSES

_REFERENCES = (
    "M. Hess, On the reduction method of dimensionality: the exact mapping of axisymmetric contact problems "
    "with and without adhesion (2012)"
)
_ESTIMATORS = ("sampled", "stratified", "expected")
_MOSTLY_MET = 0.9  # of an error, what the draws alone show, where nothing need be said of what they have not met
_ALWAYS = ("run_time", "numerical_error", "edge_slope", "profile_extent")


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
            of_variable, sem = found.tally.picked(np.s_[:, row]), found.sem[:, row]
            over = summarise(name, (*dims, "step"), of_variable, sem, snaps)
            data |= {key: array._replace(values=array.values.reshape(*cells, -1)) for key, array in over.items()}
        else:
            data[name] = Array(
                (*dims, "step"), found.values[:, :, row].reshape(*shape, -1), CURVE_VARIABLES[name].attrs
            )
    if statistics or scene.accuracy is not None:
        count = np.array([choice.realizations for choice in choices], dtype=float).reshape(cells)
        data["realization_count"] = Array(swept, count, RUN_VARIABLES["realization_count"].attrs)
    done = found.beside["status"] == DONE
    extremes = {"edge_slope": found.beside["slope"], "profile_extent": found.beside["extent"]}
    beside = found.beside | {name: np.where(done, values, np.nan) for name, values in extremes.items()}
    for name in _ALWAYS:
        data[name] = Array(dims, beside[name].reshape(shape), RUN_VARIABLES[name].attrs)
    data["status"] = _flags("status", dims, beside["status"].reshape(shape), STATUSES)
    if any(cell.scene.adhesion_model.tabor_known for cell in plan.cells):
        tabor = np.where(np.isfinite(beside["tabor"]), beside["tabor"], np.nan)
        data["tabor_number"] = Array(dims, tabor.reshape(shape), RUN_VARIABLES["tabor_number"].attrs)
        data["adhesion_law"] = _flags("adhesion_law", dims, beside["law"].reshape(shape), ADHESION_CODES)
    # Texts are coordinates, so that one can reckon with the rest.
    keys = np.array([choice.key for choice in choices], dtype=object).reshape(cells)
    coordinates = {
        **plan.coordinates(),
        "cell_key": Array(swept, keys, {"long_name": RUN_VARIABLES["cell_key"].long_name}),
    }
    if (beside["remark"] != "").any():
        remarks = beside["remark"].reshape(shape)
        coordinates["remark"] = Array(dims, remarks, {"long_name": RUN_VARIABLES["remark"].long_name})
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
        failed = (beside["status"].reshape(len(choices), -1) == FAILED).any(axis=1)
        warnings += _missed(scene.accuracy, choices, failed)
    if warnings:
        attrs["warnings"] = "\n".join(warnings)
    result = Labelled(data, coordinates, {**provenance(scene.title, command), **attrs})
    return result._replace(attrs={**result.attrs, "checksum": result.checksum()})


def _flags(name: str, dims: tuple[str, ...], values: NDArray[Any], meanings: tuple[str, ...]) -> Array:
    flags = {"flag_values": np.arange(len(meanings), dtype=np.int8), "flag_meanings": " ".join(meanings)}
    return Array(dims, values.astype(np.int8), {"long_name": RUN_VARIABLES[name].long_name, **flags})


def _warnings(plan: Plan, found: CollectedResults) -> list[str]:
    """Warn of numbers that are doubtful: for the scene, for the ensembles, or for the most that contacts come to."""
    beside = found.beside
    done = beside["status"] == DONE
    said = [
        *plan.warnings,
        *dict.fromkeys(line for text in beside["remark"][done] for line in text.split("\n") if line),
    ]
    if not done.any():
        return said
    jkr = done & (beside["law"] == ADHESION_CODES.index("jkr"))
    tabor = float(np.min(beside["tabor"][jkr])) if jkr.any() else math.inf
    return [
        *said,
        *ValidityLimits(float(beside["slope"][done].max()), float(beside["extent"][done].max()), tabor).warnings,
    ]


def _reached(swept: tuple[str, ...], cells: tuple[int, ...], choices: Sequence[CellMethod]) -> dict[str, Array]:
    """Which error each cell came to, and by which method."""
    error = np.array([choice.error for choice in choices]).reshape(cells)
    method = np.array([_ESTIMATORS.index(choice.estimator) for choice in choices]).reshape(cells)
    return {
        "accuracy_reached": Array(swept, error, RUN_VARIABLES["accuracy_reached"].attrs),
        "accuracy_method": _flags("accuracy_method", swept, method, _ESTIMATORS),
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

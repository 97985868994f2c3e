"""Tells which error was reached where a scene asks for one: of the mean force, or the whole one of a quantity."""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from roughmdr.batch.choice import Choice
from roughmdr.batch.plan import Plan
from roughmdr.batch.rounds import CellMethod
from roughmdr.numerics.arguments import Floats
from roughmdr.result.view import ResultView
from roughmdr.scene.sections import Accuracy
from roughmdr.schema.units import format_quantity
from roughmdr.variables import LAW_VARIABLES

_MOSTLY_DRAWN = 0.9  # share of the error by draws alone, above which there is no warning of rare asperities


def reached(
    plan: Plan, methods: Sequence[CellMethod], result: ResultView, failed: NDArray[np.bool_]
) -> tuple[list[float], str, list[str]]:
    """Return the error of each cell, what was reached in words, and warnings; ``failed`` tells which have none."""
    accuracy = plan.scene.accuracy
    assert accuracy is not None
    if plan.choice is None:
        assert accuracy.relative is not None
        warnings = _warnings(accuracy, accuracy.relative, methods, failed)
        return [each.error for each in methods], _in_words(accuracy.relative, methods), warnings
    errors = np.array([each.error for each in methods])
    text = _choice_in_words(plan.choice, result, errors, methods)
    return errors.tolist(), text, _choice_warnings(plan.choice, methods, failed, accuracy.max_realizations)


def _choice_in_words(choice: Choice, result: ResultView, errors: Floats, methods: Sequence[CellMethod]) -> str:
    """Return what was chosen, and the quantity of each cell with its whole error, or the range of both."""
    values, counts = result.mean(choice.variable)[0][..., choice.step], [each.realizations for each in methods]
    unit, most = LAW_VARIABLES[choice.variable].units, float(np.fmax.reduce(errors))
    found = format_quantity(float(np.fmin.reduce(values, axis=None)), unit, to=float(np.fmax.reduce(values, axis=None)))
    number = f"{max(counts)} realisation{'s' * (max(counts) > 1)}"
    within = "error not known" if np.isnan(most) else f"within {choice.of.error_in_words(most)}"
    return "\n".join([*choice.lines, f"reached: {found} {within}, by {number}"])


def _choice_warnings(choice: Choice, methods: Sequence[CellMethod], failed: NDArray[np.bool_], most: int) -> list[str]:
    """Return warnings of cells whose error is larger than asked for, or not known; those that failed have their own."""
    tolerance, warnings = choice.of.tolerance, list[str]()
    told = [each for each, fails in zip(methods, failed, strict=True) if not fails]
    if missed := [each for each in told if each.error > tolerance]:
        by_model = max(each.model_error for each in missed) >= tolerance
        reason = "that of the method alone is larger" if by_model else f"accuracy.max_realizations, {most}, is too low"
        warnings.append(
            f"the error asked for, {choice.of.error_in_words(tolerance)}, was not reached in {len(missed)} of "
            f"{len(methods)} cells ({choice.of.error_in_words(max(each.error for each in missed))}): {reason}"
        )
    if unknown := sum(math.isnan(each.error) for each in told):
        warnings.append(f"the error of what is asked for is not known in {unknown} of {len(methods)} cells")
    return warnings


def _in_words(asked: float, methods: Sequence[CellMethod]) -> str:
    """Describe the error asked for, the realisations it took, and the cells with the expected law."""
    known = [each for each in methods if not math.isnan(each.error)]
    counts = [each.realizations for each in known if each.estimator != "expected"]
    parts = [f"asked {asked:g} of the largest mean force"]
    if known:
        parts.append(f"reached {max(each.error for each in known):.2g} in {len(known)} of {len(methods)} cells")
    if counts:
        fewest, most = min(counts), max(counts)
        parts.append(f"{most if fewest == most else f'{fewest} to {most}'} realisations in {len(counts)} of them")
    if len(counts) < len(known):
        parts.append(f"the expected law, which has no noise, in {len(known) - len(counts)} of them")
    return "; ".join(parts)


def _warnings(accuracy: Accuracy, asked: float, methods: Sequence[CellMethod], failed: NDArray[np.bool_]) -> list[str]:
    """Return warnings of cells that did not reach the error asked for; those that failed have their own."""
    warnings, cells = [], len(methods)
    if missed := [each for each in methods if each.error > asked]:
        if accuracy.method == "expected":
            other = "with accuracy.method 'auto' or 'sampled' asperities are drawn instead"
            reason = f"the expected law is not accurate enough; {other}"
        else:
            reason = f"accuracy.max_realizations, {accuracy.max_realizations}, is too low"
        warnings.append(
            f"the error asked for, {asked:g}, was not reached in {len(missed)} of {cells} cells "
            f"(up to {max(each.error for each in missed):.2g}): {reason}"
        )
    if rare := [each.drawn_error for each in missed if each.drawn_error < _MOSTLY_DRAWN * each.error]:
        warnings.append(
            f"in {len(rare)} of {cells} cells asperities too rare to be met by so many draws may bear much of "
            f"the force: without them the error would seem to be {max(rare):.2g}"
        )
    unknown = [each for each, fails in zip(methods, failed, strict=True) if math.isnan(each.error) and not fails]
    if unknown:
        warnings.append(
            f"in {len(unknown)} of {cells} cells none of {unknown[0].realizations} realisations had any force: "
            "the error of the mean is not known"
        )
    return warnings

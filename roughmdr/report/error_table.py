"""The errors of a result side by side: of rounding or integration, of the draws, of the model and its parts."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from roughmdr.model_error.parts import PARTS
from roughmdr.result.layout import done_of, estimator_of, realizations_of
from roughmdr.result.means import holds, mean_of
from roughmdr.storage.labelled import Labelled


class ErrorRow(NamedTuple):
    """One error."""

    name: str
    size: float
    """The largest over all runs, a share of the force, or of the largest force."""
    meaning: str


def error_rows(result: Labelled) -> Iterator[ErrorRow]:
    """Yield the errors of a result that are known, the largest of each over its runs."""
    expected = estimator_of(result) == "expected"
    numerical = result.variables["numerical_error"].values[done_of(result)]
    if numerical.size:
        name = "integration" if expected else "rounding"
        yield ErrorRow(name, float(numerical.max()), "numerical error of the force, over the largest force")
    if realizations_of(result) > 1:
        yield from _of_draws(result)
    if "model_error" in result.variables and not np.isnan(values := result.variables["model_error"].values).all():
        yield ErrorRow("model", float(np.nanmax(values)), "assumptions of the model, at closest approach, of the force")
        for part, reason in PARTS.items():
            size = float(np.nanmax(result.variables[part].values, initial=0.0)) if part in result.variables else 0.0
            if size > 0.0:
                yield ErrorRow(f"– {part.removesuffix('_error').replace('_', ' ')}", size, f"part of it: {reason}")


def _of_draws(result: Labelled) -> Iterator[ErrorRow]:
    """Yield the standard errors of the mean over the realisations."""
    name = next((each for each in ("force", "pressure") if holds(result, each)), None)
    if name is not None:
        mean, error = mean_of(result, name)
        largest = np.abs(mean).max(axis=-1, initial=0.0)
        shares = error.max(axis=-1)[largest > 0.0] / largest[largest > 0.0]
        if np.isfinite(shares).any():
            meaning = "standard error of the mean force over the realisations, over the largest force"
            yield ErrorRow("draws", float(np.nanmax(shares)), meaning)
    if holds(result, "pull_off_force"):
        mean, error = mean_of(result, "pull_off_force")
        known = np.isfinite(error) & (mean < 0.0)
        if known.any():
            meaning = "standard error of the mean pull-off force over the realisations, of itself"
            yield ErrorRow("draws, pull-off", float((error[known] / -mean[known]).max()), meaning)

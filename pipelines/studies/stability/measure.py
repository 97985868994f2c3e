"""Measure the stability study: ensembles of power laws over seven axes, by Sobol's sequence with the ends of each axis.

Each asperity is computed at a given indentation, force and contact radius, their sum along a loading and unloading
path, without adhesion, with JKR and with Dugdale adhesion; all are compared with 60 digits. A refusal counts as one
only where a float does not hold what the exact result needs. Added are changes of the problem with a known effect.
"""

from collections import Counter
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

import numpy as np
import xarray as xr

from studies.stability import counting
from studies.stability.cases import AXES, Case, design
from studies.stability.judge import MODELS, OUTCOMES, REFUSED, Verdict, verdicts
from studies.stability.metamorphic import Check, checks
from studies.study import named

FULL, QUICK = {"elastic": 512, "jkr": 512, "dugdale": 128}, {"elastic": 16, "jkr": 16, "dugdale": 4}
"""Number of cases for each model, from the beginning of one sequence."""
COUNTED, COUNTED_QUICKLY = 128, 16
"""Number of cases for each model with adhesion in which equilibria are counted."""
WORKERS = 2
_CHUNK = 4  # cases that a worker takes at a time


def judge_case(case: Case, models: list[str]) -> list[list[Verdict]]:
    """Return the verdicts under each of the models."""
    return [verdicts(case, model) for model in models]


def measure(quick: bool) -> xr.Dataset:
    """Return all numbers of the study."""
    counts = QUICK if quick else FULL
    cases = design(max(counts.values()))
    models = [[model for model in MODELS if number < counts[model]] for number in range(len(cases))]
    counter = counting.start(COUNTED_QUICKLY if quick else COUNTED)
    with ProcessPoolExecutor(WORKERS, mp_context=get_context("spawn")) as pool:
        changes = pool.submit(checks, quick)
        found = list(pool.map(judge_case, cases, models, chunksize=1 if quick else _CHUNK))
        parts = [of_verdicts(cases, found), of_checks(changes.result()), of_counts(counting.finish(counter))]
    return xr.merge(parts)


def of_verdicts(cases: list[Case], found: list[list[list[Verdict]]]) -> xr.Dataset:
    """Return the axes, the worst result and the outcomes of each case and model; NaN where a model was left out."""
    over = ("case", "law")
    worst = np.full((3, len(cases), len(MODELS)), np.nan)
    count = np.zeros((len(cases), len(MODELS), len(OUTCOMES)), dtype=int)
    reasons = Counter[tuple[str, str, str]]()
    for i, row in enumerate(found):
        for j, answers in enumerate(row):
            judged = [each.judged for each in answers if each.outcome != REFUSED]
            if judged:
                largest = max(judged, key=lambda one: one.excess)
                worst[:, i, j] = largest.error, largest.allowed, largest.excess
            for each in answers:
                count[i, j, OUTCOMES.index(each.outcome)] += 1
            reasons.update((MODELS[j], each.outcome, each.reason) for each in answers if each.reason)
    listed = reasons.most_common()
    names = {"error": "the error, over its natural scale", "allowed": "what is allowed", "excess": "their ratio"}
    axes = {name: ("case", [getattr(case, name) for case in cases], named(axis.long_name, axis.units))
            for name, axis in AXES.items()}  # fmt: skip
    return xr.Dataset(
        {name: (over, values, named(f"largest error over what is allowed: {text}"))
         for (name, text), values in zip(names.items(), worst, strict=True)}
        | {
            "answers": ((*over, "outcome"), count, named("number of results")),
            **axes,
            "reason_law": ("reason", [key[0] for key, _ in listed], {"long_name": "model of the refused or wrong"}),
            "reason_outcome": ("reason", [key[1] for key, _ in listed], {"long_name": "their outcome"}),
            "reason_text": ("reason", [key[2] for key, _ in listed], {"long_name": "why"}),
            "reason_answers": ("reason", [number for _, number in listed], named("results with this reason")),
        },
        {"law": list(MODELS), "outcome": list(OUTCOMES)},
    )  # fmt: skip


def of_counts(found: counting.Counts) -> xr.Dataset:
    """Return how many equilibria the kernels evaluated; NaN where the contact was refused."""
    evaluated = np.array([[row or (np.nan, np.nan) for row in case] for case in found], dtype=float)
    over = ("counted_case", "counted_law")
    return xr.Dataset(
        {
            "tried": (over, evaluated[..., 0], named("equilibria evaluated to find a contact")),
            "tried_before": (over, evaluated[..., 1], named("equilibria evaluated to set up an asperity")),
        },
        {"counted_law": list(counting.EQUILIBRIUM)},
    )


def of_checks(found: list[Check]) -> xr.Dataset:
    """Return the changes of a problem that must have a known effect."""
    texts = {"name": "what is changed", "law": "adhesion model", "kind": "shape"}
    numbers = {"error": "difference over the largest magnitude", "allowed": "difference that is allowed"}
    attributes = {name: {"long_name": text} for name, text in texts.items()}
    attributes |= {name: named(text) for name, text in numbers.items()}
    return xr.Dataset({f"change_{name}": ("change", [getattr(each, name) for each in found], attrs)
                       for name, attrs in attributes.items()})  # fmt: skip

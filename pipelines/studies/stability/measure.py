"""Measure the stability study: ensembles of power laws over seven axes, by Sobol's sequence with the ends of each axis.

Each asperity is computed at a given indentation, force and contact radius, their sum along a loading and unloading
path, without adhesion, with JKR and with Dugdale adhesion; all are compared with 60 digits. A refusal counts as one
only where a float does not hold what the exact result needs. Added are changes of the problem with a known effect, and
the equilibria that the kernels evaluate to find one contact, counted in a process in which nothing is compiled, and
crowds of asperities that feel each other.
"""

import cProfile
import math
from collections import Counter
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from typing import Any, Literal

import numpy as np
import xarray as xr
from benchmarks.process import in_new_process

import roughmdr as rm
from roughmdr.asperity.contact import Contact
from roughmdr.kernels.adhesion import Adhesion
from roughmdr.kernels.closed import jkr_power
from roughmdr.kernels.dugdale import equilibrium
from studies.stability.cases import AXES, Case, design
from studies.stability.crowding import Steps, crowded
from studies.stability.judge import MODELS, OUTCOMES, REFUSED, Verdict, verdicts
from studies.stability.metamorphic import checks
from studies.study import named

FULL, QUICK = {"elastic": 512, "jkr": 512, "dugdale": 128}, {"elastic": 16, "jkr": 16, "dugdale": 4}
"""Number of cases for each model, from the beginning of one sequence."""
COUNTED, COUNTED_QUICKLY = 128, 16
"""Number of cases for each model with adhesion in which equilibria are counted."""
EQUILIBRIUM: dict[Literal["jkr", "dugdale"], Any] = {"jkr": jkr_power._distance, "dugdale": equilibrium.state_along}
"""The kernel that evaluates an equilibrium, by adhesion model."""
WORKERS = 2


def measure(quick: bool) -> xr.Dataset:
    """Return all numbers of the study."""
    counts = QUICK if quick else FULL
    cases = design(max(counts.values()))
    models = [[model for model in MODELS if number < counts[model]] for number in range(len(cases))]
    with ProcessPoolExecutor(WORKERS, mp_context=get_context("spawn")) as pool:
        changes, crowds = pool.submit(checks, quick), pool.submit(crowded, quick)
        counted = COUNTED_QUICKLY if quick else COUNTED
        tried = pool.submit(in_new_process, equilibria_tried, counted, NUMBA_DISABLE_JIT="1")
        found = list(pool.map(judge_case, cases, models, chunksize=1 if quick else 4))
    changed = zip(("name", "law", "kind", "error", "allowed"), zip(*changes.result(), strict=True), strict=True)
    result = of_verdicts(cases, found).assign({f"change_{name}": ("change", list(values)) for name, values in changed})
    for name, values in zip(Steps._fields, zip(*crowds.result(), strict=True), strict=True):
        result[f"crowd_{name}"] = ("crowd", list(values))
    return result.assign(
        tried=(("counted_case", "counted_law"), tried.result(), named("equilibria evaluated to find a contact")),
        counted_law=list(EQUILIBRIUM),
    )


def judge_case(case: Case, models: list[str]) -> list[list[Verdict]]:
    """Return the verdicts under each of the models."""
    return [verdicts(case, model) for model in models]


def of_verdicts(cases: list[Case], found: list[list[list[Verdict]]]) -> xr.Dataset:
    """Return the axes, the worst result and the outcomes of each case and model; NaN where a model was left out."""
    worst = np.full((len(cases), len(MODELS)), np.nan)
    count = np.zeros((*worst.shape, len(OUTCOMES)), dtype=int)
    reasons = Counter[tuple[str, str]]()
    for i, row in enumerate(found):
        for j, answers in enumerate(row):
            worst[i, j] = max((each.excess for each in answers if each.outcome != REFUSED), default=np.nan)
            count[i, j] = [sum(each.outcome == outcome for each in answers) for outcome in OUTCOMES]
            reasons.update((MODELS[j], each.reason) for each in answers if each.reason)
    axes = {name: ("case", [getattr(case, name) for case in cases], named(axis.long_name, axis.units))
            for name, axis in AXES.items()}  # fmt: skip
    return xr.Dataset(
        {
            "excess": (("case", "law"), worst, named("largest error over what is allowed")),
            "answers": (("case", "law", "outcome"), count, named("number of results")),
            **axes,
            "reason_law": ("reason", [law for law, _ in reasons]),
            "reason_text": ("reason", [text for _, text in reasons]),
            "reason_answers": ("reason", list(reasons.values()), named("results refused or wrong for a reason")),
        },
        {"law": list(MODELS), "outcome": list(OUTCOMES)},
    )


def equilibria_tried(count: int) -> list[list[float]]:
    """Return how many equilibria are evaluated for a contact, [case, model]; to be called where nothing is compiled."""
    return [[evaluations(case, model) for model in EQUILIBRIUM] for case in design(count)]


def evaluations(case: Case, model: Literal["jkr", "dugdale"]) -> float:
    """Return the equilibria evaluated to find the contact of the first asperity of a case; NaN where it is refused."""
    shape = case.shapes()[0]
    try:
        strength = case.tabor / rm.tabor(shape, effective_modulus=case.effective_modulus, work=case.work, strength=1.0)
        contact = Contact.of(shape, case.effective_modulus, Adhesion.checked(model, case.work, strength))
    except rm.RoughmdrError:
        return math.nan
    with cProfile.Profile() as profile:
        contact.kernels.state(case.distance, contact.params)
    name = EQUILIBRIUM[model].__name__
    return float(sum(call.callcount for call in profile.getstats() if getattr(call.code, "co_name", "") == name))

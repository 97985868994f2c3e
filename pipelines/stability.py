"""Stiff, soft, small, steep, close to the fold: is every answer right, or refused for a reason?

    python pipelines/stability.py -o results/studies

Ensembles of power laws over seven axes, by Sobol's sequence with the ends of every axis in it. Each asperity is asked
for under fixed grips, under dead load and at a contact radius, their sum along a way in and out, without adhesion, with
JKR's and with Dugdale's; all against 60 digits. A refusal counts only where a float does not hold what the exact answer
needs. Beside it stand changes that must not change the answer (``metamorphic.py``).
"""

from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

import numpy as np
import stability_counted
import xarray as xr
from metamorphic import Check, checks
from stability_cases import AXES, Case, design
from stability_picture import draw
from stability_verdicts import LAWS, OUTCOMES, REFUSED, RIGHT, WRONG, Verdict, verdicts
from study import Study, named, table

FULL, QUICK = {"elastic": 512, "jkr": 512, "dugdale": 128}, {"elastic": 16, "jkr": 16, "dugdale": 4}
"""How many cases of each law; the first of one sequence."""
COUNTED, COUNTED_QUICKLY = 128, 16
"""In how many cases of each law with adhesion equilibria are counted."""
WORKERS = 2
_PORTION = 4  # cases that a worker takes at a time


def judged(case: Case, laws: list[str]) -> list[list[Verdict]]:
    """The verdicts under each of the laws."""
    return [verdicts(case, law) for law in laws]


def measure(quick: bool) -> xr.Dataset:
    """All figures."""
    counts = QUICK if quick else FULL
    cases = design(max(counts.values()))
    laws = [[law for law in LAWS if number < counts[law]] for number in range(len(cases))]
    counting = stability_counted.started(COUNTED_QUICKLY if quick else COUNTED)
    with ProcessPoolExecutor(WORKERS, mp_context=get_context("spawn")) as pool:
        changes = pool.submit(checks, quick)
        found = list(pool.map(judged, cases, laws, chunksize=1 if quick else _PORTION))
        return xr.merge(
            [of_verdicts(cases, found), of_checks(changes.result()), of_counts(stability_counted.finished(counting))]
        )


def of_verdicts(cases: list[Case], found: list[list[list[Verdict]]]) -> xr.Dataset:
    """The axes, and for each case and law the worst answer and the outcomes; NaN where a law was not asked for."""
    over = ("case", "law")
    worst = np.full((3, len(cases), len(LAWS)), np.nan)
    count = np.zeros((len(cases), len(LAWS), len(OUTCOMES)), dtype=int)
    reasons: dict[tuple[str, str, str], int] = {}
    for i, row in enumerate(found):
        for j, asked in enumerate(row):
            least = max(
                (each.judged for each in asked if each.outcome != REFUSED), key=lambda one: one.excess, default=None
            )
            if least is not None:
                worst[:, i, j] = least.error, least.allowed, least.excess
            for each in asked:
                count[i, j, OUTCOMES.index(each.outcome)] += 1
                if each.reason:
                    key = LAWS[j], each.outcome, each.reason
                    reasons[key] = reasons.get(key, 0) + 1
    axes = {
        name: ("case", [getattr(case, name) for case in cases], named(axis.long_name, axis.units))
        for name, axis in AXES.items()
    }
    listed = sorted(reasons.items(), key=lambda item: -item[1])
    return xr.Dataset(
        {
            "error": (over, worst[0], named("largest error over what is allowed: the error, over its natural scale")),
            "allowed": (over, worst[1], named("largest error over what is allowed: what is allowed")),
            "excess": (over, worst[2], named("largest error over what is allowed")),
            "answers": ((*over, "outcome"), count, named("answers asked for")),
            **axes,
            "reason_law": ("reason", [law for (law, _, _), _ in listed], {"long_name": "law of the refused or wrong"}),
            "reason_outcome": ("reason", [outcome for (_, outcome, _), _ in listed], {"long_name": "their outcome"}),
            "reason_text": ("reason", [text for (_, _, text), _ in listed], {"long_name": "why"}),
            "reason_answers": ("reason", [number for _, number in listed], named("answers with this reason")),
        },
        {"law": list(LAWS), "outcome": list(OUTCOMES)},
    )


def of_counts(found: stability_counted.Counts) -> xr.Dataset:
    """How many equilibria the kernels tried; NaN where the contact was refused."""
    tried = np.array(
        [[[np.nan, np.nan] if row is None else [float(each) for each in row] for row in case] for case in found],
        dtype=float,
    )
    over, laws = ("counted_case", "counted_law"), list(stability_counted.TRIALS)
    return xr.Dataset(
        {
            "tried": (over, tried[..., 0], named("equilibria tried to find a contact")),
            "tried_before": (over, tried[..., 1], named("equilibria tried to set up an asperity")),
        },
        {"counted_law": laws},
    )


def of_checks(found: list[Check]) -> xr.Dataset:
    """The changes that must not change the answer."""
    over = "change"
    return xr.Dataset(
        {
            "change_name": (over, [each.name for each in found], {"long_name": "what is changed"}),
            "change_law": (over, [each.law for each in found], {"long_name": "law"}),
            "change_kind": (over, [each.kind for each in found], {"long_name": "shape"}),
            "change_error": (over, [each.error for each in found], named("difference over the largest magnitude")),
            "change_allowed": (over, [each.allowed for each in found], named("difference that is allowed")),
        }
    )


def tell(result: xr.Dataset) -> str:
    """Outcomes, worst answers, refusals, equilibria tried, changes."""
    parts = [_outcomes(result), _reasons(result), _tried(result), _changes(result)]
    return "\n\n".join(part for part in parts if part)


def _outcomes(result: xr.Dataset) -> str:
    rows = []
    for law in LAWS:
        own = result.sel(law=law)
        answers = own.answers.sum("case")
        place = own.excess.fillna(-1.0).argmax("case")
        rows.append(
            [
                law,
                str(int((own.answers.sum("outcome") > 0).sum())),
                *(str(int(answers.sel(outcome=outcome))) for outcome in (RIGHT, REFUSED, WRONG)),
                f"{float(own.excess[place]):.2f} ({float(own.error[place]):.1e} of {float(own.allowed[place]):.1e})",
            ]
        )
    wrong = int(result.answers.sel(outcome=WRONG).sum())
    said = "No answer is wrong." if not wrong else f"{wrong} answers are wrong."
    head = ["law", "cases", "right", "refused", "wrong", "worst error over what is allowed"]
    return f"{said}\n\n{table(head, rows)}"


def _reasons(result: xr.Dataset) -> str:
    columns = [result[f"reason_{name}"].to_numpy() for name in ("law", "outcome", "answers", "text")]
    rows = [[law, outcome, str(number), text] for law, outcome, number, text in zip(*columns, strict=True)]
    return table(["law", "outcome", "answers", "reason"], rows) if rows else ""


def _tried(result: xr.Dataset) -> str:
    rows = []
    for law in result.counted_law.to_numpy():
        for name, what in (("tried", "to find a contact"), ("tried_before", "to set up an asperity")):
            values = result[name].sel(counted_law=law).dropna("counted_case").to_numpy()
            if values.size:
                rows.append([law, what, *(f"{np.quantile(values, part):.0f}" for part in (0.5, 0.99, 1.0))])
    return table(["law", "equilibria tried", "median", "99 %", "most"], rows)


def _changes(result: xr.Dataset) -> str:
    rows = []
    for name in dict.fromkeys(result.change_name.to_numpy().tolist()):
        own = result.isel(change=np.flatnonzero(result.change_name == name))
        allowed = float(own.change_allowed.max())
        worst = float(own.change_error.max())
        rows.append(
            [name, str(own.sizes["change"]), f"{worst:.1e}" if worst else "0", f"{allowed:.0e}" if allowed else "0"]
        )
    return table(["change", "laws and shapes", "worst difference", "allowed"], rows)


STUDY = Study("stability", "Stability when stiff, small, steep or close to the fold", measure, draw, tell)

if __name__ == "__main__":
    STUDY.command()

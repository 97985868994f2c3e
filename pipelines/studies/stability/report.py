"""The report of the stability study: outcomes, worst results, refusals, equilibria evaluated, changes."""

import numpy as np
import xarray as xr

from studies.stability.judge import MODELS, REFUSED, RIGHT, WRONG
from studies.study import table


def report(result: xr.Dataset) -> str:
    """Return the report in Markdown."""
    parts = [_outcomes(result), _reasons(result), _evaluated(result), _changes(result)]
    return "\n\n".join(part for part in parts if part)


def _outcomes(result: xr.Dataset) -> str:
    rows = []
    for model in MODELS:
        chosen = result.sel(law=model)
        answers = chosen.answers.sum("case")
        worst = chosen.isel(case=int(chosen.excess.fillna(-1.0).argmax("case")))
        cases = str(int((chosen.answers.sum("outcome") > 0).sum()))
        outcomes = [str(int(answers.sel(outcome=outcome))) for outcome in (RIGHT, REFUSED, WRONG)]
        excess = f"{float(worst.excess):.2f} ({float(worst.error):.1e} of {float(worst.allowed):.1e})"
        rows.append([model, cases, *outcomes, excess])
    wrong = int(result.answers.sel(outcome=WRONG).sum())
    head = ["law", "cases", "right", "refused", "wrong", "worst error over what is allowed"]
    return f"{f'{wrong} answers are wrong' if wrong else 'No answer is wrong'}.\n\n{table(head, rows)}"


def _reasons(result: xr.Dataset) -> str:
    names = ("law", "outcome", "answers", "text")
    rows = zip(*(result[f"reason_{name}"].to_numpy().astype(str) for name in names), strict=True)
    found = [list(map(str, row)) for row in rows]
    return table(["law", "outcome", "answers", "reason"], found) if found else ""


def _evaluated(result: xr.Dataset) -> str:
    rows = []
    for model in result.counted_law.to_numpy():
        for name, purpose in (("tried", "to find a contact"), ("tried_before", "to set up an asperity")):
            values = result[name].sel(counted_law=model).dropna("counted_case").to_numpy()
            if values.size:
                rows.append([model, purpose, *(f"{np.quantile(values, part):.0f}" for part in (0.5, 0.99, 1.0))])
    return table(["law", "equilibria evaluated", "median", "99 %", "most"], rows)


def _changes(result: xr.Dataset) -> str:
    rows = []
    for name in dict.fromkeys(result.change_name.to_numpy().tolist()):
        chosen = result.isel(change=np.flatnonzero(result.change_name == name))
        numbers = float(chosen.change_error.max()), float(chosen.change_allowed.max())
        rows.append([name, str(chosen.sizes["change"]), *(f"{number:.1e}" if number else "0" for number in numbers)])
    return table(["change", "laws and shapes", "worst difference", "allowed"], rows)

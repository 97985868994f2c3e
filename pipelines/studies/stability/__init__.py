"""Measure the stability study: ensembles of power laws over seven axes, by Sobol's sequence with the ends of each axis.

Each asperity is computed at a given indentation, force and contact radius, their sum along a loading and unloading
path, without adhesion, with JKR and with Dugdale adhesion; all are compared with 60 digits. A refusal counts as one
only where a float does not hold what the exact result needs. Added are changes of the problem with a known effect, and
the equilibria that the kernels evaluate to find one contact, counted in a process in which nothing is compiled, and
crowds of asperities that feel each other.
"""

import cProfile
import math
import operator
from collections import Counter
from collections.abc import Iterator
from functools import partial
from itertools import product
from typing import Any, Literal

import numpy as np
import xarray as xr
from benchmarks.child import in_new_process

import roughmdr as rm
from roughmdr.asperity.contact import Contact
from roughmdr.kernels.adhesion import Adhesion
from roughmdr.kernels.closed import jkr_power
from roughmdr.kernels.dugdale import equilibrium
from roughmdr.numerics.arguments import Floats
from studies.comparison import PAIRS, groups_of, law_of
from studies.stability.judge import AXES, MODELS, OUTCOMES, REFUSED, WRONG, Case, Verdict, design, verdicts
from studies.stability.metamorphic import KINDS, QUICK as QUICK_KINDS, checks
from studies.study import Axes, Figure, Study, blank, in_two_processes, named, table
from studies.versus_bem.ensembles import MODULUS, Case as Crowd, separations

FULL, QUICK = {"elastic": 512, "jkr": 512, "dugdale": 128}, {"elastic": 16, "jkr": 16, "dugdale": 4}
"""Number of cases for each model, from the beginning of one sequence."""
COUNTED, COUNTED_QUICKLY = 128, 16  # number of cases for each model with adhesion in which equilibria are counted
EQUILIBRIUM: dict[Literal["jkr", "dugdale"], Any] = {"jkr": jkr_power._distance, "dugdale": equilibrium.state_along}
"""The kernel that evaluates an equilibrium, by adhesion model."""
CELLS = 8  # along an axis
_TIGHT = 1e-9  # error of the force that that of the package is held against
_FRACTIONS = np.array([1e-3, 0.01, 0.03, 0.06, 0.1, 0.2])
"""Contact fractions of independent asperities, from first contact on."""
_COLORS = {"right": "#1b6ca8", "refused": "#b8b8b8", "wrong": "#ff00c8"}
_LEAST = 1e-2  # least error over what is allowed that the colours tell apart


def measure(quick: bool) -> xr.Dataset:
    """Return all numbers of the study."""
    counts = QUICK if quick else FULL
    cases = design(max(counts.values()))
    jobs = [
        partial(checks, quick),
        partial(crowded, quick),
        partial(in_new_process, equilibria_tried, COUNTED_QUICKLY if quick else COUNTED, NUMBA_DISABLE_JIT="1"),
        *(partial(judge_case, case, [model for model in MODELS if number < counts[model]])
          for number, case in enumerate(cases)),
    ]  # fmt: skip
    changes, pressed, tried, *found = in_two_processes(operator.call, jobs)
    tables = {"change": changes, "crowd": pressed}
    columns = {f"{dim}_{name}": (dim, [row[name] for row in rows]) for dim, rows in tables.items() for name in rows[0]}
    evaluated = ("counted_case", "counted_law"), tried, named("equilibria evaluated to find a contact")
    result = of_verdicts(cases, found).assign(columns)
    return result.assign(tried=evaluated, counted_law=list(EQUILIBRIUM))


def judge_case(case: Case, models: list[str]) -> list[list[Verdict]]:
    """Return the verdicts under each of the models."""
    return [verdicts(case, model) for model in models]


def crowds(quick: bool) -> Iterator[tuple[Crowd, float]]:
    """Yield crowds at random, some of which overlap, and over how many decades radii spread: of paraboloids alone."""
    counts, roughnesses = ((60,), (0.05,)) if quick else ((60, 250, 700), (1e-3, 0.05, 1.0))
    for seed, (shape, count, roughness) in enumerate(product(("paraboloid", "cone", "quartic"), counts, roughnesses)):
        for decades in (0.0, 2.0, 6.0) if shape == "paraboloid" else (0.0,):
            yield Crowd("random", shape, count, roughness, 64, seed), decades


def press(case: Crowd, decades: float) -> dict[str, Any]:
    """Press a crowd; count its steps, those marked and those without an equilibrium.

    The excess is the largest error of the force, against one by a thousand times smaller errors, over the stated one.
    """
    ensemble = case.generate()
    if decades:
        spread = np.random.default_rng(case.seed).uniform(-decades, 0.0, case.asperities)
        ensemble["radius"] = ensemble["radius"] * 10.0**spread
    along = separations(ensemble, _FRACTIONS)
    along = along[np.isfinite(along)]
    found, tight = (
        law_of(ensemble, separation=along, effective_modulus=MODULUS, variables="force",
               interaction={**PAIRS[2], "error": error})
        for error in (1e-6, _TIGHT)
    )  # fmt: skip
    force, exact = found["force"].to_numpy(), tight["force"].to_numpy()
    solved = np.isfinite(force) & np.isfinite(exact)
    off = float(np.abs(force - exact)[solved].max(initial=0.0) / np.abs(exact[solved]).max(initial=1e-300))
    stated = float(found["numerical_error"] + tight["numerical_error"])
    return {
        "name": f"{case.shape}, radii over {decades:g} decades" if decades else case.shape,
        "steps": along.size,
        "marked": int(found["marked_steps"]),
        "without": int(np.isnan(force).sum()),
        "excess": off / max(stated, _TIGHT),
    }


def crowded(quick: bool) -> list[dict[str, Any]]:
    """Return the outcomes of all crowds."""
    return [press(*crowd) for crowd in crowds(quick)]


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


def report(result: xr.Dataset) -> str:
    """Return outcomes and worst results, refusals, equilibria evaluated and changes, in Markdown."""
    wrong = int(result.answers.sel(outcome=WRONG).sum())
    outcomes = []
    for model in MODELS:
        chosen = result.sel(law=model)
        cases, answers = int((chosen.answers.sum("outcome") > 0).sum()), chosen.answers.sum("case").to_numpy()
        outcomes.append([model, *map(str, (cases, *answers)), f"{float(chosen.excess.max()):.2f}"])
    listed = result.sortby("reason_answers", ascending=False)
    reasons = zip(*(listed[f"reason_{name}"].to_numpy() for name in ("law", "answers", "text")), strict=True)
    evaluated = []
    for model in result.counted_law.to_numpy():
        values = result.tried.sel(counted_law=model).dropna("counted_case").to_numpy()
        evaluated.append([model, *(f"{np.quantile(values, part):.0f}" for part in (0.5, 0.99, 1.0))])
    changes = []
    for (name,), chosen in groups_of(result, "change_name"):
        numbers = float(chosen.change_error.max()), float(chosen.change_allowed.max())
        changes.append([name, str(chosen.sizes["change"]), *(f"{number:.1e}" if number else "0" for number in numbers)])
    crowded = []
    for (name,), chosen in groups_of(result, "crowd_name"):
        counted = (str(int(chosen[f"crowd_{each}"].sum())) for each in ("steps", "marked", "without"))
        crowded.append([name, *counted, f"{float(chosen.crowd_excess.max()):.2g}"])
    return "\n\n".join([
        f"{wrong} answers are wrong." if wrong else "No answer is wrong.",
        table(["law", "cases", *OUTCOMES, "worst error over what is allowed"], outcomes),
        table(["law", "answers", "reason"], [list(map(str, row)) for row in reasons]),
        table(["law", "equilibria evaluated for a contact: median", "99 %", "most"], evaluated),
        table(["change", "laws and shapes", "worst difference", "allowed"], changes),
        table(["crowded asperities, coupled in pairs", "steps", "marked", "without an equilibrium",
               "worst error over the stated one"], crowded),
    ])  # fmt: skip


def cell_of(result: xr.Dataset, name: str) -> Any:
    """Return the cell along an axis in which each case lies."""
    return np.clip((AXES[name].fraction(result[name].to_numpy()) * CELLS).astype(int), 0, CELLS - 1)


def worst_in(result: xr.Dataset, one: str, other: str, values: Any) -> Any:
    """Return the largest of the values [case] in each cell of a pair of axes; NaN where there is none."""
    grid = np.full((CELLS, CELLS), np.nan)
    np.fmax.at(grid, (cell_of(result, other), cell_of(result, one)), values)
    return grid


def draw(result: xr.Dataset) -> Figure:
    """Draw the worst error below the diagonal, equilibria evaluated above it, on it the outcomes along each axis."""
    from matplotlib import colormaps
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import LogNorm
    from matplotlib.patches import Patch

    names, ends = list(AXES), (-0.5, 0.5 * CELLS - 0.5, CELLS - 0.5)
    figure = blank(15, 13.5)
    panels = figure.subplots(len(names), len(names))
    of_errors = colormaps["YlOrBr"].with_extremes(under=_COLORS["refused"], over=_COLORS["wrong"])
    errors = ScalarMappable(LogNorm(_LEAST, 1.0), of_errors)
    evaluated = ScalarMappable(LogNorm(1.0, max(2.0, float(np.nanmax(result.tried, initial=2.0)))), "viridis")
    counted = result.isel(case=slice(0, result.sizes["counted_case"]))
    for (i, j), panel in np.ndenumerate(panels):
        one, other = names[j], names[i]
        chosen = result.sel(law=["dugdale"]) if "tabor" in (one, other) else result  # no other depends on it
        panel.set(xticks=ends, xticklabels=(), yticks=() if i == j else ends, yticklabels=())
        if j == i:
            _draw_outcomes(panel, chosen, one)
        else:
            values = _worst(chosen) if j < i else counted.tried.max("counted_law").to_numpy()
            shown = errors if j < i else evaluated
            grid = worst_in(chosen if j < i else counted, one, other, values)
            panel.imshow(grid, cmap=shown.cmap, norm=shown.norm, origin="lower", aspect="auto")
        if i == len(names) - 1:
            panel.set_xticklabels(_ticks(one), fontsize=8)
            panel.set_xlabel(AXES[one].label)
        if j == 0 and i > 0:
            panel.set_yticklabels(_ticks(other), fontsize=8)
            panel.set_ylabel(AXES[other].label)
    below, above = "below: worst error over what is allowed", "above: most equilibria evaluated for a contact"
    figure.colorbar(errors, ax=panels, location="bottom", shrink=0.4, label=below)
    figure.colorbar(evaluated, ax=panels, location="right", shrink=0.4, label=above)
    handles = [Patch(color=color, label=outcome) for outcome, color in _COLORS.items()]
    figure.legend(handles=handles, loc="outside upper right", ncols=3, title="refused: no float holds it; white: none")
    figure.suptitle("Results over seven axes, without adhesion, with JKR and with Dugdale", x=0.02, ha="left")
    return figure


def _ticks(name: str) -> list[str]:
    """Return the values at the ends and in the middle of an axis."""
    return [f"{AXES[name].at(part):.3g}" for part in (0.0, 0.5, 1.0)]


def _worst(result: xr.Dataset) -> Floats:
    """Return the worst error of each case, above 1 with a wrong answer, next to 0 if all are refused; NaN if none."""
    answers = result.answers.sum("law")
    excess = result.excess.max("law").clip(min=_LEAST).fillna(1e-300).where(answers.sum("outcome") > 0)
    return np.asarray(excess.where(answers.sel(outcome=WRONG) == 0, 2.0))


def _draw_outcomes(panel: Axes, result: xr.Dataset, name: str) -> None:
    """Draw the fraction of each outcome along an axis."""
    answers = result.answers.sum("law").to_numpy()
    count = np.zeros((CELLS, answers.shape[1]))
    np.add.at(count, cell_of(result, name), answers)
    fraction = count / np.maximum(count.sum(axis=1, keepdims=True), 1.0)
    for number, color in enumerate(_COLORS.values()):
        panel.bar(np.arange(CELLS), fraction[:, number], 1.0, fraction[:, :number].sum(axis=1), color=color)
    panel.set(xlim=(-0.5, CELLS - 0.5), ylim=(0.0, 1.0), title=AXES[name].label)


STUDY = Study(
    "stability", "Stability when stiff, small, steep or close to the fold", measure, draw, report,
    f"{sum(QUICK.values())} of {sum(FULL.values())} cases, "
    f"equilibria counted in {COUNTED_QUICKLY} of {COUNTED}; changes of the problem on "
    f"{len(QUICK_KINDS)} of {len(KINDS)} shapes; {len([*crowds(True)])} of {len([*crowds(False)])} crowds",
)  # fmt: skip

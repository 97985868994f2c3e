"""The study of the extremes in its quick form; and that it would find a wrong answer, or a refusal without need."""

import math

import numpy as np
import pytest
import xarray as xr
from carried_out import CarriedOut
from forms import large
from studies.stability import FULL, draw
from studies.stability.judge import (
    AXES,
    CONTROLS,
    REFUSED,
    RIGHT,
    WRONG,
    Case,
    DugdaleReference,
    Reference,
    design,
    on_error,
    on_results,
    verdicts,
)

import roughmdr as rm

STUDIED = "stability"

KNOWN = {
    *(f"the natural {what} is not representable" for what in ("indentation", "force", "contact_radius", "stiffness")),
    "the contact of an asperity is not representable",
    *(f"{control} is ..." for control in CONTROLS),
}
"""Why answers are refused: floats do not hold a scale of the contact, or what is asked for."""
TYPICALLY, AT_MOST = 20, 100
"""Equilibria that are tried to find a contact under Dugdale's law; to halve an interval takes 50."""
MILD = Case(3e6, 2e-5, 0.04, 2.6, 1.5, 0.02, 1.0, 0.05, (0.5, 3.0))


@pytest.mark.large
def test_nothing_is_wrong(result: xr.Dataset) -> None:
    assert int(result.answers.sel(outcome=WRONG).sum()) == 0, result.reason_text.to_numpy()
    assert float(result.excess.max()) <= 1.0
    asked = result.answers.sum(("case", "outcome"))
    assert (asked > 0).all()
    assert float(result.answers.sel(outcome=RIGHT).sum() / asked.sum()) > 0.8


@pytest.mark.large
def test_refusals_have_known_reasons(result: xr.Dataset) -> None:
    for reason in result.reason_text.to_numpy():
        assert reason in KNOWN or reason.endswith(" is not representable"), reason


@pytest.mark.large
def test_few_equilibria_are_tried(result: xr.Dataset) -> None:
    jkr, dugdale = (result.tried.sel(counted_law=law).dropna("counted_case") for law in ("jkr", "dugdale"))
    assert jkr.size > 0
    assert (jkr == 3).all()
    assert 0 < float(dugdale.median()) <= TYPICALLY
    assert float(dugdale.max()) <= AT_MOST


@pytest.mark.large
def test_changes_that_must_not_change_the_answer_do_not(result: xr.Dataset) -> None:
    failed = result.change_error > result.change_allowed
    assert not failed.any(), result.change_name.to_numpy()[failed]
    assert {"order", "two parts", "units", "asperities out of reach"} < set(result.change_name.to_numpy())


@pytest.mark.large
def test_the_study_is_told_and_drawn(studied: CarriedOut, result: xr.Dataset) -> None:
    assert "No answer is wrong." in studied.text
    for law in result.law.to_numpy():
        assert f"| {law} |" in studied.text
    assert len(draw(result).axes) >= len(AXES) ** 2


def test_the_ends_of_every_axis_are_among_the_cases() -> None:
    cases = design(FULL["jkr"])
    for name, axis in AXES.items():
        values = np.array([getattr(case, name) for case in cases])
        assert values.min() == axis.low, name
        assert values.max() == axis.high, name
        np.testing.assert_allclose([axis.at(part) for part in axis.fraction(values)], values, rtol=1e-9)


@pytest.mark.parametrize("law", ["elastic", large("jkr"), large("dugdale")])
def test_an_everyday_case_is_right(law: str) -> None:
    assert {each.outcome for each in verdicts(MILD, law)} == {RIGHT}


def contact(law: str, control: str) -> tuple[Reference, dict[str, float]]:
    """The first asperity of the everyday case, exactly and as roughmdr has it."""
    shape, numbers = (
        MILD.shapes()[0],
        {"effective_modulus": MILD.effective_modulus, "work": 0.0 if law == "elastic" else MILD.work},
    )
    reference: Reference = Reference(shape, **numbers)
    model = {}
    if law == "dugdale":
        numbers["strength"] = MILD.tabor / rm.tabor(shape, **numbers, strength=1.0)
        reference, model = DugdaleReference(shape, **numbers), {"adhesion": "dugdale"}
    found = rm.indent(shape, **numbers, **model, **{control: float(reference.value(control, MILD.distance))})
    return reference, {str(name): float(found[name]) for name in found.variables}


@pytest.mark.parametrize("control", CONTROLS)
@pytest.mark.parametrize("law", ["elastic", "jkr", large("dugdale")])
def test_an_answer_that_is_a_little_off_is_wrong(law: str, control: str) -> None:
    reference, got = contact(law, control)
    right = reference.judge(control, got)
    assert on_results(right).outcome == RIGHT
    for name in got:
        allowed = [judged.allowed for what, judged in right.items() if what.removeprefix("backward ") == name]
        if name != control and allowed:
            for planted in (got[name] * (1.0 + 30.0 * max(allowed)), math.nan):
                verdict = on_results(reference.judge(control, {**got, name: planted}))
                assert verdict.outcome == WRONG, (name, planted, verdict)


def test_only_a_refusal_that_is_needed_counts() -> None:
    held, lost = [1.0, 1e-200], [1.0, 1e-320]
    refusal = rm.OutOfRange("the natural force is not representable (2e-308 to 2e308 in SI): modulus 3 Pa")
    assert on_error(refusal, held).outcome == WRONG
    assert on_error(refusal, lost) == (REFUSED, 0.0, "the natural force is not representable")
    assert on_error(OverflowError("too large"), lost).outcome == WRONG

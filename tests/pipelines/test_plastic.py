"""Contacts that yield: the oracle is what it says, and kernels and LAMMPS agree with it."""

import json
import math
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import plastic_references
import pytest
from carried_out import carried_out
from oracles.jkr import JkrPowerLaw
from oracles.multiprecision import mp
from oracles.plastic import Contact, fitted
from studies.versus_lammps import COMMAND, STUDY, compare

import roughmdr as rm
from roughmdr.stages.plastic.body import CRITICAL, LIMIT, RADIUS, ROWS, Body
from roughmdr.stages.plastic.models import kernels_of

STICKY = Contact(1e-6, 1e11, 3e8, 0.1, "sphere", 0.3)
DEPTH = 1e-7


@cache
def cases(name: str) -> list[dict[str, Any]]:
    """The entries of a table."""
    found: list[dict[str, Any]] = json.loads((Path(__file__).parents[1] / f"data/{name}.json").read_text())["cases"]
    return found


def body_of(case: dict[str, Any]) -> Body:
    """The constants of an entry."""
    E, nu = case["modulus"], case["poisson"]
    shear, nu = (math.inf, math.nan) if nu is None else (0.5 * E * (1.0 - nu), nu)
    return Body(E, case["yield_stress"], case["work"], nu, shear, 1.0 if case["shape"] == "sphere" else 0.0)


def near(found: float, exact: str, scale: float | None = None) -> bool:
    """Whether a number is right to some roundings of it, or of a natural scale."""
    return abs(found - float(exact)) <= 4e-14 * (abs(float(exact)) if scale is None else scale)


@pytest.mark.parametrize("number", range(24))
def test_kernels_are_right_to_roundings(number: int) -> None:
    case = cases("plastic_references")[number]
    body, deepest = body_of(case), case["rows"][0][0]
    kernels, asperity = kernels_of("mdr", body), np.zeros(ROWS)
    asperity[RADIUS] = case["radius"]
    kernels.prepare(asperity, body)
    mark = kernels.mark(deepest, asperity, body)
    assert near(asperity[LIMIT], case["start"])
    assert (mark.first > 0.0) == ("lost" in case)
    most, widest = abs(float(case["rows"][0][2])), float(case["rows"][0][3])
    if "lost" in case:
        ends = kernels.ends(deepest, mark, asperity, body)
        assert near(ends[0], case["made"])
        assert near(ends[1], case["ends"])
        own = kernels.lost(deepest, mark, asperity, body)
        assert near(own, case["lost"], float(case["lost"]) + most * ends[0])
    for d, u, force, radius, stored in case["rows"]:
        state = kernels.state(d - u, u, mark, asperity, body)
        assert near(state.force, force, max(most, abs(float(force))))
        assert near(state.radius, radius, widest)
        assert near(state.stored, stored, max(most * deepest, abs(float(stored))))


@pytest.mark.parametrize("number", range(13))
def test_kernels_have_the_forces_of_lammps(number: int) -> None:
    case = cases("plastic_lammps")[number]
    errors = compare(Body(**case["body"]), np.array(case["rows"]))
    assert len(errors) > 8
    assert max(abs(errors)) < 1e-6


@pytest.mark.parametrize("model", ["jackson-green", "kogut-etsion"])
def test_fitted_kernels_are_the_published_formulas(model: str) -> None:
    rng = np.random.default_rng(5)
    for _ in range(30):
        radius, E, nu = 10.0 ** rng.uniform(-9.0, 0.0), 10.0 ** rng.uniform(6.0, 12.0), rng.uniform(0.0, 0.5)
        body = Body(E, E * 10.0 ** rng.uniform(-5.0, -2.0), 0.0, nu, math.inf, 1.0)
        asperity, kernels = np.zeros(ROWS), kernels_of(model, body)
        asperity[RADIUS] = radius
        kernels.prepare(asperity, body)
        d = asperity[CRITICAL] * 10.0 ** rng.uniform(-1.0, 2.5)
        mark, u = kernels.mark(d, asperity, body), rng.uniform(0.0, 0.8) * d
        state = kernels.state(d - u, u, mark, asperity, body)
        force, a, left = (float(x) for x in fitted(model, d, u, (radius, E, body.yield_strength, nu)))
        scale = float(fitted(model, d, 0.0, (radius, E, body.yield_strength, nu))[0])
        assert abs(state.force - force) < 1e-12 * scale
        assert state.radius == pytest.approx(a, rel=1e-6)
        assert mark.third == pytest.approx(left, rel=1e-12)


def test_fits_begin_at_hertz_and_end_fully_plastic() -> None:
    material = (1.0, 1e5, 1.0, 0.3)
    yields = (math.pi * 2.8 * (0.454 + 0.41 * 0.3) / 2e5) ** 2
    below, above = (fitted("kogut-etsion", yields * x, 0.0, material) for x in (1 - 1e-12, 1 + 1e-12))
    assert above[0] / below[0] == pytest.approx(1.03, abs=1e-9)
    assert (above[1] / below[1]) ** 2 == pytest.approx(0.93, abs=1e-9)
    force, a, left = fitted("kogut-etsion", yields * 200.0, 0.0, material)
    assert force / (math.pi * a * a) == pytest.approx(2.8, rel=1e-14)
    assert fitted("kogut-etsion", yields * 200.0, yields * 200.0 - left, material)[0] < 1e-20 * force


@pytest.mark.large
def test_forces_are_slopes_of_energies_and_springs_have_closed_forms() -> None:
    _, lost = STICKY.ends(DEPTH)
    with mp.workdps(30):
        for start, stop in ((0, 0.01), (0.6, 0.9)):  # pinned, and peeling
            rises = [lost * mp.mpf(part) for part in (start, stop)]
            work = mp.quad(lambda u: STICKY.state(DEPTH, u)[0], rises, method="gauss-legendre", maxdegree=3)
            change = STICKY.state(DEPTH, rises[0])[2] - STICKY.state(DEPTH, rises[1])[2]
            assert abs(work - change) < mp.mpf("1e-9") * abs(change)
    dry = Contact(1e-6, 1e11, 3e8, 0.0, "paraboloid")
    a, flow = dry.flow(mp.mpf(DEPTH))
    assert abs(dry.state(DEPTH, 0.0)[0] / flow - 1) < 1e-30
    half = 2 * dry.pressure(mp.mpf(DEPTH)) * a / dry.modulus
    phi = mp.mpf(1) / 3
    force, radius, _ = dry.state(DEPTH, half * mp.cos(phi))
    assert abs(radius / (a * mp.sin(phi)) - 1) < 1e-30
    assert abs(force / (dry.modulus * half * a * (phi - mp.sin(phi) * mp.cos(phi))) - 1) < 1e-30


@pytest.mark.large
def test_without_yield_contacts_are_those_of_jkr() -> None:
    hard = Contact(1e-6, 1e11, 1e10, 0.1)
    twin = JkrPowerLaw(rm.Paraboloid(radius=1e-6), 1e11, 0.1)
    a = twin.radius("indentation", mp.mpf(2e-9))
    force, radius, _ = hard.state(2e-9, 0.0)
    assert abs(radius / a - 1) < 1e-30
    assert abs(force / twin.state(a)["force"] - 1) < 1e-30
    tip = twin.state(twin.fold("indentation"))["indentation"]
    assert hard.state(2e-9, 2e-9 - tip * 1.0001)[0] == 0
    assert hard.state(2e-9, 2e-9 - tip * 0.9999)[0] < 0


@pytest.mark.large
def test_the_least_adhesion_yields_where_dry_contacts_do() -> None:
    faint = Contact(1e-6, 1e11, 1e4, 1e-24, "paraboloid")
    assert abs(faint.start / faint.onset - 1) < 1e-4
    assert Contact(1e-6, 1e11, 1e4).start == Contact(1e-6, 1e11, 1e4).onset


def test_a_table_is_what_its_script_makes() -> None:
    case = cases("plastic_references")[4]
    names = ("radius", "modulus", "yield_stress", "work", "shape", "poisson")
    assert plastic_references.table(Contact(*(case[name] for name in names)), case["rows"][0][0]) == case


def test_the_study_says_that_lammps_is_not_there(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.delenv(COMMAND, raising=False)
    with carried_out(STUDY, tmp_path) as studied:
        assert f"the environment variable {COMMAND} holds no command" in studied.text
        assert studied.result.sizes["state"] == 0

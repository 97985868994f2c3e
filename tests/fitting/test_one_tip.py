"""Fits of one tip on a half-space: as scipy finds them with the textbook's law, at any scale, with honest intervals."""

import re
from itertools import product
from typing import Any

import numpy as np
import pandas as pd
import pytest
from forms import large
from measurements import inside
from tips import COMBINATIONS, MODULUS, NOISES, OFFSET, WORK, Floats, Tip, jkr

import roughmdr as rm
from roughmdr.errors import OutOfRange
from roughmdr.fitting.words import describe_fit
from roughmdr.storage.labelled import Labelled

SCALES = [(1e-9, 1e9), (1e-7, 1e6), (1e-5, 1e3), (1e-3, 1e5)]  # depth [m] and modulus [Pa]
CASES = [(kind, free) for kind, combinations in COMBINATIONS.items() for free in combinations]


def number(fit: Any, key: str, end: str = "") -> float:
    return float(fit[key.replace(".", "_") + end])


@pytest.mark.few(1)
@pytest.mark.parametrize(("kind", "free"), [*CASES[:-3], *(large(*case) for case in CASES[-3:])])
def test_scipy_finds_the_same(kind: str, free: list[str]) -> None:
    """With noise so small that no jump comes near a step, beside which least squares have no minimum."""
    for scale, modulus in SCALES:
        tip, rng = Tip(kind, scale, modulus), np.random.default_rng(3)
        offset = 0.2 * scale if OFFSET in free else 0.0
        measured = tip.measure(rng, 200, ("proportional", 0.002), offset)
        fit = rm.fit(measured, tip.scene(), free, set=tip.start(rng, free))
        twin = tip.twin(measured, free, offset)
        for key, value, error in zip(free, twin.values, twin.errors, strict=True):
            assert number(fit, key) == pytest.approx(value, rel=1e-5)
            assert number(fit, key, "_standard_error") == pytest.approx(error, rel=0.02)


def test_a_sphere_on_a_gel() -> None:
    """778 Pa, 10 um, first touch at a reading of 167 nm, noise of half a percent of the largest force."""
    separation, rng = np.linspace(4e-6, -2.2e-6, 600), np.random.default_rng(0)
    tip = Tip("hertz", 1e-6, 778.0)
    force = tip.law(778.0, 0.0, 167e-9 - separation)
    noise = 0.005 * force.max() * rng.standard_normal(force.size)
    measured = pd.DataFrame({"separation": separation, "force": force + noise})
    fit = rm.fit(measured, tip.scene(), [MODULUS, OFFSET], set={MODULUS: "1 kPa"})
    assert inside(fit, MODULUS, 778.0)
    assert inside(fit, OFFSET, -167e-9)
    assert number(fit, MODULUS, "_standard_error") < 3.0
    assert number(fit, OFFSET, "_standard_error") < 3e-9
    assert "warnings" not in fit.attrs or "determine" not in fit.attrs["warnings"]
    assert float(fit.evaluation_count) < 60


@pytest.mark.large
def test_a_jump_beside_a_step_is_met() -> None:
    """Noise moves the minimum of the smooth part over steps at which the contact is made or lost."""
    free = [MODULUS, WORK, OFFSET]
    for seed in (0, 4, 13):
        tip, rng = Tip("jkr", 1e-7, 1e6), np.random.default_rng(seed)
        measured = tip.measure(rng, 300, ("constant", 0.01), 2e-8)
        fit = rm.fit(measured, tip.scene(), free, set=tip.start(rng, free))
        deviations = (fit.force_fitted.to_numpy() - measured.force.to_numpy()) / measured.force_error.to_numpy()
        assert float(np.sum(deviations**2)) < (1.0 + 1e-5) * tip.twin(measured, free, 2e-8).cost
        assert np.abs(deviations).max() < 6.0


def on_a_gel(steps: Floats, noise: float, seed: int) -> tuple[pd.DataFrame, Floats]:
    """A sphere of 10 um, 2 kPa, 1 mJ/m2, whose jumps are as high as its force; and its force without the noise."""
    force = jkr(2e3, 1e-5, 1e-3, -(steps + 1e-7))
    noisy = force + noise * np.abs(force).max() * np.random.default_rng(seed).standard_normal(force.size)
    return pd.DataFrame({"separation": steps, "force": noisy}), force


def fit_on_a_gel(
    measured: pd.DataFrame, start: dict[str, float], free: tuple[str, ...] = (MODULUS, WORK, OFFSET)
) -> Any:
    tip = Tip("jkr", 1e-6, 1.5e3)
    return rm.fit(measured, tip.scene(), free, set={MODULUS: 1.5e3, WORK: 1e-3} | start)


@pytest.mark.large
@pytest.mark.parametrize(("noise", "seed"), [(0.01, 1), large(0.01, 2), large(0.01, 3), (0.001, 1)])
def test_the_jump_lies_where_the_force_shows_it(noise: float, seed: int) -> None:
    """Loading alone, which hardly tells modulus and work apart: the residual is that of the noise, and no more."""
    steps = np.linspace(1e-6, -0.5e-6, 150)
    measured, force = on_a_gel(steps, noise, seed)
    true = float(np.sum(np.square(measured.force - force)))
    fits = [fit_on_a_gel(measured, start) for start in ({}, {MODULUS: 5e3, WORK: 2e-3})]
    for fit in fits:
        assert float(np.sum(np.square(fit.force_fitted.to_numpy() - measured.force))) < true
        assert np.flatnonzero(fit.force_fitted)[0] == np.flatnonzero(force)[0]
        assert number(fit, WORK) == pytest.approx(1e-3, rel=3.0 * noise)
        assert number(fit, MODULUS) == pytest.approx(number(fits[0], MODULUS), rel=1e-5)


@pytest.mark.large
@pytest.mark.parametrize("depth", [2e-6, large(1e-5)])
def test_every_start_leads_to_one_minimum(depth: float) -> None:
    down = np.linspace(depth, -depth, 150)
    measured, force = on_a_gel(np.concatenate([down, down[::-1]]), 0.01, 1)
    starts = [{}, {MODULUS: 3e3}, {MODULUS: 750.0, WORK: 5e-4}, {MODULUS: 6e3, WORK: 2e-3}]
    fits = [fit_on_a_gel(measured, start) for start in starts]
    assert float(np.sum(np.square(fits[0].force_fitted.to_numpy() - measured.force))) < np.sum(
        (measured.force - force) ** 2
    )
    for key, error in ((MODULUS, 0.0), (WORK, 0.0), (OFFSET, 1e-3 * number(fits[0], OFFSET, "_standard_error"))):
        found = [number(fit, key) for fit in fits]
        assert found == pytest.approx([found[0]] * len(fits), rel=1e-5, abs=error)


@pytest.mark.large
@pytest.mark.parametrize("seed", [0, large(1), large(2)])
def test_the_offset_alone_is_the_best_of_all(seed: int) -> None:
    """Each jump that it moves over a step bounds it, since no other parameter can make up for that."""
    down = np.linspace(1e-5, -1e-5, 150)
    steps = np.concatenate([down, down[::-1]])
    measured, _ = on_a_gel(steps, 0.01, seed)
    fit = fit_on_a_gel(measured, {}, (OFFSET,))

    def cost(force: Floats) -> float:
        return float(np.sum(np.square(force - measured.force.to_numpy())))

    scanned = [cost(jkr(2e3, 1e-5, 1e-3, -(steps + offset))) for offset in np.linspace(-1e-7, 3e-7, 2001)]
    assert cost(fit.force_fitted.to_numpy()) < min(scanned) * (1.0 + 1e-9)


@pytest.mark.large
@pytest.mark.parametrize("free", COMBINATIONS["jkr"], ids="-".join)
def test_rows_from_last_to_first_are_doubted(free: list[str]) -> None:
    """Unloading that is saved as if it were loading, whose contact is made where it should be lost."""
    tip, up = Tip("jkr", 1e-6, 2e6), np.linspace(-2e-6, 1e-6, 60)
    force = tip.law(2e6, tip.work, -np.concatenate([up[::-1], up]))[up.size :]
    noise = 0.005 * np.abs(force).max() * np.random.default_rng(1).standard_normal(force.size)
    measured = pd.DataFrame({"separation": up, "force": force + noise})
    start = tip.start(np.random.default_rng(2), free)
    right, wrong = (rm.fit(rows, tip.scene(), free, set=start) for rows in (measured, measured[::-1]))
    assert "last row" not in right.attrs.get("warnings", "")
    assert re.search("read from its last row to its first the curve is fitted better, to 0.4", wrong.attrs["warnings"])


@pytest.mark.large
def test_behind_a_cantilever() -> None:
    """A column of the piezo: its far end comes nearer as it grows, and the tip jumps on and off."""
    tip, steps = Tip("jkr", 1e-7, 1e6), np.linspace(3e-7, -1.5e-7, 60)
    scene = tip.scene(path={"machine_stiffness": 0.3 * 1e6 * 1e-7})
    remote = np.concatenate([steps, steps[::-1]])
    force = rm.run(scene | {"path": scene["path"] | {"remote": remote.tolist()}}).force.to_numpy().ravel()
    noise = 0.005 * np.abs(force).max() * np.random.default_rng(2).standard_normal(force.size)
    measured = pd.DataFrame({"piezo [nm]": 1e9 * (-remote - 4e-8), "force": force + noise})
    fit = rm.fit(measured, scene, [MODULUS, WORK, OFFSET], set={MODULUS: 1.4e6})
    assert all(inside(fit, key, value) for key, value in tip.true(-4e-8).items())
    assert "remote" in fit.coords


@pytest.mark.large
def test_the_error_of_the_law_moves_the_modulus_alike_behind_a_spring() -> None:
    """The modulus takes up an error that is one of all forces at given separation, however soft the spring is."""
    tip, depth = Tip("hertz", 1e-7, 2e6), np.linspace(-1e-7, 1e-7, 60)
    force = tip.law(2e6, 0.0, depth)
    noise = 1e-3 * force.max() * np.random.default_rng(1).standard_normal(force.size)
    frame = pd.DataFrame({"separation": -depth, "force": force + noise})
    expected = number(rm.fit(frame, tip.scene(), [MODULUS, OFFSET]), MODULUS, "_model_error")
    for spring in (0.1, 10.0):  # of 2 E* times the scale
        stiffness = spring * 2e6 * 1e-7
        scene = tip.scene(path={"machine_stiffness": stiffness})
        frame = pd.DataFrame({"remote": -depth - force / stiffness, "force": force + noise})
        fit = rm.fit(frame, scene, [MODULUS, OFFSET])
        assert number(fit, MODULUS, "_model_error") == pytest.approx(expected, rel=0.02)


@pytest.mark.parametrize("touching", [1, 2, 3])
def test_no_more_points_than_parameters_tell_no_error(touching: int) -> None:
    """Points before the contact agree with any law: they are none of those that tell the noise."""
    tip = Tip("hertz", 1e-7, 2e6)
    depth = np.concatenate([np.linspace(-2e-7, -1e-8, 6), np.linspace(4e-8, 1e-7, touching)])
    frame = pd.DataFrame({"separation": -depth, "force": tip.law(2.1e6, 0.0, depth)})
    if touching < 3:
        with pytest.raises(OutOfRange, match=f"only {touching} of {6 + touching} points depend on them"):
            rm.fit(frame, tip.scene(), [MODULUS, OFFSET])
    else:
        assert inside(rm.fit(frame, tip.scene(), [MODULUS, OFFSET]), MODULUS, 2.1e6)


def test_compression_of_the_other_sign_is_told() -> None:
    tip, depth = Tip("hertz", 1e-7, 2e6), np.linspace(-1e-7, 1e-7, 30)
    frame = pd.DataFrame({"separation": -depth, "force": -tip.law(2e6, 0.0, depth)})
    with pytest.raises(OutOfRange, match="force is mostly negative, and compression is positive"):
        rm.fit(frame, tip.scene(), [MODULUS, OFFSET])


def test_what_no_point_tells_is_not_known_without_noise() -> None:
    tip, depth = Tip("hertz", 1e-7, 2e6), np.linspace(-1e-7, 1e-7, 30)
    frame = pd.DataFrame({"separation": -depth, "force": tip.law(2e6, 0.0, depth)})
    fit = rm.fit(frame, tip.scene(), [MODULUS, "asperities.radius", OFFSET], set={MODULUS: 1e6})
    assert number(fit, MODULUS, "_standard_error") > 2e6
    assert number(fit, OFFSET, "_standard_error") < 1e-12
    assert describe_fit(Labelled.of(fit)).count("not determined") == 2


def test_an_offset_far_away_is_shown_to_its_error() -> None:
    tip, depth = Tip("hertz", 1e-7, 2e6), np.linspace(-1e-7, 1e-7, 60)
    force = tip.law(2e6, 0.0, depth)
    noise = 1e-3 * force.max() * np.random.default_rng(1).standard_normal(force.size)
    fit = rm.fit(pd.DataFrame({"separation": -depth - 37e-6, "force": force + noise}), tip.scene(), [OFFSET])
    low, high = re.search(r"\(([\d.]+) to ([\d.]+) um\)", describe_fit(Labelled.of(fit))).groups()  # type: ignore[union-attr]
    assert 0.9 < (float(high) - float(low)) / 1e6 / (number(fit, OFFSET, "_high") - number(fit, OFFSET, "_low")) < 1.1


@pytest.mark.large
@pytest.mark.parametrize("stated", [True, False], ids=["stated", "unstated"])
@pytest.mark.parametrize("kind", COMBINATIONS)
def test_intervals_hold_the_true_values(kind: str, stated: bool) -> None:
    """Draws of each combination with each noise, from nanometres to millimetres.

    Each parameter's share is within three standard deviations of 95 %, those of as many draws.
    """
    hits = dict[str, list[bool]]()
    cases = product(enumerate(COMBINATIONS[kind]), enumerate(NOISES), range(20 if kind == "jkr" else 40))
    for (combination, free), (which, noise), seed in cases:
        scale, modulus = SCALES[seed % len(SCALES)]
        tip, rng = Tip(kind, scale, modulus), np.random.default_rng([seed, which, combination, stated])
        offset = rng.uniform(-0.3, 0.3) * scale if OFFSET in free else 0.0
        measured = tip.measure(rng, 300, (noise, 0.01), offset)
        columns = ["separation", "force", *(["force_error"] if stated else [])]
        fit = rm.fit(measured[columns], tip.scene(), free, set=tip.start(rng, free))
        for key in free:
            hits.setdefault(key, []).append(inside(fit, key, tip.true(offset)[key]))
    for key, each in hits.items():
        assert abs(np.mean(each) - 0.95) <= 3.0 * np.sqrt(0.05 * 0.95 / len(each)), (key, np.mean(each))

"""The three estimators: the expected law against a slow twin, evenly spread draws, refusals, and their results."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy.stats
import xarray as xr
from forms import large
from oracles.expected_paraboloids import Rough
from scenes import ASPERITIES, SCENE, scene

import roughmdr as rm
from roughmdr.ensemble import Ensemble
from roughmdr.scene import read

UM, MODULUS = 1e-6, 4e6
PATH: dict[str, Any] = {"separation": {"start": "4 sigma", "stop": "-0.5 sigma", "steps": 50}}
AT_ZERO = {"separation": ["0 um"]}
EXPONENTIAL = {"distribution": "expon", "loc": 0.0, "scale": UM}


def asperities(**changes: Any) -> dict[str, Any]:
    """The asperities of the small scenes with entries replaced; None leaves one out."""
    return {key: value for key, value in {**ASPERITIES, **changes}.items() if value is not None}


def run(estimator: str, **changes: Any) -> xr.Dataset:
    changes = {"material": {"effective_modulus": MODULUS}, "path": PATH, **changes}
    return rm.run(
        scene(**{"batch": {"estimator": estimator, "realizations": changes.pop("realizations", 1)}, **changes})
    )


@pytest.mark.large
@pytest.mark.parametrize(
    ("rough", "steps"),
    [
        (Rough("normal", UM, 50 * UM, 5 * UM, MODULUS), (30, 49)),
        (Rough("normal", UM, 50 * UM, 5 * UM, MODULUS, 0.05), (30, 80)),
        large(Rough("exponential", UM, 50 * UM, 100 * UM, MODULUS, 0.05), (0, 49)),
    ],
)
def test_the_expected_law_is_the_double_integral(rough: Rough, steps: tuple[int, ...]) -> None:
    """On the way in, and on the way back where every tip has begun to let go."""
    radius = {"distribution": "lognormal", "mean": rough.radius, "std": rough.radius_std}
    height = EXPONENTIAL if rough.heights == "exponential" else ASPERITIES["height"]
    law = run(
        "expected",
        asperities=asperities(height=height, radius=radius),
        adhesion={"model": "jkr", "work": rough.work},
        path={**PATH, "unload": max(steps) >= PATH["separation"]["steps"]},
    ).isel(realization=0)
    largest, closest = float(np.abs(law.force).max()), float(law.separation.min())
    assert float(law.numerical_error) < 1e-10
    for step in steps:
        turned = closest if law.branch[step] == "unloading" else None
        force = ASPERITIES["count"] * rough.force(float(law.separation[step]), turned, digits=13)
        assert float(law.force[step]) == pytest.approx(force, abs=float(law.numerical_error) * largest)


def stratified(count: int, seed: int = 3, realization: int = 0, **changes: Any) -> Ensemble:
    section = read(scene(asperities=asperities(count=count, **changes), path=AT_ZERO)).asperities
    return section.ensemble(seed, realization, stratified=True)


@pytest.mark.large
def test_stratified_asperities_are_from_the_same_distribution_but_more_even() -> None:
    count, spread = 1000, np.sqrt(np.log(1.01))
    radii = scipy.stats.lognorm(spread, scale=50 * UM / np.sqrt(1.01))
    for correlation, rank in ((None, 0.0), ({"radius": 0.6}, 0.6)):
        drawn = stratified(count, correlation=correlation)
        assert scipy.stats.kstest(drawn.height / UM, "norm").statistic < 4.0 / count
        assert scipy.stats.kstest(drawn.parameters["radius"], radii.cdf).statistic < 20.0 / count
        together = scipy.stats.spearmanr(drawn.height, drawn.parameters["radius"]).statistic
        assert together == pytest.approx(rank, abs=0.01)
    means = [float(np.mean(stratified(7, realization=number).height)) for number in range(400)]
    assert np.mean(means) == pytest.approx(0.0, abs=4.0 * np.std(means) / 20.0)  # even a few of them are unbiased


def test_the_bits_of_stratified_draws_hang_on_seed_and_realisation_alone() -> None:
    table = scene(asperities=asperities(count=100), batch={"estimator": "stratified", "realizations": 5})
    first = rm.run(table).force
    assert len(np.unique(first.isel(step=39))) == 5
    assert (rm.run({**table, "seed": 8}).force.isel(step=39) != first.isel(step=39)).all()
    placed = stratified(64, placement="hexagonal")
    np.testing.assert_array_equal(placed.height, stratified(64).height)


def rms(estimator: str, count: int, exact: xr.DataArray, **changes: Any) -> float:
    """Return the r.m.s. error of 16 realisations along the path, over the largest force of an asperity."""
    found = run(estimator, realizations=16, asperities=asperities(count=count), **changes).force / count
    return float(np.sqrt(((found - exact) ** 2).mean()) / np.abs(exact).max())


@pytest.mark.large
@pytest.mark.parametrize("adhesion", [None, SCENE["adhesion"]])
def test_stratified_is_nearer_than_sampled_and_of_first_order(adhesion: dict[str, Any] | None) -> None:
    exact = run("expected", adhesion=adhesion).force[0] / ASPERITIES["count"]
    assert rms("sampled", 1024, exact, adhesion=adhesion) > 5.0 * rms("stratified", 1024, exact, adhesion=adhesion)
    counts = 2 ** np.arange(6, 13)
    errors = [rms("stratified", int(count), exact, adhesion=adhesion) for count in counts]
    assert np.polyfit(np.log(counts), np.log(errors), 1)[0] < -0.8


FROM_FILE = dict.fromkeys(("shape", "count", "patch", "height", "radius"))


@pytest.mark.parametrize(
    ("estimator", "changes", "reason"),
    [
        ("expected", {"realizations": 2}, "realizations: must be 1 with estimator 'expected'"),
        (
            "expected",
            {"asperities": asperities(correlation={"radius": 1.0})},
            "the height alone determines the parameter",
        ),
        (
            "expected",
            {"asperities": asperities(correlation={"radius": -1.0})},
            "the height alone determines the parameter",
        ),
        ("expected", {"source": "file"}, "cannot be 'expected': nothing of source 'file' is drawn"),
        ("expected", {"source": "surface"}, "cannot be 'expected': nothing of source 'surface' is drawn"),
        ("stratified", {"source": "file"}, "cannot be 'stratified': nothing of source 'file' is drawn"),
    ],
)
def test_refusals(tmp_path: Path, estimator: str, changes: dict[str, Any], reason: str) -> None:
    if source := changes.pop("source", None):
        rm.generate(ASPERITIES, seed=1).to_netcdf(tmp_path / "made.nc")
        changes["asperities"] = asperities(**FROM_FILE, source=source, file=str(tmp_path / "made.nc"))
    with pytest.raises(rm.SceneError, match=reason):
        run(estimator, path=AT_ZERO, **changes)


def test_equal_heights_can_be_stratified() -> None:
    law = run("stratified", asperities=asperities(height="1 um"), path=AT_ZERO, adhesion=None)
    plain = 4.0 / 3.0 * MODULUS * UM**1.5 * stratified(1000, height="1 um").parameters["radius"] ** 0.5
    assert law.force.item() == pytest.approx(plain.sum(), rel=1e-4)


def test_sweeps_and_statistics_of_the_expected_law() -> None:
    sweep: dict[str, Any] = {"adhesion.work": [0.0, 0.05], "asperities.count": [50, 200]}
    curves = run("expected", sweep=sweep)
    assert curves.force.dims == ("adhesion_work", "asperities_count", "realization", "step")
    assert "random draws: batch.estimator is 'expected'" in curves.attrs["left_out"]
    np.testing.assert_allclose(curves.force[:, 1], 4.0 * curves.force[:, 0], rtol=1e-12)
    kept = run("expected", sweep=sweep, output={"keep": "statistics"})
    np.testing.assert_array_equal(kept.force_mean, curves.force.isel(realization=0))
    assert (kept.realization_count == 1.0).all()
    np.testing.assert_array_equal(kept.numerical_error, curves.numerical_error.isel(realization=0))

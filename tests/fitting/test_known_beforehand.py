"""Bounds and priors: against scipy, in other units, in the limits of much and of little knowledge."""

from contextlib import nullcontext
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
import tomli_w
import xarray as xr
from command import roughmdr
from scipy.optimize import least_squares
from tips import MODULUS, OFFSET, WORK, Floats, Tip

import roughmdr as rm

FREE = [MODULUS, OFFSET]
TIP = Tip("hertz", 1e-7, 1e6)
STATED = ["separation", "force", "force_error"]
PRIOR = ("1.5 MPa", "50 kPa")


@cache
def measured(points: int = 200, noise: float = 0.02) -> pd.DataFrame:
    return TIP.measure(np.random.default_rng(3), points, ("constant", noise), 2e-8)


def fit(columns: list[str] = STATED, **options: Any) -> xr.Dataset:
    return rm.fit(measured()[columns], TIP.scene(), FREE, **options)


def test_a_prior_is_one_more_measurement_as_in_scipy() -> None:
    steps, force, error = (measured()[name].to_numpy() for name in STATED)

    def deviations(x: Floats) -> Floats:
        curve = (TIP.law(1e6 * np.exp(x[0]), 0.0, -(steps + 1e-7 * x[1])) - force) / error
        return np.append(curve, (1e6 * np.exp(x[0]) - 1.5e6) / 5e4)

    best = least_squares(deviations, [0.1, 0.1], x_scale="jac", ftol=1e-14, xtol=1e-14, gtol=1e-14)
    covariance = np.linalg.inv(best.jac.T @ best.jac)
    found = fit(priors={MODULUS: PRIOR})
    assert float(found.material_modulus) == pytest.approx(1e6 * np.exp(best.x[0]), rel=1e-5)
    assert float(found.offset) == pytest.approx(1e-7 * best.x[1], rel=1e-5)
    error_of_modulus = float(found.material_modulus) * np.sqrt(covariance[0, 0])
    assert float(found.material_modulus_standard_error) == pytest.approx(error_of_modulus, rel=1e-3)
    assert found.attrs["intervals"] == "95 %, by the stated errors; with the prior material.modulus = 1.5 ± 0.05 MPa"


@pytest.mark.large
@pytest.mark.parametrize("columns", [STATED, STATED[:2]], ids=["stated", "unstated"])
def test_little_known_changes_nothing_and_much_decides(columns: list[str]) -> None:
    without = fit(columns)
    little, much = (fit(columns, priors={MODULUS: (1.5e6, spread)}) for spread in (1e13, 1.0))
    for name in ("material_modulus", "material_modulus_low", "material_modulus_high", "offset"):
        assert float(little[name]) == pytest.approx(float(without[name]), rel=1e-6)
    assert float(much.material_modulus) == pytest.approx(1.5e6, rel=1e-5)
    assert float(much.material_modulus_high - much.material_modulus) == pytest.approx(1.96, rel=0.01)


@pytest.mark.large
def test_priors_tell_apart_what_the_curve_does_not() -> None:
    free = [MODULUS, "asperities.radius"]
    start = {"asperities.radius": 1.3e-6}
    found = rm.fit(measured()[STATED], TIP.scene(), free, set=start, priors={"asperities.radius": ("1 um", "20 nm")})
    alone = rm.fit(measured(), TIP.scene(), [MODULUS])
    assert "warnings" not in found.attrs or "does not tell" not in found.warnings
    share = float(found.material_modulus_standard_error / found.material_modulus) ** 2
    rest = float(alone.material_modulus_standard_error / alone.material_modulus) ** 2
    assert share == pytest.approx(rest + (0.5 * 0.02) ** 2, rel=0.1)  # E goes with R^(-1/2)


@pytest.mark.large
def test_bounds_limit_value_and_interval_and_the_search_begins_within_them() -> None:
    bounds = {MODULUS: ("1.2 MPa", "2 MPa"), OFFSET: ("30 nm", 1e-7)}
    found = fit(bounds=bounds)
    for key, (low, high) in {"material_modulus": (1.2e6, 2e6), "offset": (3e-8, 1e-7)}.items():
        ends = [float(found[f"{key}{end}"]) for end in ("_low", "", "_high")]
        assert low * (1.0 - 1e-9) <= ends[0] <= ends[1] <= ends[2] <= high * (1.0 + 1e-9)
    assert "ended at the bound" in found.warnings
    wide = fit(bounds={MODULUS: ("1 kPa", "1 GPa"), OFFSET: ("-1 um", "1 um")})
    free = fit()
    assert float(wide.material_modulus) == pytest.approx(float(free.material_modulus), rel=1e-6)
    array = fit(bounds={MODULUS: np.array([1.2e6, 2e6]), OFFSET: np.array([3e-8, 1e-7])})
    assert float(array.material_modulus) == float(found.material_modulus)
    far = rm.fit(measured(), TIP.scene(), FREE, set={MODULUS: "1 Pa"}, bounds={MODULUS: ("0.5 MPa", "2 MPa")})
    assert float(far.material_modulus) == pytest.approx(float(free.material_modulus), rel=1e-6)


@pytest.mark.few(1)
@pytest.mark.parametrize("columns", [STATED, STATED[:2]], ids=["stated", "unstated"])
@pytest.mark.parametrize("bounds", [("1.5 MPa", "2 MPa"), (2e5, 5e5), (7e5, 7e5 * (1.0 + 1e-5))])
def test_a_bound_that_is_met_has_the_error_of_the_law_there(columns: list[str], bounds: tuple[Any, Any]) -> None:
    """The force is proportional to the modulus: its error is the same anywhere, but for that of a misfit."""
    with pytest.warns(rm.LimitWarning, match="ended at the bound"):
        met = rm.fit(measured()[columns], TIP.scene(), [MODULUS], bounds={MODULUS: bounds})
    assert "hardly determines" not in met.warnings
    if columns == STATED:
        alone = rm.fit(measured(), TIP.scene(), [MODULUS])
        ratio = float(met.material_modulus_standard_error / alone.material_modulus_standard_error)
        assert ratio == pytest.approx(1.0, rel=1e-3)
    assert 0.0 < float(met.material_modulus_standard_error) < float(met.material_modulus)


@pytest.mark.parametrize("high", [0.5, 2.0])
def test_a_low_bound_may_be_0(high: float) -> None:
    """For a work that starts beyond both bounds."""
    tip = Tip("jkr", 1e-7, 1e6)
    noisy = tip.measure(np.random.default_rng(3), 60, ("constant", 0.01), 0.0)
    start, bounds = {WORK: 3.0 * tip.work}, {WORK: (0, high * tip.work)}
    with nullcontext() if high > 1.0 else pytest.warns(rm.LimitWarning, match="adhesion.work ended at the bound"):
        found = rm.fit(noisy, tip.scene(), [WORK], set=start, bounds=bounds)
    assert float(found.adhesion_work) == pytest.approx(min(high, 1.0) * tip.work, rel=0.02)


@pytest.mark.parametrize(
    ("known", "message"),
    [
        ({"bounds": {"adhesion.work": (1, 2)}}, "bounds, priors: adhesion.work: is not free"),
        ({"bounds": None}, "bounds is None; it must be a dict with two numbers for each key"),
        ({"priors": [(1, 2)]}, r"priors is \[\(1, 2\)\]; it must be a dict"),
        ({"bounds": {MODULUS: np.array(5.0)}}, "has bounds = 5.0; expected two numbers"),
        ({"priors": {1: (1, 2)}}, r"priors is \{1: \(1, 2\)\}; it must be a dict"),
        ({"bounds": {MODULUS: ({"mean": 1}, 2)}}, "expected two numbers"),
        ({"shared": 5}, "shared is 5; it must be a key of the scene, or several"),
        ({"shared": [None]}, r"shared is \[None\]; it must be a key"),
        ({"bounds": {MODULUS: (1,)}}, r"free: material.modulus: has bounds = \(1,\); expected two numbers"),
        ({"bounds": {MODULUS: ("2 MPa", "1 MPa")}}, "the first must be below the second"),
        ({"bounds": {MODULUS: (-1, 1)}}, r"has bounds = \(-1, 1\): must be above 0"),
        ({"priors": {MODULUS: ("2 MPa", 0)}}, r"has prior = \('2 MPa', 0\): must be above 0"),
        ({"priors": {MODULUS: ("2 MPa", "10 %")}}, "unknown unit '%'; expected a unit of Pa.*, not a percentage"),
        ({"priors": {OFFSET: ("2 um", "1 Pa")}}, "offset: has prior = .*: 'Pa' is a unit of Pa"),
    ],
)
def test_what_cannot_be_known_is_refused(known: dict[str, Any], message: str) -> None:
    with pytest.raises(rm.SceneError, match=message):
        fit(**known)


def test_the_command_takes_both(tmp_path: Path) -> None:
    measured()[STATED].to_csv(tmp_path / "curve.csv", index=False)
    (tmp_path / "tip.toml").write_text(tomli_w.dumps(TIP.scene()))
    call = ["fit", "curve.csv", "tip.toml", "-o", "fit.nc", "--free", ",".join(FREE)]
    known = ["--prior", f"{MODULUS}={PRIOR[0]}+-{PRIOR[1]}", "--bounds", f"{OFFSET}=-100 nm..0.1 um"]
    assert roughmdr(*call, *known, cwd=tmp_path).returncode == 0
    known[1] = known[1].replace("+-", " ± ")  # as results have it
    assert roughmdr(*call, *known, cwd=tmp_path).returncode == 0
    with xr.open_dataset(tmp_path / "fit.nc") as found:
        expected = fit(priors={MODULUS: PRIOR}, bounds={OFFSET: (-1e-7, 1e-7)})
        assert float(found.material_modulus) == float(expected.material_modulus)
    refused = roughmdr(*call, "--bounds", f"{MODULUS}=3", cwd=tmp_path)
    assert refused.returncode == 2
    assert "material.modulus: has bounds = ['3.0']; expected two numbers" in refused.stderr

"""Doubts of priors and of curves with shared parameters: a misfit is told whatever else is known."""

from typing import Any

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from tips import MODULUS, OFFSET, Floats, Tip

import roughmdr as rm

TIP = Tip("hertz", 1e-7, 1e6)
STIFF = 2e6
PLAIN = ["separation", "force"]
STATED = [*PLAIN, "force_error"]


def curve(modulus: float, seed: int = 0, noise: str = "constant", level: float = 0.01) -> pd.DataFrame:
    return TIP._replace(modulus=modulus).measure(np.random.default_rng(seed), 200, (noise, level), 0.0)


def doubts_of(measured: Any, free: list[str], **options: Any) -> tuple[xr.Dataset, str]:
    fit = rm.fit(measured, TIP.scene(), free, **options)
    remarks = map(str, fit.remark.values) if "remark" in fit.coords else ()
    return fit, "\n".join([fit.attrs.get("warnings", ""), *remarks])


def by_separate_fits(measured: pd.DataFrame, mean: float, error: float) -> float:
    """How many standard errors a value is from that of the curve alone."""
    alone = rm.fit(measured, TIP.scene(), [MODULUS])
    own = float(alone.material_modulus_standard_error)
    return abs(float(alone.material_modulus) - mean) / float(np.hypot(own, error))


@pytest.mark.few(1)
@pytest.mark.filterwarnings("ignore::roughmdr.LimitWarning")
@pytest.mark.parametrize("columns", [STATED, PLAIN], ids=["stated", "unstated"])
@pytest.mark.parametrize("error", [1.0, 1e4])
def test_a_prior_that_the_curve_contradicts_is_told(columns: list[str], error: float) -> None:
    measured = curve(STIFF)[columns]
    _, said = doubts_of(measured, [MODULUS], priors={MODULUS: (1.9e6, error)})
    apart = by_separate_fits(measured, 1.9e6, error)
    told = float(said.partition(f"the prior of {MODULUS} is about ")[2].split()[0])
    assert told == pytest.approx(apart, rel=0.15)
    _, said = doubts_of(measured, [MODULUS], priors={MODULUS: (1e6, min(error, 1e3))})
    assert "residuals are systematic" in said


@pytest.mark.large
@pytest.mark.filterwarnings("ignore::roughmdr.LimitWarning")
@pytest.mark.parametrize("columns", [STATED, PLAIN], ids=["stated", "unstated"])
def test_curves_that_do_not_share_a_value_are_told(columns: list[str]) -> None:
    measured = {"a": curve(1e6)[columns], "b": curve(STIFF, 1)[columns]}
    fit, _ = doubts_of(measured, [MODULUS], shared=[MODULUS])
    for text in fit.remark.values:
        assert f"what the other curves tell of {MODULUS} is about" in text
        assert "residuals are systematic" in text


@pytest.mark.few(1)
@pytest.mark.parametrize("columns", [STATED, PLAIN], ids=["stated", "unstated"])
@pytest.mark.parametrize("noise", ["constant", "proportional"])
def test_no_more_than_chance_is_told(columns: list[str], noise: str) -> None:
    """With 8 right priors, and 4 curves that share a value: for each 1 in 1000 is told by chance."""
    rng, said = np.random.default_rng(4), ""
    for seed in range(8):
        prior = 1e6 * (1.0 + 0.005 * rng.standard_normal()), 5e3
        said += doubts_of(curve(1e6, seed, noise)[columns], [MODULUS, OFFSET], priors={MODULUS: prior})[1]
    measured = [curve(1e6, 50 + seed, noise)[columns] for seed in range(4)]
    said += doubts_of(measured, [MODULUS, OFFSET], shared=[MODULUS])[1]
    assert said.count("standard errors from") == 0


def test_what_the_curve_does_not_tell_contradicts_no_prior() -> None:
    measured, radius = curve(1e6)[PLAIN], "asperities.radius"
    _, said = doubts_of(measured, [MODULUS, radius], priors={radius: ("1.5 um", "1 nm")})
    assert "standard errors" not in said


def deviations_in_units(scale: float) -> Floats:
    tip = Tip("hertz", scale, 1e6)
    measured = tip.measure(np.random.default_rng(0), 60, ("constant", 0.01), 0.0)[PLAIN]
    with pytest.warns(rm.LimitWarning, match="standard errors from what this curve tells"):
        fit = rm.fit(measured, tip.scene(), [OFFSET], priors={OFFSET: (0.3 * scale, 0.01 * scale)})
    return np.array([float(fit.offset) / scale, float(fit.warnings.partition("about ")[2].split()[0])])


def test_lengths_do_not_matter() -> None:
    np.testing.assert_allclose(deviations_in_units(1e-9), deviations_in_units(1e-3), rtol=1e-5)

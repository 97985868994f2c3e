"""Draws from the posterior: as integrals of its density on a grid, and as true as they say (by simulated curves)."""

import sys
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from command import roughmdr
from forms import large
from scipy.stats import chisquare
from tips import MODULUS, OFFSET, Floats, Tip

import roughmdr as rm
from roughmdr.errors import RoughmdrError
from roughmdr.fitting import posterior
from roughmdr.fitting.fit import scene_to_fit
from roughmdr.fitting.measured import read_measured
from roughmdr.fitting.model import Model

TIP = Tip("hertz", 1e-7, 1e6)
STATED, PLAIN = ["separation", "force", "force_error"], ["separation", "force"]
TWO_SIDED = 1.96


def draws_of(fit: Any, key: str) -> Floats:
    return np.asarray(fit[f"{key.replace('.', '_')}_posterior"].values)


def measured_by(tip: Tip, seed: int = 0, points: int = 40) -> pd.DataFrame:
    return tip.measure(np.random.default_rng(seed), points, ("constant", 0.03), 0.0)


def part_of_law(scene: dict[str, Any], measured: pd.DataFrame) -> float:
    """The error that the law states, over the law: of a tip it is the same along the path."""
    model = Model(*scene_to_fit(scene, {}, read_measured(measured, 1), [MODULUS]), [MODULUS])
    return float(model.law(np.zeros(1)).model_error.curve.max())


@pytest.mark.large
@pytest.mark.parametrize("columns", [STATED, PLAIN], ids=["stated", "unstated"])
@pytest.mark.parametrize("prior", [None, large(2e4)])
def test_draws_of_a_modulus_are_those_of_its_density(columns: list[str], prior: float | None) -> None:
    """The force is linear in the modulus: the density over its logarithm and the error of the law is on a grid."""
    measured = measured_by(TIP)
    options = {"priors": {MODULUS: (1.02e6, prior)}} if prior else {}
    fit = rm.fit(measured[columns], TIP.scene(), [MODULUS], posterior=True, **options)
    logarithm, size = np.meshgrid(np.linspace(-0.2, 0.2, 801), np.linspace(-5.0, 5.0, 101), indexing="ij")
    error = part_of_law(TIP.scene(), measured) * float(fit.material_modulus) / 1e6 / TWO_SIDED
    law, read = TIP.law(1e6, 0.0, -measured.separation.to_numpy()), measured.force.to_numpy()
    told = (np.exp(logarithm) + size * error)[..., None] * law - read
    squares = np.sum(np.square(told / measured.force_error.to_numpy()), axis=-1)
    density = -0.5 * (squares if columns is STATED else len(measured) * np.log(squares)) - 0.5 * size**2
    if prior:
        density -= 0.5 * ((1e6 * np.exp(logarithm) - 1.02e6) / prior) ** 2
    weight = np.exp(density - density.max()).sum(axis=1)
    weight /= weight.sum()
    mean = weight @ logarithm[:, 0]
    spread = np.sqrt(weight @ (logarithm[:, 0] - mean) ** 2)
    found = np.log(draws_of(fit, MODULUS) / 1e6)
    independent = float(fit.attrs["posterior"].split()[1])
    assert independent > 200.0
    assert found.mean() == pytest.approx(mean, abs=4.0 * spread / np.sqrt(independent))
    assert found.std() == pytest.approx(spread, rel=4.0 / np.sqrt(independent))


@pytest.mark.large
@pytest.mark.filterwarnings("ignore::roughmdr.LimitWarning")
@pytest.mark.parametrize("columns", [STATED, PLAIN], ids=["stated", "unstated"])
def test_simulated_curves_are_where_their_draws_say(columns: list[str], monkeypatch: pytest.MonkeyPatch) -> None:
    """S. Talts et al. (2018), arXiv 1804.06788: ranks of true values among draws are even, for 50 curves."""
    monkeypatch.setattr(posterior, "_LONG", 20.0)
    scene, ranks = TIP.scene(), list[tuple[int, int]]()
    part = part_of_law(scene, measured_by(TIP))
    for seed in range(50):
        rng = np.random.default_rng([seed, columns is STATED])
        modulus, offset = 1e6 * np.exp(rng.uniform(-0.7, 0.7)), rng.uniform(-5e-9, 5e-9)
        measured = TIP.measure(rng, 30, ("constant", 0.03), 0.0)
        force = TIP.law(modulus, 0.0, -(measured.separation.to_numpy() + offset))
        noise = 0.03 * TIP.law(1e6, 0.0, np.array([TIP.scale]))[0]
        measured["force"] = force * (1.0 + rng.standard_normal() * part / TWO_SIDED) + noise * rng.standard_normal(30)
        measured["force_error"] = noise
        bounds = {MODULUS: (1e6 * np.exp(-0.7), 1e6 * np.exp(0.7)), OFFSET: (-5e-9, 5e-9)}
        fit = rm.fit(measured[columns], scene, [MODULUS, OFFSET], bounds=bounds, posterior=True)
        # the first and last draws of eight chains or more, fifteen, have sixteen ranks
        some = [draws_of(fit, key)[:, [0, -1]].ravel()[:15] for key in (MODULUS, OFFSET)]
        ranks.append(tuple(int(np.sum(each < true)) for each, true in zip(some, (modulus, offset), strict=True)))  # type: ignore[arg-type]
    for each in np.transpose(ranks):
        assert chisquare(np.bincount(each // 2, minlength=8)).pvalue > 0.01, each


@pytest.mark.large
def test_same_seed_same_draws_and_a_file_holds_them(tmp_path: Path) -> None:
    measured_by(TIP).to_csv(tmp_path / "curve.csv", index=False)
    fits = [rm.fit(tmp_path / "curve.csv", TIP.scene(), [MODULUS], posterior=True) for _ in range(2)]
    np.testing.assert_array_equal(*(draws_of(fit, MODULUS) for fit in fits))
    assert fits[0].material_modulus_posterior.dims == ("chain", "draw")
    rm.fit(tmp_path / "curve.csv", TIP.scene(), [MODULUS], out=tmp_path / "fit.nc", posterior=True)
    done = roughmdr("info", "fit.nc", cwd=tmp_path)
    assert "independent draws, with the error of the law" in done.stdout
    assert "Foreman-Mackey" in fits[0].attrs["references"]


@pytest.mark.large
@pytest.mark.filterwarnings("ignore::roughmdr.LimitWarning")
def test_exact_curves_and_unknown_numbers_end_with_finite_draws() -> None:
    """Without noise the error of the law is all that is left; a radius beside a modulus is known by bounds alone."""
    measured = measured_by(TIP)[["separation"]].assign(
        force=lambda each: TIP.law(1e6, 0.0, -each.separation.to_numpy())
    )
    fit = rm.fit(measured, TIP.scene(), [MODULUS], posterior=True)
    part = part_of_law(TIP.scene(), measured)
    assert np.log(draws_of(fit, MODULUS)).std() == pytest.approx(part / TWO_SIDED, rel=0.2)
    bounds = {"asperities.radius": (5e-7, 2e-6)}
    fit = rm.fit(measured_by(TIP), TIP.scene(), [MODULUS, "asperities.radius"], bounds=bounds, posterior=True)
    radius = draws_of(fit, "asperities.radius")
    assert radius.min() < 5.5e-7
    assert radius.max() > 1.8e-6
    assert np.std(np.log(draws_of(fit, MODULUS) * radius**0.5)) < 0.05


def test_refusals(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(rm.SceneError, match="posterior: is of one curve"):
        rm.fit({"a": measured_by(TIP)}, TIP.scene(), [MODULUS], posterior=True)
    monkeypatch.setitem(sys.modules, "emcee", None)
    with pytest.raises(RoughmdrError, match=r"posterior needs the package emcee: pip install -e '\.\[posterior\]'"):
        rm.fit(measured_by(TIP), TIP.scene(), [MODULUS], posterior=True)

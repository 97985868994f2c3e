"""The study of the stated error against the true one."""

import numpy as np
import pytest
import xarray as xr
from carried_out import CarriedOut
from oracles.gaussian_maps import gaussian_map
from studies.trust import by_boundary_elements, by_pairs, by_range_of_adhesion, errors, refined
from studies.trust.samples import QUICK as SAMPLES
from studies.trust.scenes import CASES, QUICK

import roughmdr as rm
from roughmdr.spectrum import SelfAffine

STUDIED = "trust"

MODULUS = 1e9


@pytest.mark.large
def test_scenes_are_run_compared_and_reported(studied: CarriedOut) -> None:
    assert studied.result["name"].to_numpy().tolist() == list(QUICK)
    assert all(f"| {name}" in studied.text for name in (*QUICK, *SAMPLES))


@pytest.mark.large
def test_a_trap_is_refused_and_the_force_of_the_others_is_bounded(studied: CarriedOut) -> None:
    refused = studied.result["oracle"].to_numpy() == "none"
    assert refused.any()
    assert (studied.result["exit_status"].to_numpy() == np.where(refused, 2, 0)).all()
    assert "MPa" in str(studied.result["printed"].to_numpy()[refused][0])
    assert np.isnan(errors(studied.result)[refused]).all()
    assert (errors(studied.result) <= studied.result["model_error"])[~refused].all()
    assert (np.char.find(studied.result["printed"].to_numpy()[~refused].astype(str), "trust  ") >= 0).all()


def test_twelve_scenes_have_a_force() -> None:
    assert sum(case.oracle != "none" for case in CASES) >= 12


def hexagonal() -> xr.Dataset:
    section = {
        "source": "random", "shape": "paraboloid", "count": 12, "patch": 2e-3, "radius": 0.5e-3,
        "placement": "hexagonal", "vacancies": True, "height": {"distribution": "normal", "std": 1e-8},
    }  # fmt: skip
    return rm.generate(section, seed=1)


def test_oracles_agree_on_contacts_far_apart() -> None:
    """Pairs are right to the third power of radius over distance; boundary elements to some per mille."""
    ensemble, h = hexagonal(), -2e-6
    pairs = by_pairs(ensemble, MODULUS, 0.0, h)
    alone = float(rm.load_separation(ensemble, separation=[h], effective_modulus=MODULUS)["force"][0])
    assert by_boundary_elements(ensemble, 256, MODULUS, h) == pytest.approx(pairs, rel=0.005)
    assert pairs > 1.05 * alone


def test_the_range_of_adhesion_matters_less_where_jkr_holds() -> None:
    path = np.linspace(3e-8, -3e-8, 40)
    soft, stiff = (by_range_of_adhesion(hexagonal(), modulus, 0.05, path) for modulus in (1e6, 1e9))
    assert abs(soft) < 0.1 * abs(stiff)


def test_a_refined_map_has_its_points_and_its_waves() -> None:
    spectrum = SelfAffine.of(hurst=0.8, long_wave=1.0, short_wave=0.1, rms_height=1.0)
    height = gaussian_map(spectrum, 32, 1.0, 3)
    fine = refined(height, 4)
    np.testing.assert_allclose(fine[::4, ::4], height, rtol=0.0, atol=1e-12)
    assert np.std(fine) == pytest.approx(np.std(height), rel=1e-12)

"""The expected law under a machine: the separations that it finds have the demand of the machine."""

import numpy as np
import pytest

import roughmdr as rm

SCENE = {
    "title": "A film",
    "material": {"effective_modulus": "4 MPa"},
    "asperities": {
        "source": "random",
        "shape": "paraboloid",
        "count": 5000,
        "patch": "1 mm",
        "height": {"distribution": "normal", "std": "1 um"},
        "radius": "10 um",
    },
    "batch": {"estimator": "expected"},
}
JKR = {"adhesion": {"model": "jkr", "work": "50 mJ/m^2"}}


def along(separation, adhesion) -> np.ndarray:
    return rm.run(SCENE | adhesion | {"path": {"separation": separation.tolist()}}).force.values[0]


@pytest.mark.few(1)
@pytest.mark.parametrize("adhesion", [{}, JKR], ids=["elastic", "jkr"])
def test_the_force_at_the_separation_is_the_load(adhesion) -> None:
    path = {"force": {"start": "0.1 mN", "stop": "5 mN", "steps": 9}, "unload": True}
    found = rm.run(SCENE | adhesion | {"path": path})
    separation = found.separation.values[0]
    assert (np.diff(separation[:9]) < 0.0).all()
    assert (np.diff(separation[9:]) > 0.0).all()
    np.testing.assert_allclose(along(separation, adhesion), found.force.values, rtol=0.0, atol=1e-9 * 5e-3)
    lag = separation[::-1] - separation  # adhesion holds the flat down
    assert (lag[:8] < 0.0).all() if adhesion else np.abs(lag).max() < 1e-12 * 1e-6


@pytest.mark.large
@pytest.mark.parametrize("stiffness", ["1 MN/m", "20 kN/m", "500 N/m"])
@pytest.mark.parametrize("adhesion", [{}, JKR], ids=["elastic", "jkr"])
def test_the_spring_bears_the_force(adhesion, stiffness) -> None:
    path = {"remote": {"start": "4 um", "stop": "-1 um", "steps": 15}, "machine_stiffness": stiffness, "unload": True}
    found = rm.run(SCENE | adhesion | {"path": path})
    separation, force = found.separation.values[0], found.force.values[0]
    borne = {"1 MN/m": 1e6, "20 kN/m": 2e4, "500 N/m": 500.0}[stiffness] * (separation - found.remote.values)
    np.testing.assert_allclose(force, borne, rtol=0.0, atol=1e-8 * np.abs(force).max())
    np.testing.assert_allclose(force, along(separation, adhesion), rtol=0.0, atol=1e-12 * np.abs(force).max())


@pytest.mark.large
def test_a_large_patch_stands_where_the_expected_law_does() -> None:
    path = {"remote": {"start": "3 um", "stop": "-1 um", "steps": 12}, "machine_stiffness": "20 kN/m", "unload": True}
    batch = {"batch": {"estimator": "stratified", "realizations": 20}}
    expected, drawn = rm.run(SCENE | JKR | {"path": path}), rm.run(SCENE | JKR | batch | {"path": path})
    mean = drawn.separation.mean("realization")
    error = drawn.separation.std("realization") / np.sqrt(19.0)
    off = np.abs(mean - expected.separation[0])
    assert (off <= 5.0 * error + 1e-3 * np.ptp(mean.values)).all()


def test_energies_that_jumps_lose_are_refused() -> None:
    path = {"force": {"stop": "1 mN", "steps": 3}}
    with pytest.raises(rm.SceneError, match="dissipated_energy of an expected law under a machine"):
        rm.run(SCENE | JKR | {"path": path, "output": {"variables": ["force", "dissipated_energy"]}})

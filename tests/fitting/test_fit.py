"""Fits: from starts far off, in any units, with what is not determined told, and against another code."""

import copy
from typing import Any

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from forms import large
from measurements import BOTH, CASES, DOWN, Case, inside, noise_of, plain_scene
from scipy.optimize import curve_fit

import roughmdr as rm
from roughmdr.fitting.words import describe_fit
from roughmdr.storage.labelled import Labelled


def fit_once(case: Case, factors: dict[str, float], **more: Any) -> xr.Dataset:
    force = case.force()
    measured = case.measure(noise_of("constant", force), force, seed=3)
    return rm.fit(measured, case.scene, list(case.true), set=case.start(factors), **more)


@pytest.mark.few(1)
@pytest.mark.parametrize("factors", [(3.0, 3.0), (3.0, 1 / 3), (1 / 3, 3.0), (1 / 3, 1 / 3)])
@pytest.mark.parametrize("name", ["adhesive", "elastic", "zero"])
def test_starts_off_by_three_converge(name: str, factors: tuple[float, float]) -> None:
    case = CASES[name]
    near = fit_once(case, {})
    far = fit_once(case, dict(zip(case.true, factors, strict=False)))
    for key, value in case.true.items():
        name = key.replace(".", "_")
        assert float(far[name]) == pytest.approx(float(near[name]), rel=1e-4)
        assert float(far[name]) == pytest.approx(value, rel=0.1)
    assert float(far.residual_rms) == pytest.approx(0.01, rel=0.3)
    assert "warnings" not in far.attrs or name == "offset"


@pytest.mark.parametrize("scale", [1e-9, large(1.0)])
def test_shares_and_times_of_relaxation(scale: float) -> None:
    """A tip that comes, waits and goes in a second."""
    share, time = "viscoelastic.relaxation[0].share", "viscoelastic.relaxation[0].time"
    asperities = {"source": "random", "shape": "paraboloid", "count": 1, "patch": 100 * scale, "height": 0}
    down = np.linspace(0.2, -1.0, 40) * scale
    terms = [{"share": 0.4, "time": 0.1}, {"share": 0.1, "time": 20.0}]
    scene = {
        "title": "t",
        "asperities": asperities | {"radius": 10 * scale},
        "material": {"modulus": 1e6, "poisson": 0.5},
        "viscoelastic": {"relaxation": terms, "speed": 3 * scale},
        "batch": {"estimator": "expected"},
    }
    steps = np.concatenate([down, np.full(10, -scale), down[::-1]])
    dwelling = scene | {"viscoelastic": scene["viscoelastic"] | {"dwell": 0.5}, "path": {"separation": steps.tolist()}}
    force = rm.run(dwelling).force.to_numpy().ravel()
    noisy = force + 0.01 * force.max() * np.random.default_rng(1).standard_normal(force.size)
    measured = pd.DataFrame({"separation": steps, "force": noisy})
    start = {share: 0.2, time: 0.3, "material.modulus": 2e6}
    found = rm.fit(measured, dwelling, [share, time, "material.modulus"], set=start)
    for key, value in ((share, 0.4), (time, 0.1), ("material.modulus", 1e6)):
        name = key.replace("].", "_").replace("[", "_").replace(".", "_")
        assert abs(float(found[name]) - value) < 4.0 * float(found[f"{name}_standard_error"])
        assert float(found[f"{name}_standard_error"]) < 0.2 * value
        assert key in describe_fit(Labelled.of(found))
    assert inside(found, "material.modulus", 1e6)
    with pytest.raises(rm.SceneError, match=r"viscoelastic\.relaxation\[2\]\.time"):
        rm.fit(measured, dwelling, ["viscoelastic.relaxation[2].time"])


@pytest.mark.large
def test_on_a_machine() -> None:
    case = CASES["machine"]
    fit = fit_once(case, {"adhesion.work": 1.5, "material.modulus": 0.7})
    assert list(fit.remote.dims) == ["point"]
    for key, value in case.true.items():
        assert float(fit[key.replace(".", "_")]) == pytest.approx(value, rel=0.1)
        assert inside(fit, key, value)


@pytest.mark.few(1)
@pytest.mark.parametrize("scale", [1e-3, 1e6])
def test_other_scales_are_fitted_alike(scale: float) -> None:
    """From nanometres to metres, and from pascals to gigapascals."""
    case = CASES["adhesive"]
    force, table = case.force(), copy.deepcopy(case.scene)
    measured = case.measure(noise_of("constant", force), force)
    plain = rm.fit(measured, case.scene, list(case.true), set=case.start({"adhesion.work": 2.0}))
    table["asperities"] |= {"patch": 1e-3 * scale, "radius": 50e-6 * scale}
    table["asperities"]["height"]["std"] = 1e-6 * scale
    start = {"adhesion.work": 0.1 * scale, "material.modulus": 3e6}
    scaled = rm.fit(measured * [scale, scale**2], table, list(case.true), set=start)
    assert float(scaled.adhesion_work) == pytest.approx(scale * float(plain.adhesion_work), rel=1e-6)
    assert float(scaled.material_modulus) == pytest.approx(float(plain.material_modulus), rel=1e-6)
    assert float(scaled.adhesion_work_high) == pytest.approx(scale * float(plain.adhesion_work_high), rel=1e-5)


def test_pressure_in_a_dataset_is_fitted_alike() -> None:
    case = CASES["elastic"]
    force = case.force()
    measured = case.measure(noise_of("constant", force), force)
    by_force = rm.fit(measured, case.scene, "material.modulus")
    dataset = xr.Dataset(
        {
            "separation": ("row", 1e9 * measured["separation"], {"units": "nm"}),
            "pressure": ("row", 1e3 * measured["force"], {"units": "kPa"}),
            "other": ("row", DOWN),
        }
    )
    by_pressure = rm.fit(dataset, case.scene, "material.modulus")
    assert float(by_pressure.material_modulus) == pytest.approx(float(by_force.material_modulus), rel=1e-9)
    assert by_pressure.pressure_fitted.units == "Pa"


def test_as_another_code_finds_it() -> None:
    """Greenwood and Williamson's law in scipy's curve_fit."""
    case = CASES["elastic"]
    force = case.force()
    deviation = noise_of("proportional", force)
    measured = case.measure(deviation, force)

    def law(separation: Any, modulus: float, std: float) -> Any:
        effective = rm.effective_modulus(1e6 * modulus, 0.49)
        theory = rm.theory.greenwood_williamson
        return 1e-6 * theory(
            separation=separation, effective_modulus=effective, radius=50e-6, std=1e-6 * std, density=1e9
        )

    best, covariance = curve_fit(law, DOWN, measured["force"], [2.0, 1.5], deviation, absolute_sigma=True)
    fit = rm.fit(measured.assign(force_error=deviation), case.scene, list(case.true))
    found = [float(fit.material_modulus) / 1e6, float(fit.asperities_height_std) * 1e6]
    assert found == pytest.approx(best, rel=1e-5)
    errors = [float(fit[f"{name}_standard_error"]) for name in ("material_modulus", "asperities_height_std")]
    assert [errors[0] / 1e6, errors[1] * 1e6] == pytest.approx(np.sqrt(np.diag(covariance)), rel=1e-3)
    correlation = covariance[0, 1] / np.sqrt(covariance[0, 0] * covariance[1, 1])
    assert float(fit.correlation[0, 1]) == pytest.approx(correlation, abs=1e-3)


@pytest.mark.few(1)
@pytest.mark.parametrize(
    ("free", "combination"),
    [
        (["material.modulus", "asperities.radius"], "material.modulus * asperities.radius^0.5"),
        (["asperities.radius", "material.modulus"], "asperities.radius^0.5 * material.modulus"),
        (["offset", "asperities.height.mean"], "offset - asperities.height.mean"),
        (["material.modulus", "offset"], "material.modulus * exp(offset / -"),
    ],
)
def test_parameters_that_are_not_told_apart_are_named(free: list[str], combination: str) -> None:
    table = plain_scene(adhesion=None)
    table["asperities"]["height"] = {"distribution": "normal", "mean": 0.0, "std": "1 um"}
    case = Case(table, "separation", DOWN, {})
    force = case.force()
    measured = case.measure(noise_of("constant", force), force)
    with pytest.warns(rm.LimitWarning, match="does not tell|hardly tells"):
        fit = rm.fit(measured, table, free, set={"asperities.radius": 70e-6})
    assert combination in fit.attrs["warnings"]
    assert float(fit.residual_rms) < 0.012
    assert all(np.isfinite(array).all() for array in fit.data_vars.values())
    for key in free:
        name = key.replace(".", "_")
        assert float(fit[f"{name}_low"]) <= float(fit[name]) <= float(fit[f"{name}_high"])


def test_a_scene_that_does_not_describe_the_curve_is_told() -> None:
    case = CASES["adhesive"]
    force = case.force()
    measured = case.measure(noise_of("constant", force), force)
    table = plain_scene(adhesion=None)
    with pytest.warns(rm.LimitWarning, match="systematic"):
        rm.fit(measured, table, "material.modulus")
    with pytest.warns(rm.LimitWarning, match="times the stated errors of the force"):
        rm.fit(measured.assign(force_error=1e-6), case.scene, "material.modulus")


@pytest.mark.large
def test_noise_alone_is_not_taken_for_a_fault_of_the_scene() -> None:
    case = CASES["elastic"]
    force = case.force()
    said = [
        rm.fit(case.measure(noise_of(kind, force), force, seed), case.scene, list(case.true)).attrs.get("warnings", "")
        for kind in ("constant", "proportional")
        for seed in range(10)
    ]
    assert sum("systematic" in text for text in said) == 0


def test_a_parameter_at_the_bound_of_the_scene() -> None:
    """Poisson's ratio ends at one half where the material is stiffer still."""
    case = CASES["elastic"]
    measured = pd.DataFrame({"separation": DOWN, "force": 1.5 * case.force()})
    with pytest.warns(rm.LimitWarning, match=r"material.poisson ended at the bound of what is allowed, 0.5"):
        fit = rm.fit(measured, case.scene, "material.poisson")
    assert float(fit.material_poisson) == pytest.approx(0.5, abs=1e-6)


def test_a_start_without_a_law_is_left() -> None:
    """Where the contacts would have more area than the patch."""
    case = Case(plain_scene(adhesion=None), "separation", DOWN, {"asperities.radius": 50e-6})
    force = case.force()
    fit = rm.fit(
        case.measure(noise_of("constant", force), force),
        case.scene,
        "asperities.radius",
        set={"asperities.radius": "1 mm"},
    )
    assert inside(fit, "asperities.radius", 50e-6)


def test_the_error_of_the_law_is_told_as_one_of_the_parameters() -> None:
    case = CASES["elastic"]
    fit = fit_once(case, {})
    assert 0.0 < float(fit.material_modulus_model_error) < float(fit.material_modulus)
    assert fit.trust.startswith("force within about")


def test_a_swept_key_is_freed_and_other_sweeps_are_refused() -> None:
    case = CASES["elastic"]
    force = case.force()
    measured = case.measure(noise_of("constant", force), force)
    swept = case.scene | {
        "path": {"separation": {"start": "4 sigma", "stop": 0.0, "steps": 30}},
        "sweep": {"material.modulus": ["2 MPa", "4 MPa"], "path.separation.stop": [0.0, 1e-7]},
    }
    fit = rm.fit(measured, swept, "material.modulus")
    assert inside(fit, "material.modulus", 3e6)
    with pytest.raises(rm.SceneError, match=r"sweep.material.modulus: a curve is of one scene"):
        rm.fit(measured, swept, "asperities.height.std")


def test_a_run_of_the_fitted_scene_is_the_fitted_law(tmp_path: Any) -> None:
    case = CASES["zero"]
    fit = fit_once(case, {}, out=tmp_path / "fit.nc")
    law = rm.run(tmp_path / "fit.nc")
    np.testing.assert_allclose(law.force.values.ravel(), fit.force_fitted, rtol=1e-12)
    np.testing.assert_allclose(law.separation, BOTH - case.offset + float(fit.offset), rtol=1e-12)


def test_asperities_that_are_read_have_no_expected_law(tmp_path: Any) -> None:
    table = plain_scene(adhesion=None)
    rm.generate(table["asperities"], seed=1).to_netcdf(tmp_path / "ensemble.nc")
    table["asperities"] = {"source": "file", "file": str(tmp_path / "ensemble.nc")}
    measured = pd.DataFrame({"separation": DOWN, "force": np.exp(-DOWN / 1e-6)})
    with pytest.raises(rm.SceneError, match="scene: cannot be fitted, for it has no expected law: "):
        rm.fit(measured, table, "material.modulus")


def test_a_path_without_contact_is_refused() -> None:
    far = pd.DataFrame({"separation": DOWN + 1.0, "force": np.exp(-DOWN / 1e-6)})
    with pytest.raises(rm.OutOfRange, match=r"free: material.modulus: changes nothing along the measured path"):
        rm.fit(far, plain_scene(), "material.modulus")


def test_without_noise_too() -> None:
    case = CASES["elastic"]
    measured = pd.DataFrame({"separation": DOWN, "force": case.force()})
    fit = rm.fit(measured, case.scene, list(case.true), set=case.start({"material.modulus": 2.0}))
    assert [float(fit[key.replace(".", "_")]) for key in case.true] == pytest.approx(list(case.true.values()), rel=1e-6)
    fit = rm.fit(measured, case.scene, ["material.modulus", "asperities.radius"], set={"asperities.radius": 70e-6})
    assert "does not tell material.modulus and asperities.radius apart" in fit.warnings


@pytest.mark.large
def test_three_or_more_that_are_not_told_apart() -> None:
    case = CASES["adhesive"]
    force = case.force()
    measured = case.measure(noise_of("constant", force), force)
    free = ["adhesion.work", "asperities.radius", "asperities.density", "material.modulus"]
    fit = rm.fit(measured, case.scene, free, set={"asperities.count": None, "asperities.density": 1e9})
    assert (
        "does not tell adhesion.work, asperities.radius, asperities.density and material.modulus apart" in fit.warnings
    )
    assert describe_fit(Labelled.of(fit)).count("not determined") == 4


@pytest.mark.parametrize(
    ("changes", "free", "message"),
    [
        ({}, ["adhesion.wrok"], r"free: adhesion.wrok: is no number of the scene that can be varied; did you mean"),
        ({}, ["adhesion.strength"], "free: adhesion.strength: is not in the scene"),
        ({}, ["asperities.count"], "takes whole numbers only"),
        ({}, ["adhesion.model"], "is no number of the scene"),
        ({}, ["path.separation.start"], "is no number of the scene"),
        ({}, ["asperities.height"], r"name one number in it, like asperities.height.mean"),
        ({}, ["offset", "offset"], "is given twice"),
        ({}, [], "names no key"),
        ({"adhesion.work": 0.0}, ["adhesion.work"], r"adhesion.work: is 0; it must start above 0"),
        ({"interaction": {"model": "pairwise"}, "adhesion": None}, ["material.modulus"], "no expected law: asperities"),
        ({"material.poisson": 7}, ["material.modulus"], "material.poisson = 7"),
    ],
)
def test_wrong_keys_are_refused(changes: dict[str, Any], free: list[str], message: str) -> None:
    measured = pd.DataFrame({"separation": DOWN, "force": np.exp(-DOWN / 1e-6)})
    with pytest.raises(rm.SceneError, match=message):
        rm.fit(measured, plain_scene(), free, set=changes)

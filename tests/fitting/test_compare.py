"""The adhesion model that a curve is of: chosen where it can be told, and said where it cannot."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
import tomli_w
import xarray as xr
from command import roughmdr
from forms import large
from tips import MODULUS, OFFSET, WORK, Tip

import roughmdr as rm
from roughmdr.errors import SceneError
from roughmdr.fitting.words import describe_fit
from roughmdr.storage.labelled import Labelled

TIP = Tip("jkr", 1e-7, 1e6)
RANGE = 1e-9 * float(rm.tabor(rm.Paraboloid(TIP.size), effective_modulus=1e6 / 0.75, work=TIP.work, range=1e-9))
"""Range of the attraction at Tabor number 1 [m]."""
ADHESION = {
    "none": None,
    "jkr": {"model": "jkr", "work": TIP.work},
    "dugdale": {"model": "dugdale", "work": TIP.work, "range": RANGE},
}


def measured(model: str, noise: float, seed: int = 1, points: int = 40) -> pd.DataFrame:
    down = np.linspace(2e-7, -1.5e-7, points) + 1e-10
    scene = TIP.scene(path={"separation": [*down, *down[::-1]]}, batch={"estimator": "expected"})
    adhesion = ADHESION[model]
    force = rm.run({key: each for key, each in (scene | {"adhesion": adhesion}).items() if each}).force.to_numpy()[0]
    error = noise * np.abs(force).max()
    noisy = force + error * np.random.default_rng(seed).standard_normal(force.size)
    return pd.DataFrame({"separation": [*down, *down[::-1]], "force": noisy})


def chosen(fit: Any) -> str:
    return next((name for name in ("dugdale", "jkr") if f'"{name}"' in fit.attrs["scene"]), "none")


@pytest.mark.large
@pytest.mark.parametrize("model", ["dugdale", large("jkr"), large("none")])
def test_the_right_model_is_chosen(model: str) -> None:
    """And Akaike's criterion is that of the textbook."""
    points = 30
    fit = rm.fit(measured(model, 0.003, points=points), TIP.scene(), [MODULUS, WORK], model="auto")
    assert chosen(fit) == model
    k = fit.sizes["parameter"] + 1
    expected = 2 * points * math.log(float(fit.residual_rms) ** 2) + 2 * k + 2 * k * (k + 1) / (2 * points - k - 1)
    assert expected == pytest.approx(float(fit.aicc[list(fit.model_name.values).index(model)]), rel=1e-9)
    assert list(fit.model_name.values) == ["none", "jkr", "dugdale"]
    assert dict(fit.sizes)["model"] == 3
    assert float(fit.akaike_weight.sum()) == pytest.approx(1.0)
    difference = fit.aicc - fit.aicc.min()
    assert np.exp(-0.5 * difference).values == pytest.approx((fit.akaike_weight / fit.akaike_weight.max()).values)
    assert ("adhesion_work_low" in fit) == (model != "none")
    assert ("adhesion_range" in fit) == (model == "dugdale")
    assert "material_modulus_model_error" in fit
    if model == "dugdale":
        assert fit.tabor_parameter.values == pytest.approx([0.0, math.inf, 1.0], rel=0.5)
        assert fit.adhesion_range_low <= RANGE <= fit.adhesion_range_high


@pytest.mark.large
@pytest.mark.parametrize("model", ADHESION)
def test_models_are_told_or_it_is_said_that_they_are_not(model: str) -> None:
    """JKR is the limit of Dugdale, no adhesion that of both: the simpler is not left for one that fits no better."""
    right = 0
    for seed in range(3):
        fit = rm.fit(measured(model, 0.02, seed, points=30), TIP.scene(), [MODULUS, WORK], model="auto")
        right += chosen(fit) == model
        alike = int((fit.aicc <= fit.aicc.min() + 2.0).sum())
        assert ("does not tell adhesion model" in fit.attrs.get("warnings", "")) == (alike > 1)
    assert right >= 2


@pytest.mark.large
def test_the_command_tells_and_stores_the_comparison(tmp_path: Path) -> None:
    """Without adhesion no parameter is left, and the law is that of Hertz."""
    frame = measured("jkr", 0.01, points=20)
    frame.to_csv(tmp_path / "curve.csv", index=False)
    (tmp_path / "scene.toml").write_text(tomli_w.dumps(TIP.scene()))
    arguments = ("fit", "curve.csv", "scene.toml", "-o", "fit.nc", "--free", WORK, "--model", "auto")
    done = roughmdr(*arguments, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "AICc +0, weight" in done.stdout
    with xr.open_dataset(tmp_path / "fit.nc") as fit:
        assert describe_fit(Labelled.of(fit)) in done.stdout
        assert rm.info(fit) == describe_fit(Labelled.of(fit))
        marked = [line.split() for line in done.stdout.splitlines() if line.endswith(", chosen")]
        assert [chosen(fit) in words for words in marked] == [True]
        assert not fit.model_failure.values.any()
        hertz = TIP._replace(kind="hertz").law(TIP.modulus, 0.0, -frame.separation.to_numpy())
        rms = [float(np.sqrt(np.mean(np.square(each)))) for each in (hertz - frame.force, fit.residual)]
        assert float(fit.model_residual_rms[0]) == pytest.approx(rms[0] / np.abs(frame.force).max(), rel=1e-6)
        n, k = len(frame), fit.sizes["parameter"] + 1
        more = 2 * k * n / (n - k - 1) - 2 * n / (n - 2)
        expected = 2 * n * math.log(rms[0] / rms[1]) - more
        chosen_one = list(fit.model_name.values).index(chosen(fit))
        assert float(fit.aicc[0] - fit.aicc[chosen_one]) == pytest.approx(expected, rel=1e-6)


@pytest.mark.parametrize(
    ("free", "options", "message"),
    [
        ([MODULUS, "adhesion.wrok"], {}, r"free: adhesion.wrok: is no number of the scene"),
        ([MODULUS], {"bounds": {"material.modulos": (1, 2)}}, r"material.modulos: is not free"),
        ([MODULUS, "adhesion.strength"], {}, r"free: adhesion.strength: is not in the scene"),
        ([MODULUS], {"bounds": {"adhesion.range": (2, 1)}}, r"adhesion.range: has the bounds 2 and 1"),
        ([MODULUS], {"shared": [MODULUS]}, "shared: material.modulus: must be a free key, without a prior, of several"),
        ([MODULUS], {"workers": -3}, "workers is -3; it must be a whole number"),
        ([], {}, "free: names no key"),
    ],
)
def test_what_is_wrong_for_one_model_is_so_for_all(free: list[str], options: dict[str, Any], message: str) -> None:
    scene = TIP.scene()
    scene["adhesion"] = ADHESION["dugdale"]
    frame = pd.DataFrame({"separation": np.linspace(1e-7, -1e-7, 9), "force": np.linspace(0.0, 1e-7, 9) ** 2})
    with pytest.raises(rm.RoughmdrError, match=message):
        rm.fit(frame, scene, free, model="auto", **options)


@pytest.mark.large
@pytest.mark.parametrize(
    ("bounds", "doubt"),
    [({}, 'does not tell adhesion model "jkr"'), large({WORK: (TIP.work, 1.0)}, "is fitted better")],
)
def test_a_curve_without_adhesion_leaves_nothing_free(bounds: dict[str, Any], doubt: str) -> None:
    with pytest.warns(rm.LimitWarning, match=doubt):
        fit = rm.fit(measured("none", 0.01, points=20), TIP.scene(), [WORK], model="auto", bounds=bounds)
    assert fit.aicc.values.argmin() == 0
    assert fit.parameter_name.values.tolist()[:1] == [WORK]


def test_a_model_needs_a_work_and_a_name_that_is_known() -> None:
    frame, scene = measured("jkr", 0.01), TIP.scene()
    del scene["adhesion"]
    with pytest.raises(SceneError, match=r"adhesion\.work: model 'auto' needs one above 0"):
        rm.fit(frame, scene, [MODULUS], model="auto")
    with pytest.raises(SceneError, match="model is 'jkr'; it must be 'auto' or None"):
        rm.fit(frame, TIP.scene(), [MODULUS, OFFSET], model="jkr")  # type: ignore[arg-type]

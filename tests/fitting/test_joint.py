"""One value of a parameter for many curves: against scipy, in limits, in other forms, and with honest intervals."""

from typing import Any

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from forms import large
from measurements import CASES, inside, noise_of
from scipy.optimize import least_squares
from scipy.signal import lfilter
from tips import MODULUS, OFFSET, WORK, Floats, Tip

import roughmdr as rm
from roughmdr.fitting import joint

FREE = [MODULUS, OFFSET]
TIP = Tip("hertz", 1e-7, 1e6)
OFFSETS = [2e-8, -3e-8, 1e-8]


def curves(seed: int, noise: str = "constant", offsets: list[float] = OFFSETS, points: int = 60) -> list[pd.DataFrame]:
    rng = np.random.default_rng(seed)
    return [TIP.measure(rng, points + 20 * i, (noise, 0.02), offset) for i, offset in enumerate(offsets)]


def stated(measured: list[pd.DataFrame], **options: Any) -> xr.Dataset:
    return rm.fit(measured, TIP.scene(), FREE, set={MODULUS: 1.6e6}, **options)


def test_scipy_finds_the_same() -> None:
    measured = curves(1)

    def deviations(x: Floats) -> Floats:
        return np.concatenate(
            [
                (TIP.law(1e6 * np.exp(x[0]), 0.0, -(each.separation + 1e-7 * zero)) - each.force) / each.force_error
                for each, zero in zip(measured, x[1:], strict=True)
            ]
        )

    best = least_squares(deviations, np.zeros(4), x_scale="jac", ftol=1e-14, xtol=1e-14, gtol=1e-14)
    errors = np.sqrt(np.diag(np.linalg.inv(best.jac.T @ best.jac)))
    fit = stated(measured, shared=[MODULUS])
    assert fit.material_modulus.dims == fit.material_modulus_high.dims == ()
    assert abs(np.log(float(fit.material_modulus) / 1e6) - best.x[0]) < 3e-3 * errors[0]
    assert (np.abs(fit.offset.values / 1e-7 - best.x[1:]) < 3e-3 * errors[1:]).all()
    assert float(fit.material_modulus_standard_error / fit.material_modulus) == pytest.approx(errors[0], rel=1e-3)
    np.testing.assert_allclose(fit.offset_standard_error / 1e-7, errors[1:], rtol=1e-3)
    assert "; of material.modulus, one for all, 95 %" in rm.info(fit)
    assert len(rm.plot(fit).axes) == 2  # of the offset and of the residual


@pytest.mark.parametrize("rho", [0.0, large(0.6)])
def test_the_same_curve_several_times_divides_the_variance(rho: float) -> None:
    """With noise whose correlation is found: others tell as much less as it lasts longer, to some percent."""
    one = curves(2, points=400)[0]
    rng = np.random.default_rng(5)
    noise = lfilter([1.0], [1.0, -rho], rng.standard_normal(one.force.size))
    one["force"] = TIP.law(TIP.modulus, 0.0, -(one.separation + OFFSETS[0])) + 0.02 * one.force.max() * noise
    alone, four = rm.fit(one, TIP.scene(), FREE), rm.fit([one] * 4, TIP.scene(), FREE, shared=MODULUS)
    assert ("correlated" in alone.attrs["intervals"]) == (rho > 0.0)
    assert float(four.material_modulus) == pytest.approx(float(alone.material_modulus), rel=1e-6)
    ratio = float(alone.material_modulus_standard_error / four.material_modulus_standard_error)
    assert ratio == pytest.approx(2.0, rel=1e-3 if rho == 0.0 else 0.05)


@pytest.mark.few(1)
@pytest.mark.parametrize("columns", [["separation", "force", "force_error"], ["separation", "force"]])
def test_what_one_curve_does_not_tell_others_do(columns: list[str]) -> None:
    """A radius for each curve, one modulus: only a curve whose radius a prior gives tells it."""
    measured = [each[columns] for each in curves(3, offsets=[0.0, 0.0])]
    free = [MODULUS, "asperities.radius"]
    with pytest.warns(rm.LimitWarning, match="raise doubts"):
        fit = rm.fit(measured, TIP.scene(), free, shared=free, set={MODULUS: 1.6e6})
    assert all("does not tell" in text for text in fit.remark.values)
    assert (fit.failure == "").all()


@pytest.mark.large
def test_rough_surfaces_at_any_scale() -> None:
    case, found = CASES["elastic"], list[float]()
    force = case.force()
    measured = [case.measure(noise_of("constant", force), force, seed) for seed in range(2)]
    fit = rm.fit(measured, case.scene, list(case.true), shared=["material.modulus"], set=case.start({}))
    alone = [rm.fit(each, case.scene, list(case.true), set=case.start({})) for each in measured]
    errors = [float(each.material_modulus_standard_error) for each in alone]
    assert float(fit.material_modulus_standard_error) < min(errors)
    assert inside(fit, "material.modulus", case.true["material.modulus"])
    for scale in (1e-9, 1e-3):
        tip = Tip("hertz", scale, 1e6)
        scaled = [each.assign(separation=each.separation * scale / 1e-7) for each in curves(4, offsets=[1e-8] * 3)]
        scaled = [each.assign(force=each.force * (scale / 1e-7) ** 2)[["separation", "force"]] for each in scaled]
        found.append(float(rm.fit(scaled, tip.scene(), FREE, shared=FREE, set={MODULUS: 1.6e6}).material_modulus))
    assert found[0] == pytest.approx(found[1], rel=1e-5)


def test_a_curve_that_fails_leaves_the_others() -> None:
    measured = curves(5)
    fit = stated([*measured, measured[0].iloc[:3]], shared=[MODULUS])
    assert fit.failure.values.tolist()[:3] == ["", "", ""]
    assert "3 rows" in fit.failure.values[3]
    assert float(fit.material_modulus) == float(stated(measured, shared=[MODULUS]).material_modulus)


@pytest.mark.parametrize(
    ("measured", "options", "message"),
    [
        (curves(1), {"shared": [WORK]}, f"shared: {WORK}: must be a free key"),
        (curves(1)[0], {"shared": [MODULUS]}, "of several curves"),
        (curves(1), {"shared": MODULUS, "priors": {MODULUS: (1e6, 1e5)}}, "without a prior"),
    ],
)
def test_what_cannot_be_shared_is_refused(measured: Any, options: dict[str, Any], message: str) -> None:
    with pytest.raises(rm.SceneError, match=message):
        stated(measured, **options)


def test_jumps_are_not_shared() -> None:
    tip = Tip("jkr", 1e-7, 1e6)
    measured = [tip.measure(np.random.default_rng(i), 60, ("constant", 0.01), 0.0) for i in range(2)]
    with pytest.raises(rm.SceneError, match="joint fits do not follow jumps"):
        rm.fit(measured, tip.scene(), [MODULUS, WORK], shared=[WORK])


def unlike(level: float, modulus: float, seed: int) -> pd.DataFrame:
    """A curve of a body of its own whose detector reads a level, over its largest force, without contact."""
    tip = TIP._replace(modulus=modulus)
    measured = tip.measure(np.random.default_rng(seed), 40, ("constant", 0.01), 0.0)[["separation", "force"]]
    return measured.assign(force=measured.force + level * measured.force.max())


@pytest.mark.large
@pytest.mark.filterwarnings("ignore::roughmdr.LimitWarning")
def test_curves_that_differ_come_to_the_common_value_of_least_squares() -> None:
    """A baseline for all of curves that read 0, 1/2 and -3 without contact; a modulus may end at its bound."""
    measured = [unlike(level, 1e6, i) for i, level in enumerate([0.0, 0.5, -3.0])]
    fit = rm.fit(measured, TIP.scene(), [MODULUS, "baseline"], shared=["baseline"])
    largest = [float(np.abs(each.force).max()) for each in measured]
    laws = [TIP.law(1e6, 0.0, -each.separation.to_numpy()) for each in measured]
    noise = [
        np.sqrt(np.mean(np.square(rm.fit(each, TIP.scene(), [MODULUS, "baseline"]).residual))) for each in measured
    ]

    def squares(level: float) -> float:
        total = 0.0
        for each, law, one in zip(measured, laws, noise, strict=True):
            rest = each.force.to_numpy() - level
            total += float(np.sum(np.square(rest - max(law @ rest / (law @ law), 1e-4) * law)) / one**2)
        return total

    found = float(fit.baseline)
    step = 1e-3 * max(largest)
    assert (fit.failure == "").all()
    assert squares(found) < min(squares(found - step), squares(found + step))


@pytest.mark.filterwarnings("ignore::roughmdr.LimitWarning")
def test_the_curve_that_is_farthest_off_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(joint, "_ROUNDS", 2)
    measured = {"soft": unlike(0.0, 1e6, 0), "soft too": unlike(0.0, 1e6, 1), "stiff": unlike(0.0, 1e7, 2)}
    with pytest.raises(rm.OutOfRange, match=r"no common value; .* is farthest off, by about [\d.e+]+ standard errors"):
        rm.fit(measured, TIP.scene(), FREE, shared=[MODULUS])


@pytest.mark.large
@pytest.mark.parametrize("noise", ["constant", "proportional", "alternating"])
@pytest.mark.parametrize("columns", [["separation", "force", "force_error"], ["separation", "force"]])
def test_intervals_of_a_shared_parameter_hold_it(columns: list[str], noise: str) -> None:
    """20 draws of three curves: within three standard deviations of 95 %, for the shared one and the own ones."""
    hits, own = list[bool](), list[bool]()
    for seed in range(20):
        fit = stated([each[columns] for each in curves(1000 + seed, noise)], shared=[MODULUS])
        hits.append(inside(fit, MODULUS, 1e6))
        own += [inside(fit.isel(curve=i), OFFSET, offset) for i, offset in enumerate(OFFSETS)]
    assert np.mean(hits) >= 0.95 - 3 * np.sqrt(0.05 * 0.95 / len(hits))
    assert np.mean(own) >= 0.95 - 3 * np.sqrt(0.05 * 0.95 / len(own))

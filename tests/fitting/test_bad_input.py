"""Measurements that go wrong: each fault is named in words, and no sound curve is doubted."""

import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings, strategies as st
from tips import MODULUS, OFFSET, WORK, Tip

import roughmdr as rm
from roughmdr.errors import LimitWarning, StoreError
from roughmdr.fitting.measured import read_measured

BASELINE = "baseline"
DOUBTS = ("noise along", "stays at its largest", "stays the same", "all units")


def a_curve(kind: str = "hertz", noise: float = 0.01, points: int = 300, seed: int = 0) -> tuple[Tip, pd.DataFrame]:
    tip, rng = Tip(kind, 1e-7, 1e6), np.random.default_rng(seed)
    return tip, tip.measure(rng, points, ("constant", noise), 0.0)[["separation", "force"]]


def told(tip: Tip, measured: pd.DataFrame, free: list[str]) -> str:
    with pytest.warns(LimitWarning):
        return str(rm.fit(measured, tip.scene(), free).attrs["warnings"])


@settings(max_examples=8, deadline=None)
@given(
    kind=st.sampled_from(["hertz", "cone", "jkr"]),
    noise=st.sampled_from([0.0, 1e-4, 0.003, 0.05]),
    points=st.sampled_from([12, 40, 200, 1000]),
    seed=st.integers(0, 1000),
    both=st.booleans(),
    digits=st.sampled_from([2, 4, 12]),
)
def test_a_sound_curve_is_not_doubted(kind: str, noise: float, points: int, seed: int, both: bool, digits: int) -> None:
    """Loading alone and with unloading, smooth or noisy, few points or many, rounded to two digits or not at all."""
    tip, measured = a_curve(kind, noise, points, seed)
    if both and kind != "jkr":
        measured = pd.concat([measured, measured[::-1]], ignore_index=True)
    unit = 10.0 ** (np.floor(np.log10(measured.force.max())) + 1 - digits)
    measured = measured.assign(force=np.round(measured.force / unit) * unit)
    said = rm.fit(measured, tip.scene(), [MODULUS]).attrs.get("warnings", "")
    assert not any(doubt in said for doubt in DOUBTS), said


@pytest.mark.few(1)
@pytest.mark.parametrize("seed", range(3))
def test_a_curve_without_contact(seed: int) -> None:
    tip, measured = a_curve()
    noise = 1e-9 * np.random.default_rng(seed).standard_normal(300)
    said = told(tip, measured.assign(force=noise), [MODULUS])
    assert "the force is noise along the whole curve, which shows no contact" in said
    assert "the force is noise along" in told(tip, measured.assign(force=noise - 5e-7), [MODULUS, BASELINE])


def clipped(measured: pd.DataFrame, share: float, noise: float) -> pd.DataFrame:
    """The force above a share of the largest is lost, with this noise of the rest of the detector."""
    end = share * measured.force.max()
    rest = noise * measured.force.max() * np.random.default_rng(1).standard_normal(len(measured))
    return measured.assign(force=np.where(measured.force > end, end + rest, measured.force))


@pytest.mark.parametrize(("noise", "rest"), [(0.0, 0.0), (0.002, 0.0), (0.002, 0.002)])
def test_a_detector_at_its_end(noise: float, rest: float) -> None:
    tip, measured = a_curve(noise=noise)
    said = told(tip, clipped(measured, 0.6, rest), [MODULUS, OFFSET])
    assert "the force stays at its largest, " in said
    assert "points: a detector at its end? leave these out" in said


def test_a_dwell() -> None:
    tip, measured = a_curve()
    still = measured.iloc[[-1] * 60]
    assert "the separation stays the same over 61 points" in told(tip, pd.concat([measured, still]), [MODULUS])


def test_rows_that_were_mixed() -> None:
    tip, measured = a_curve("jkr")
    mixed = measured.sample(frac=1.0, random_state=1)
    with pytest.raises(StoreError, match="separation goes to and fro from row to row; rows must be in the order of"):
        rm.fit(mixed, tip.scene(), [MODULUS, WORK])
    tip, measured = a_curve("hertz")
    fits = [rm.fit(each, tip.scene(), [MODULUS]) for each in (measured, measured.sample(frac=1.0, random_state=1))]
    assert float(fits[1].material_modulus) == pytest.approx(float(fits[0].material_modulus), rel=1e-9)


def test_units_that_are_wrong() -> None:
    tip, measured = a_curve()
    with pytest.raises(rm.OutOfRange, match="which is much for the patch: are the units of the lengths right"):
        rm.fit(measured * [1e9, 1.0], tip.scene(), [MODULUS])
    for factor, bound in ((1e9, "1e+10"), (1e-9, "100")):
        said = told(tip, measured * [1.0, factor], [MODULUS])
        assert f"material.modulus ended at the bound of what is allowed, {bound}, far from where it started" in said


def test_a_force_in_nanometres_and_a_constant_control() -> None:
    with pytest.raises(StoreError, match="column 'force': 'nm' is a unit of m; expected a unit of N"):
        read_measured(pd.DataFrame({"separation": [1.0, 2.0, 3.0, 4.0], "force [nm]": [1.0, 2.0, 3.0, 4.0]}), 1)
    with pytest.raises(StoreError, match="separation is 2 m in every row; a curve along which it changes is needed"):
        read_measured(pd.DataFrame({"separation": [2.0] * 4, "force": [1.0, 2.0, 3.0, 4.0]}), 1)
    with pytest.raises(StoreError, match="force is 3 uN in every row; a curve with contact is needed"):
        read_measured(pd.DataFrame({"separation": [1.0, 2.0, 3.0, 4.0], "force [uN]": [3.0] * 4}), 1)
    with pytest.raises(StoreError, match="has 2 rows; at least 4 are needed"):
        read_measured(pd.DataFrame({"separation": [2.0, 1.0], "force": [1.0, 2.0]}), 1)

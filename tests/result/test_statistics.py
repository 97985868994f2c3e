"""keep = "statistics": the same numbers as from the curves, without them."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from scenes import scene

import roughmdr as rm
from roughmdr.result.pull_off import pull_off_force
from roughmdr.variables import CURVE_VARIABLES

EVERY = list(CURVE_VARIABLES)
SWEEP = {"adhesion.work": [0.0, 0.05], "asperities.count": [50, 200]}


def kept(keep: str, **changes: Any) -> xr.Dataset:
    return rm.run(scene(output={"variables": EVERY, "keep": keep}, **changes))


@pytest.mark.parametrize("sweep", [None, SWEEP])
def test_they_are_the_statistics_of_the_curves(sweep: dict[str, Any] | None) -> None:
    curves, statistics = kept("curves", sweep=sweep), kept("statistics", sweep=sweep)
    assert "realization" not in statistics.dims
    swept = () if sweep is None else ("adhesion_work", "asperities_count")
    for name in EVERY:
        over = curves[name]
        expected = {
            "mean": over.mean("realization"),
            "sem": over.std("realization", ddof=1) / np.sqrt(16),
            "min": over.min("realization"),
            "max": over.max("realization"),
        }
        for what, values in expected.items():
            variable = statistics[f"{name}_{what}"]
            assert variable.dims == (*swept, "step")
            assert variable.attrs["units"] == CURVE_VARIABLES[name].units
            known = np.isfinite(variable)
            assert known.all() or (name, what) == ("stiffness", "sem")
            scale = float(np.abs(values).max()) or 1.0
            np.testing.assert_allclose(variable.where(known), values.where(known), rtol=1e-12, atol=1e-14 * scale)
    assert (statistics.realization_count == 16.0).all()
    assert statistics.run_time.dims == statistics.status.dims == statistics.numerical_error.dims == swept
    np.testing.assert_array_equal(statistics.numerical_error, curves.numerical_error.max("realization"))
    assert "curves of the realisations" in statistics.attrs["left_out"]


def test_the_stiffness_has_no_standard_error_where_contacts_let_go() -> None:
    """With adhesion, wherever the flat is as high as ever since it was lower; whatever the branch is called."""
    path = {"separation": ["3 um", "0 um", "0.5 um", "0.5 um", "0.2 um", "0.5 um", "0.6 um", "-1 um"]}
    snaps = [False, False, True, True, False, True, True, False]
    for sweep, cells in ((None, [snaps]), ({"adhesion.work": [0.0, 0.05]}, [[False] * 8, snaps])):
        sticky = kept("statistics", path=path, sweep=sweep)
        np.testing.assert_array_equal(np.isnan(sticky.stiffness_sem).to_numpy().reshape(-1, 8), cells)
        assert "variance" in sticky.stiffness_sem.attrs["comment"]
    assert np.isfinite(kept("statistics", adhesion=None, path=path).stiffness_sem).all()


@pytest.mark.parametrize("effective_modulus", [1e-170, 1e180])
def test_they_stay_in_the_range_of_a_float(effective_modulus: float) -> None:
    tiny = kept("statistics", material={"effective_modulus": effective_modulus}, adhesion=None)
    plain = kept("statistics", material={"effective_modulus": 1.0}, adhesion=None)
    for what in ("mean", "sem", "max"):
        np.testing.assert_allclose(tiny[f"force_{what}"] / effective_modulus, plain[f"force_{what}"], rtol=1e-10)


def test_one_realisation_has_no_standard_error() -> None:
    single = kept("statistics", batch=None)
    assert np.isnan(single.force_sem).all()
    np.testing.assert_array_equal(single.force_mean, kept("curves", batch=None).force[0])


def test_the_bits_do_not_depend_on_workers() -> None:
    table = scene(output={"keep": "statistics"}, asperities={**scene()["asperities"], "count": 3000}, sweep=SWEEP)
    one, three = rm.run(table, workers=1), rm.run(table, workers=3)
    assert one.drop_vars("run_time").equals(three.drop_vars("run_time"))


def test_the_pull_off_force_of_curves_and_of_the_mean_curve(tmp_path: Path) -> None:
    curves, statistics = kept("curves", sweep=SWEEP), kept("statistics", sweep=SWEEP)
    lowest = curves.force.min("step").clip(max=0.0)
    found = pull_off_force(curves)
    np.testing.assert_allclose(found.mean, lowest.mean("realization"), rtol=1e-14)
    np.testing.assert_allclose(found.standard_error, lowest.std("realization", ddof=1) / 4.0, rtol=1e-12)
    assert (found.mean[0] == 0.0).all()
    assert (found.mean[1] < 0.0).all()
    np.testing.assert_array_equal(found.tensile, (curves.force.min("step") < 0.0).sum("realization"))
    of_mean = pull_off_force(statistics)
    assert (found.curves == 16).all()
    assert (of_mean.curves == 1).all()
    np.testing.assert_allclose(of_mean.mean, curves.force.mean("realization").min("step").clip(max=0.0), rtol=1e-12)
    at = curves.force[1, 1, :, 40:]
    change = [
        max(abs(run[m] - run[m - 1]) if m else 0.0, abs(run[m + 1] - run[m]) if m < 39 else 0.0)
        for run, m in zip(at.to_numpy(), at.argmin("step").to_numpy(), strict=True)
    ]
    assert found.change[1, 1] == pytest.approx(np.mean(change), rel=1e-12)
    with pytest.raises(rm.StoreError, match="never retracts"):
        pull_off_force(kept("curves", path={"separation": ["3 um", "0 um"]}))
    with pytest.raises(rm.StoreError, match="holds no force"):
        pull_off_force(curves.drop_vars("force"))

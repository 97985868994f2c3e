"""keep = "statistics": the same numbers as from the curves, without them."""

import math
import warnings
from typing import Any

import numpy as np
import pytest
import xarray as xr
from hypothesis import given, settings, strategies as st
from scenes import ASPERITIES, CONDUCTION, scene

import roughmdr as rm
from roughmdr.batch.moments import KnownMoments, MomentTree
from roughmdr.report.summary import describe_result
from roughmdr.result.view import ResultView
from roughmdr.variables import CONDUCTANCES, CURVE_VARIABLES

VARIABLES = CURVE_VARIABLES | CONDUCTANCES
EVERY = list(VARIABLES)
SWEEP = {"adhesion.work": [0.0, 0.05], "asperities.count": [50, 200]}


def kept(keep: str, **changes: Any) -> xr.Dataset:
    return rm.run(scene(output={"variables": EVERY, "keep": keep}, conduction=CONDUCTION, **changes))


@pytest.mark.few(1)
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
            assert variable.attrs["units"] == VARIABLES[name].units
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


PULL_OFF = ("force", "separation", "contacts", "contact_area", "pressure", "contact_fraction")


@pytest.mark.large
def test_the_pull_off_of_curves_and_of_statistics() -> None:
    path = {"separation": {"start": "3.6 sigma", "stop": "-0.5 sigma", "steps": 40}, "unload": True}
    curves, statistics = (kept(keep, sweep=SWEEP, path=path) for keep in ("curves", "statistics"))
    unloading = curves.force.isel(step=curves.branch == "unloading")
    own = curves.pull_off_force[1].notnull()
    assert own.any()
    assert (curves.pull_off_force[1] <= unloading.min("step")[1]).where(own, True).all()
    none = curves.pull_off_force[0]  # no adhesion
    assert (none == 0.0).any()
    assert ((none == 0.0) | none.isnull()).all()
    assert np.isnan(curves.pull_off_separation[0]).all()
    for what in PULL_OFF:
        each = curves[f"pull_off_{what}"]
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", RuntimeWarning)
            numbers = {"mean": each.mean, "min": each.min, "max": each.max}
            for name, function in numbers.items():
                np.testing.assert_allclose(statistics[f"pull_off_{what}_{name}"], function("realization"), rtol=1e-12)
            sem = each.std("realization", ddof=1) / np.sqrt(curves.pull_off_count)
            np.testing.assert_allclose(statistics[f"pull_off_{what}_sem"], sem, rtol=1e-9)
    np.testing.assert_array_equal(statistics.pull_off_count, curves.pull_off_count)
    of_mean = unloading.mean("realization").min("step").clip(max=0.0).where(2 * curves.pull_off_count > 16)
    np.testing.assert_allclose(curves.pull_off_force_of_mean, of_mean, rtol=0.05)
    np.testing.assert_allclose(statistics.pull_off_force_of_mean, curves.pull_off_force_of_mean, rtol=1e-12)
    area = 1e-6
    np.testing.assert_allclose(curves.pull_off_pressure * area, curves.pull_off_force, rtol=1e-12)


@pytest.mark.few(1)
@pytest.mark.parametrize("keep", ["curves", "statistics"])
def test_unloadings_that_end_in_contact_do_not_enter(keep: str) -> None:
    path = {"separation": {"start": "2.9 sigma", "stop": "1 sigma", "steps": 30}, "unload": True}
    found = kept(keep, path=path, asperities={**ASPERITIES, "count": 60})
    ends = kept("curves", path=path, asperities={**ASPERITIES, "count": 60}).contact_count[:, -1] > 0
    assert 0 < int(ends.sum()) < 16
    assert int(found.pull_off_count) == 16 - int(ends.sum())
    if keep == "curves":
        np.testing.assert_array_equal(found.pull_off_force.isnull(), ends)
    text = describe_result(ResultView(found))
    assert f"{int(ends.sum())} of 16 unloadings end in contact and have none" in text
    pressed = kept(keep, path={"separation": ["3 um", "0 um", "0.1 um"]})
    assert int(pressed.pull_off_count) == 0
    assert np.isnan(pressed.pull_off_force_of_mean)
    assert "none: all 16 unloadings end in contact" in describe_result(ResultView(pressed))


def test_after_a_preload_nothing_is_said_of_a_mean_law() -> None:
    """At equal travel realisations stand at different separations."""
    found = kept("curves", path={"preload": "1 mN", "steps": 10, "unload": True})
    assert int(found.pull_off_count) == 16
    assert "mean law" not in describe_result(ResultView(found))
    assert "mean law" in describe_result(ResultView(kept("curves", path={"separation": ["3 um", "0 um", "9 um"]})))


def test_a_path_without_unloading_has_no_pull_off() -> None:
    found = kept("curves", path={"separation": ["3 um", "0 um"]})
    assert not [name for name in found if str(name).startswith("pull_off")]
    assert "none: the path has no unloading" in describe_result(ResultView(found))


def test_it_is_there_where_the_force_is_not_asked_for() -> None:
    area_only = {"keep": "curves", "variables": ["contact_area"]}
    table = scene(output=area_only)
    found = rm.run(table)
    assert "force" not in found
    np.testing.assert_array_equal(found.pull_off_force, kept("curves").pull_off_force)


@pytest.mark.large
@settings(deadline=None, max_examples=100)
@given(st.lists(st.floats(-1e3, 1e3) | st.just(math.nan), min_size=1, max_size=40), st.randoms())
def test_moments_of_numbers_that_some_lack_have_the_same_bits_in_any_order(values: list[float], order: Any) -> None:
    tables = []
    for _ in range(2):
        tree, numbers = MomentTree[KnownMoments](), list(enumerate(values))
        order.shuffle(numbers)
        for number, value in numbers:
            tree.add(number, KnownMoments.of(np.array([value])))
        total = tree.total(len(values))
        assert total is not None
        tables.append(total.table)
    assert tables[0].tobytes() == tables[1].tobytes()
    known = np.array([value for value in values if not math.isnan(value)])
    assert tables[0][0, 0] == known.size
    if known.size:
        expected = [known.mean(), known.std(), known.min(), known.max()]
        np.testing.assert_allclose(tables[0][1:, 0], expected, rtol=1e-9, atol=1e-10)
    else:
        assert np.isnan(tables[0][1:]).all()


STICKY = {
    "material": {"modulus": "2 GPa", "poisson": 0.3},
    "adhesion": {"model": "jkr", "work": "60 mJ/m^2"},
    "asperities": {
        "source": "random",
        "shape": "paraboloid",
        "count": 1500,
        "patch": "5 um",
        "radius": "120 nm",
        "height": {"distribution": "normal", "std": "1 nm"},
    },
    "path": {"separation": {"start": "14 nm", "stop": "1 nm", "steps": 60}, "unload": True},
    "batch": {"realizations": 60},
}


@pytest.mark.large
@pytest.mark.filterwarnings("ignore::roughmdr.errors.LimitWarning")
def test_curves_statistics_and_the_expected_law_give_one_pull_off_of_a_sticky_film() -> None:
    curves, statistics = rm.run(STICKY), rm.run({**STICKY, "output": {"keep": "statistics"}})
    expected = rm.run({**STICKY, "batch": {"estimator": "expected"}})
    exact = float(expected.pull_off_force[0])
    assert float(expected.pull_off_force_of_mean) == exact < float(expected.force.min())
    assert exact == pytest.approx(float(expected.force.min()), rel=1e-2)
    sem = float(statistics.pull_off_force_sem)
    for found in (curves, statistics):
        assert abs(float(found.pull_off_force_of_mean) - exact) < 5.0 * sem
        assert float(found.pull_off_force_of_mean) >= float(statistics.pull_off_force_mean) * (1.0 + 1e-12)
    near = np.linspace(0.999, 1.001, 400) * float(expected.pull_off_separation[0])
    fine = {"separation": ["14 nm", "1 nm", *near.tolist(), "14 nm"]}
    lowest = float(rm.run({**STICKY, "batch": {"estimator": "expected"}, "path": fine}).force.min())
    assert exact == pytest.approx(lowest, rel=1e-6)
    rough = {**STICKY["asperities"], "height": {"distribution": "normal", "std": "20 nm"}}  # type: ignore[dict-item]
    path = {"separation": {"start": "120 nm", "stop": "20 nm", "steps": 60}, "unload": True}
    few = rm.run({**STICKY, "asperities": rough, "path": path})
    assert float(few.pull_off_contacts.mean()) < 3.0
    said = "contacts carry it: a patch this small does not show the pull-off of a surface"
    assert said in describe_result(ResultView(few))
    assert said not in describe_result(ResultView(curves))

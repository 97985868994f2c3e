"""Pull-offs, statistics, trust and pictures of a result, against what a run stores and info prints."""

from typing import Any

import numpy as np
import pytest
import xarray as xr
from scenes import scene

import roughmdr as rm


def test_the_pull_off_is_the_mean_over_realisations(curves: xr.Dataset) -> None:
    off = curves.roughmdr.pull_off()
    assert off.force.dims == ("adhesion_work", "asperities_height_std")
    np.testing.assert_allclose(off.force, curves.pull_off_force.mean("realization"), rtol=1e-12)
    error = curves.pull_off_force.std("realization", ddof=1) / np.sqrt(off["count"])
    np.testing.assert_allclose(off.force_sem, error, rtol=1e-12)
    assert set(off.data_vars) == {
        *("force", "force_sem", "separation", "contacts", "pressure", "contact_fraction", "count", "force_of_mean"),
        "force_model_error",
    }
    relative = 1.1 * np.sqrt(off.contact_fraction) + curves.slope_error.max("realization")
    np.testing.assert_allclose(off.force_model_error, -off.force * relative, rtol=1e-12)
    units = [off[name].attrs["units"] for name in ("force", "force_sem", "separation", "contacts", "pressure")]
    assert units == ["N", "N", "m", "1", "Pa"]


def test_the_pull_off_of_statistics_is_what_they_store(curves: xr.Dataset, statistics: xr.Dataset) -> None:
    xr.testing.assert_allclose(
        statistics.roughmdr.pull_off().drop_vars("cell_key"), curves.roughmdr.pull_off().drop_vars("cell_key")
    )


def test_realisations_without_a_pull_off_do_not_count(curves: xr.Dataset) -> None:
    some = curves.copy()
    some["pull_off_force"] = curves.pull_off_force.where(xr.DataArray(np.arange(5) > 0, dims="realization"))
    np.testing.assert_allclose(
        some.roughmdr.pull_off().force, curves.pull_off_force.isel(realization=slice(1, None)).mean("realization")
    )


def test_without_an_unloading_there_is_no_pull_off() -> None:
    result = rm.run(scene(path={"separation": ["3 um", "2 um"]}, batch=None))
    with pytest.raises(rm.StoreError, match="its path has no unloading"):
        result.roughmdr.pull_off()


def same_as_stored(found: xr.Dataset, stored: xr.Dataset) -> None:
    assert set(found.variables) == set(stored.variables) - {"cell_key", "remark"}
    for name in found.data_vars:
        assert found[name].dims == stored[name].dims
        assert found[name].attrs.keys() == stored[name].attrs.keys(), name
        for key in found[name].attrs:
            assert np.array_equal(found[name].attrs[key], stored[name].attrs[key]), name
        if name != "run_time":
            np.testing.assert_allclose(found[name], stored[name], rtol=1e-13, atol=0.0, err_msg=str(name))


def test_statistics_are_those_that_a_run_stores(curves: xr.Dataset, statistics: xr.Dataset) -> None:
    found = curves.roughmdr.statistics()
    same_as_stored(found, statistics)
    assert bool(found.stiffness_sem.isnull().any())  # where contacts detach
    assert rm.info(found).splitlines()[0] == rm.info(statistics).splitlines()[0]


@pytest.mark.few(1)
@pytest.mark.parametrize(
    "changes",
    [
        {"adhesion": None, "path": {"separation": ["3 um", "1 um", "3 um"]}},
        {"path": {"preload": "0.2 mN", "steps": 10, "unload": True}},
        {"path": {"preload": "0.2 mN", "steps": 10, "unload": True, "machine_stiffness": "1 kN/m"}},
        {"path": {"remote": ["3 um", "1 um", "3 um"], "machine_stiffness": "1 kN/m"}},
        {"path": {"force": ["1 uN", "1 mN", "1 uN"]}},
    ],
    ids=["without adhesion", "preload", "preload through a spring", "spring", "dead load"],
)
def test_statistics_over_other_paths(changes: dict[str, Any]) -> None:
    table = scene(batch={"realizations": 3}, **changes)
    found = rm.run(table).roughmdr.statistics()
    same_as_stored(found, rm.run(table | {"output": {"keep": "statistics"}}))


def test_a_run_that_failed_does_not_count_and_is_told(curves: xr.Dataset) -> None:
    failed = curves.copy(deep=True)
    failed.status[0, 1, 2] = 1
    failed.force[0, 1, 2] = np.nan
    failed.coords["remark"] = (failed.status.dims, np.where(failed.status.values == 1, "it is wrong", ""))
    found = failed.roughmdr.statistics()
    others = curves.force[0, 1].isel(realization=[0, 1, 3, 4])
    np.testing.assert_allclose(found.force_mean[0, 1], others.mean("realization"), rtol=1e-12, atol=1e-18)
    np.testing.assert_allclose(found.force_sem[0, 1], others.std("realization", ddof=1) / 2.0, rtol=1e-9, atol=1e-18)
    assert found.remark.values.tolist() == [["", "it is wrong"], ["", ""]]
    assert "failed" in rm.info(found, cells=True)


def test_statistics_need_realisations(statistics: xr.Dataset) -> None:
    with pytest.raises(rm.StoreError, match="has their statistics already"):
        statistics.roughmdr.statistics()


def test_trust_is_the_worst_of_the_realisations(curves: xr.Dataset, statistics: xr.Dataset) -> None:
    trust = curves.roughmdr.trust()
    np.testing.assert_array_equal(trust.model_error, curves.model_error.max("realization"))
    np.testing.assert_array_equal(trust.trusted_separation, statistics.trusted_separation)
    assert trust.model_error.attrs["units"] == "1"
    text = rm.info(curves)
    assert all(line in text for line in trust.attrs["trust"].splitlines())


def test_a_picture_is_that_of_plot(curves: xr.Dataset) -> None:
    figure = curves.isel(adhesion_work=[0], asperities_height_std=[0]).roughmdr.plot(variables="force")
    assert [axes.get_ylabel().split(" ")[0] for axes in figure.axes] == ["force"]


_METHODS = {
    "pull_off": (),
    "hysteresis": (),
    "statistics": (),
    "trust": (),
    "plot": (),
    "at_force": (1.0,),
    "at_pressure": (1.0,),
    "at_contact_fraction": (0.1,),
    "at_separation": (1.0,),
    "normalise": ("gw",),
    "fit_power_law": ("force", "separation"),
}


@pytest.mark.parametrize("method", _METHODS)
def test_what_is_no_result_is_refused(method: str) -> None:
    other = xr.Dataset({"temperature": ("time", [1.0])})
    with pytest.raises(
        rm.StoreError, match=r"needs a result as roughmdr\.run or load_separation returns it, with curves"
    ):
        getattr(other.roughmdr, method)(*_METHODS[method])
    asperities = rm.generate(scene()["asperities"], seed=1)
    with pytest.raises(rm.StoreError, match="this is an ensemble of asperities"):
        getattr(asperities.roughmdr, method)(*_METHODS[method])


@pytest.mark.large
def test_every_variable_has_its_unit_and_its_name(curves: xr.Dataset) -> None:
    arguments = _METHODS | {"at_force": (1e-4,), "normalise": ("gw",)}
    for method in sorted(_METHODS.keys() - {"plot"}):
        for name, array in getattr(curves.roughmdr, method)(*arguments[method]).data_vars.items():
            assert array.attrs.get("long_name"), (method, name)
            assert "units" in array.attrs or "flag_meanings" in array.attrs, (method, name)


def test_statistics_of_values_that_were_found(curves: xr.Dataset) -> None:
    there = curves.roughmdr.at_contact_fraction([1e-3, 2e-3])
    found = there.roughmdr.statistics()
    xr.testing.assert_allclose(found.pressure_mean, there.pressure.mean("realization"), rtol=1e-12)
    sem = there.pressure.std("realization", ddof=1) / np.sqrt(there.pressure.count("realization"))
    xr.testing.assert_allclose(found.pressure_sem, sem, rtol=1e-9)
    worst = there.pressure_interpolation_error.max("realization")
    xr.testing.assert_allclose(found.pressure_interpolation_error, worst)
    assert found.pressure_sem.attrs["units"] == "Pa"

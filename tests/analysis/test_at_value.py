"""Interpolation against hand-written xarray and NumPy, and against finer paths: the stated errors hold."""

import itertools
from typing import Any

import numpy as np
import pytest
import xarray as xr
from scenes import ASPERITIES, ensemble, scene

import roughmdr as rm
from roughmdr.result.between import CONFIDENCE


def leg(result: xr.Dataset, branch: str) -> xr.Dataset:
    return result.isel(step=np.flatnonzero(result.branch.values == branch))


def test_the_separation_at_a_force_is_the_one_that_numpy_finds(curves: xr.Dataset) -> None:
    loading = leg(curves, "loading")
    forces = float(loading.force.max("step").min()) * np.array([0.3, 0.9])
    there = curves.roughmdr.at_force(forces)
    assert there.separation.dims == ("adhesion_work", "asperities_height_std", "realization", "force")
    for cell in np.ndindex(2, 2, 5):
        one = loading.isel(dict(zip(there.separation.dims[:3], cell, strict=True)))
        force, h = one.force.values, np.broadcast_to(one.separation.values, one.force.shape)
        rising = slice(int(np.argmin(force)), None)
        expected = np.interp(forces, force[rising], h[rising])
        assert there.separation.values[cell] == pytest.approx(expected, rel=1e-12)
        area = np.interp(forces, force[rising], one.contact_area.values[rising])
        assert there.contact_area.values[cell] == pytest.approx(area, rel=1e-12)
    assert there.force.attrs["units"] == "N"
    assert there.separation_interpolation_error.attrs["units"] == "m"


def test_at_a_step_the_curves_are_those_of_the_step(curves: xr.Dataset) -> None:
    cell = {"adhesion_work": 0.05, "asperities_height_std": 1e-6}
    one = curves.sel(cell)
    for branch in ("loading", "unloading"):
        steps = leg(one, branch).isel(step=[10, 30])
        here = one.roughmdr.at_separation(steps.separation.values, branch=branch)
        for name in ("force", "contact_count", "stiffness"):
            np.testing.assert_allclose(here[name].values, steps[name].values, rtol=1e-9)


def test_texts_scalars_and_derived_quantities(curves: xr.Dataset) -> None:
    by_text = curves.roughmdr.at_force("1 mN")
    assert by_text.force.ndim == 0
    by_pressure = curves.roughmdr.at_pressure(1e-3 / curves.nominal_area.values.flat[0])
    np.testing.assert_allclose(by_text.separation, by_pressure.separation, rtol=1e-12)
    assert "force" in by_pressure
    fraction = curves.roughmdr.at_contact_fraction([0.01], branch="unloading")
    np.testing.assert_allclose(fraction.contact_area.values, 0.01 * 1e-6, rtol=1e-9)


def test_statistics_are_those_of_the_mean_curve(statistics: xr.Dataset) -> None:
    loading = leg(statistics, "loading").isel(adhesion_work=1, asperities_height_std=0)
    force = loading.force_mean.values
    there = statistics.roughmdr.at_force([0.5 * force.max()])
    rising = slice(int(np.argmin(force)), None)
    expected = np.interp(0.5 * force.max(), force[rising], loading.separation.values[rising])
    assert float(there.separation[1, 0, 0]) == pytest.approx(expected, rel=1e-12)
    assert {"contact_area_mean", "contact_area_mean_interpolation_error"} <= set(there.data_vars)


def test_a_value_that_is_never_reached_has_none(curves: xr.Dataset) -> None:
    there = curves.roughmdr.at_force(1.0)
    assert all(bool(there[name].isnull().all()) for name in there.data_vars)
    assert "never reaches the force" in there.attrs["comment"]


def test_no_value_at_all_is_refused(curves: xr.Dataset) -> None:
    with pytest.raises(rm.OutOfRange, match="force is empty; give at least one value"):
        curves.roughmdr.at_force([])


def test_under_a_dead_load_the_separation_is_a_variable(dead_load: xr.Dataset) -> None:
    there = dead_load.roughmdr.at_force(125e-6)
    mean = dead_load.separation.isel(step=[1, 2]).mean("step")
    np.testing.assert_allclose(there.separation, mean, rtol=1e-12)
    back = dead_load.roughmdr.at_force(125e-6, branch="unloading")
    np.testing.assert_allclose(back.separation, dead_load.separation.isel(step=[3, 4]).mean("step"), rtol=1e-12)
    assert dead_load.separation[:, -1].isnull().all()  # pulled off
    near = dead_load.separation.isel(step=[4, 5]).mean("step")
    found = [
        float(dead_load.isel(realization=[i]).roughmdr.at_separation(h, branch="unloading").contact_area[0])
        for i, h in enumerate(near.values)
    ]
    np.testing.assert_allclose(found, dead_load.contact_area.isel(step=[4, 5]).mean("step"), rtol=1e-9)


def test_along_a_preload_force_and_separation_are_variables(preload: xr.Dataset) -> None:
    there = preload.roughmdr.at_force("0.1 mN")
    assert {"travel", "separation", "contact_area"} <= set(there.data_vars)
    assert bool((there.travel > 0.5).all())
    assert bool((there.travel < 1.0).all())


def test_the_first_leg_of_a_branch_that_reaches_a_value_counts() -> None:
    path = [2e-6, 1e-6, 2e-6, 0.0, 3e-6]
    law = rm.load_separation(ensemble([0.5e-6, 1e-6], radius=5e-5), separation=path, effective_modulus=1e9)
    assert law.branch.values.tolist() == ["loading", "loading", "unloading", "loading", "unloading"]
    here = law.roughmdr.at_separation([1.5e-6, 0.5e-6], branch="loading")
    force = law.force.values
    assert here.force.values == pytest.approx([0.5 * (force[0] + force[1]), 0.75 * force[3] + 0.25 * force[2]])
    back = law.roughmdr.at_separation([1.5e-6, 2.5e-6], branch="unloading")
    assert back.force.values == pytest.approx([0.5 * force[1] + 0.5 * force[2], force[3] / 6.0 + force[4] * 5.0 / 6.0])


def test_steps_without_a_value_are_left_out() -> None:
    law = rm.load_separation(
        ensemble([0.0], radius=5e-5), separation=np.linspace(0.0, -1e-6, 11), effective_modulus=1e9, unload=True
    )
    marked = law.copy(deep=True)
    for name in ("force", "contact_area"):
        marked[name][[4, 10, 11]] = np.nan
    target = 0.5 * float(law.force[3] + law.force[5])
    there = marked.roughmdr.at_force(target)
    assert float(there.separation) == pytest.approx(float(law.separation[4]))
    assert float(there.contact_area) == pytest.approx(0.5 * float(law.contact_area[3] + law.contact_area[5]))
    beyond = 0.5 * float(law.force[9] + law.force[10])
    assert marked.roughmdr.at_force(beyond).separation.isnull()
    assert marked.roughmdr.at_force(beyond, branch="unloading").separation.isnull()


def coarser(fine: xr.Dataset, times: int) -> xr.Dataset:
    half = fine.sizes["step"] // 2
    return fine.isel(step=[*range(0, half, times), *range(half, 2 * half, times)])


def within(fine: xr.Dataset, times: int, name: str, branch: str, rng: np.random.Generator) -> list[bool]:
    """Whether values of a coarser path are within their errors of those of a finer one, where both have them."""
    coarse, along = coarser(fine, times), leg(fine, branch)
    reached = along.contact_area / along.nominal_area if name == "contact_fraction" else along[name]
    values = rng.uniform(float(reached.min()), min(float(reached.max()), 1.0), 12)
    rough, exact = (getattr(each.roughmdr, f"at_{name}")(values, branch=branch) for each in (coarse, fine))
    holds: list[bool] = []
    for each in [each for each in rough.data_vars if not str(each).endswith("_error")]:
        error, off = rough[f"{each}_interpolation_error"], abs(rough[each] - exact[each])
        assert (error.isnull() == rough[each].isnull()).all()
        tiny = 1e-12 * float(abs(exact[each]).max())
        holds += (off <= error + tiny).values[np.isfinite(off.values)].tolist()
    return holds


@pytest.mark.large
def test_the_stated_errors_hold_against_a_finer_path() -> None:
    """At jumps of 1 to 30 contacts too."""
    rng = np.random.default_rng(0)
    holds, of_variables = [], ["force", "contact_area", "contact_count", "stiffness", "energy"]
    for _ in range(12):
        count = int(rng.integers(1, 30))
        asperities = ensemble(rng.normal(0.0, 1e-6, count), radius=rng.uniform(3e-5, 8e-5, count))
        top = float(asperities.height.max()) + 5e-7
        fine = rm.load_separation(
            asperities,
            separation=np.linspace(top, top - 2.5e-6, 20 * 30 + 1),
            effective_modulus=5e6,
            work=0.05 * rng.integers(0, 2),
            unload=True,
            variables=of_variables,
        ).assign(nominal_area=asperities.attrs["nominal_area"])
        for name, branch in itertools.product(("force", "contact_fraction", "separation"), ("loading", "unloading")):
            holds += within(fine, 20, name, branch, rng)
    assert len(holds) > 3000
    assert np.mean(holds) >= CONFIDENCE


@pytest.mark.large
@pytest.mark.parametrize(
    "path",
    [
        {"separation": {"start": "clear", "stop": "0.5 sigma"}},
        {"force": {"start": "0 uN", "stop": "0.1 mN"}},
        {"remote": {"start": "clear", "stop": "0 sigma"}, "machine_stiffness": 1e3},
        {"preload": "0.1 mN"},
    ],
    ids=lambda path: next(iter(path)),
)
@pytest.mark.parametrize("adhesion", [None, {"model": "jkr"}, {"model": "dugdale", "strength": "2 MPa"}])
def test_the_stated_errors_hold_for_all_controls_and_models(path: dict[str, Any], adhesion: dict[str, Any]) -> None:
    rng, holds = np.random.default_rng(1), []
    for seed in range(10):
        steps = 8 * int(rng.integers(40, 120)) + 1
        control = next(iter(path))
        stepped = path | ({"steps": steps} if control == "preload" else {control: path[control] | {"steps": steps}})
        works = None if adhesion is None else adhesion | {"work": float(10 ** rng.uniform(-2.5, -1.0))}
        radius = {**ASPERITIES["radius"], "std": "20 um"}
        asperities = ASPERITIES | {"count": int(rng.choice([20, 200, 1000])), "radius": radius}
        changes = {"seed": seed, "adhesion": works, "asperities": asperities, "batch": {"realizations": 3}}
        fine = rm.run(scene(path=stepped | {"unload": True}, **changes))
        for name, branch in itertools.product(("force", "contact_fraction", "separation"), ("loading", "unloading")):
            holds += within(fine, 8, name, branch, rng)
    assert len(holds) > 5000
    assert np.mean(holds) >= CONFIDENCE


@pytest.mark.parametrize("branch", ["Loading", ""])
def test_an_unknown_branch_is_refused(curves: xr.Dataset, branch: str) -> None:
    with pytest.raises(rm.StoreError, match=r"branch is .*; it must be 'loading' or 'unloading'"):
        curves.roughmdr.at_force(1e-3, branch=branch)


def test_what_a_result_lacks_is_named() -> None:
    result = rm.run(scene(path={"separation": ["3 um", "2 um"]}, batch=None, output={"variables": ["contact_count"]}))
    with pytest.raises(
        rm.StoreError, match="at_force needs 'force', which this result does not hold; it holds contact_count, separa"
    ):
        result.roughmdr.at_force(1e-3)
    with pytest.raises(rm.StoreError, match="the path of this result has no unloading"):
        result.roughmdr.at_separation(2.5e-6, branch="unloading")
    with pytest.raises(rm.OutOfRange, match="force is '1 kg'"):
        result.roughmdr.at_force("1 kg")
    with pytest.raises(rm.StoreError, match="at_pressure needs 'force', which"):
        result.roughmdr.at_pressure(1.0)


@pytest.mark.parametrize("keep", ["curves", "statistics"])
def test_the_pressure_at_a_contact_fraction_follows_from_the_force(keep: str) -> None:
    made = rm.run(scene(output={"variables": ["force", "contact_area"], "keep": keep}))
    suffix = "_mean" if keep == "statistics" else ""
    there = made.roughmdr.at_contact_fraction(0.01)
    over_area = there[f"force{suffix}"] / made.nominal_area
    xr.testing.assert_allclose(there[f"pressure{suffix}"], over_area, rtol=1e-12)
    assert there[f"pressure{suffix}"].attrs["units"] == "Pa"
    assert (there[f"pressure{suffix}_interpolation_error"] >= 0.0).all()


@pytest.mark.parametrize("path", [["1 um"], ["1 um", "0.5 um"], ["1.5 um", "1 um", "0.5 um"]])
def test_paths_of_few_steps_have_values_as_far_as_they_reach(path: list[str]) -> None:
    made = rm.run(scene(path={"separation": path}))
    there = made.roughmdr.at_separation("0.75 um")
    assert bool(there.force.isnull().all()) == (len(path) == 1)


def test_numbers_that_only_jump_are_off_by_a_whole_jump_between_steps() -> None:
    """Between 1 and 2 contacts there are 1 or 2: their error is half of one, however straight the line of steps is.

    Their losses likewise are those of either step; the force, a smooth curve, is known to far less than its change.
    """
    one = 1e-6 * np.arange(6)
    law = rm.load_separation(
        ensemble(-one, radius=5e-5),
        separation=np.append(1e-6, -one - 0.2e-6),
        effective_modulus=1e8,
        work=0.05,
        variables=["force", "contact_count", "dissipated_energy"],
    )
    assert law.contact_count.values.tolist() == [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0]
    there = law.roughmdr.at_separation([-1.7e-6, -2.7e-6])
    for name in ("contact_count", "dissipated_energy"):
        found, error = there[name].values, there[f"{name}_interpolation_error"].values
        for i, begin in enumerate((2, 3)):
            for truth in law[name].values[begin : begin + 2]:
                assert abs(found[i] - truth) <= error[i] * (1.0 + 1e-9)
    change = np.diff(law.force.values)[2:4]
    assert (there.force_interpolation_error.values < 0.5 * np.abs(change)).all()


@pytest.mark.parametrize("keep", ["curves", "statistics"])
def test_under_a_dead_load_the_pressure_is_found_too(keep: str) -> None:
    path, output = {"force": {"stop": "1 mN", "steps": 20}}, {"variables": ["contact_area"], "keep": keep}
    loads = rm.run(scene(adhesion=None, path=path, batch={"realizations": 2}, output=output))
    there = loads.roughmdr.at_contact_fraction("0.3 %")
    np.testing.assert_allclose(there.pressure, there.force / loads.nominal_area, rtol=1e-12)
    error = there.force_interpolation_error / loads.nominal_area
    np.testing.assert_allclose(there.pressure_interpolation_error, error, rtol=1e-9)
    assert there.pressure.attrs["units"] == "Pa"
    assert bool((there.pressure > 0.0).all())

"""The energy of a loop against xarray's own integral, against jumps, and against finer paths."""

import numpy as np
import pytest
import xarray as xr
from scenes import ensemble, scene

import roughmdr as rm


def test_the_works_are_integrals_of_the_force(curves: xr.Dataset) -> None:
    loop = curves.roughmdr.hysteresis()
    half = curves.sizes["step"] // 2
    for name, steps, sign in (("work_of_loading", slice(half), -1.0), ("work_of_unloading", slice(half, None), 1.0)):
        cell = curves.isel(adhesion_work=1, asperities_height_std=1, step=steps)
        force = cell.force.swap_dims(step="separation")
        expected = sign * force.integrate("separation")
        np.testing.assert_allclose(loop[name][1, 1], expected, rtol=1e-12)
        assert loop[name].attrs["units"] == "J"
    np.testing.assert_allclose(loop.energy_lost, loop.work_of_loading - loop.work_of_unloading)


def test_what_is_lost_is_what_the_jumps_dissipate_to_the_stated_error(curves: xr.Dataset) -> None:
    loop = curves.roughmdr.hysteresis()
    off = abs(loop.energy_lost - loop.dissipated_energy)
    assert bool((off <= loop.energy_lost_interpolation_error).all())
    assert float((loop.energy_lost_interpolation_error / loop.energy_lost).median()) < 0.2


@pytest.mark.large
def test_the_stated_errors_of_the_energy_hold() -> None:
    rng, holds = np.random.default_rng(1), []
    for _ in range(60):
        count = int(rng.integers(1, 30))
        asperities = ensemble(rng.normal(0.0, 1e-6, count), radius=rng.uniform(3e-5, 8e-5, count))
        top = float(asperities.height.max()) + 1e-6
        fine = rm.load_separation(
            asperities,
            separation=np.linspace(top, top - 2.5e-6, 20 * 30 + 1),
            effective_modulus=5e6,
            work=0.05,
            unload=True,
            variables=["force"],
        )
        coarse = fine.isel(step=[*range(0, 601, 20), *range(601, 1202, 20)])
        rough, exact = coarse.roughmdr.hysteresis(), fine.roughmdr.hysteresis()
        for name in ("work_of_loading", "work_of_unloading", "energy_lost"):
            error = rough[f"{name}_interpolation_error"] + exact[f"{name}_interpolation_error"]
            holds.append(bool(abs(rough[name] - exact[name]) <= error))
    assert np.mean(holds) > 0.95


def test_of_statistics_it_is_that_of_the_mean_loop(curves: xr.Dataset, statistics: xr.Dataset) -> None:
    of_mean = statistics.roughmdr.hysteresis()
    mean = curves.roughmdr.hysteresis().mean("realization")
    np.testing.assert_allclose(of_mean.energy_lost, mean.energy_lost, rtol=1e-9)
    assert "dissipated_energy_mean" in of_mean


def test_where_a_step_has_no_separation_there_is_no_energy(dead_load: xr.Dataset) -> None:
    loop = dead_load.roughmdr.hysteresis()
    assert bool(loop.work_of_unloading.isnull().all())
    assert bool(loop.work_of_loading.notnull().all())
    assert "pulled the flat off" in loop.attrs["comment"]


def test_without_an_unloading_there_is_no_loop() -> None:
    result = rm.run(scene(path={"separation": ["3 um", "2 um"]}, batch=None))
    with pytest.raises(rm.StoreError, match="the path of this result has no unloading"):
        result.roughmdr.hysteresis()

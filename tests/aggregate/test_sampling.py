"""The sampling error: exact cases, units and order, and patches cut out of a surface with clusters."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import xarray as xr
from hypothesis import given, settings, strategies as st
from studies.trust.samples import clusters

import roughmdr as rm
from roughmdr.aggregate.sampling import evening, sample_of
from roughmdr.ensemble.ensemble import Ensemble
from roughmdr.numerics.arguments import Floats
from roughmdr.shapes import Paraboloid

RADIUS = 0.01
ZERO = 1e-7  # the root of a rounding
SEEDS = st.integers(0, 2**32 - 1)


def asperities(count: int, side: float = 1.0, *, seed: int | None = None, **attrs: Any) -> Ensemble:
    """Return equal asperities on a patch, with positions where a seed is given."""
    placed = (
        {} if seed is None else dict(zip("xy", np.random.default_rng(seed).uniform(0.0, side, (2, count)), strict=True))
    )
    found = Ensemble.alike(Paraboloid(1.0), np.zeros(count), placed, side)
    return replace(found, nominal_area=side * side, attrs=found.attrs | attrs)


def sampling_error(ensemble: Ensemble, force: Floats) -> float:
    return float(sample_of(ensemble, force, np.full(force.size, RADIUS))["sampling_error"])


@pytest.mark.parametrize("count", [2, 7, 100])
def test_equal_contacts_scatter_by_their_number_or_where_that_is_fixed_not_at_all(count: int) -> None:
    force = np.full(count, 0.3)
    assert sampling_error(asperities(count, goes_on=1), force) == pytest.approx(1.0 / math.sqrt(count), rel=1e-14)
    assert sampling_error(asperities(count), force) < ZERO
    assert sampling_error(asperities(count, of_surface=1), force) == pytest.approx(1.0 / math.sqrt(count), rel=1e-14)
    lattice = asperities(count, goes_on=1, patch_x=1.0, patch_y=1.0)
    assert sampling_error(lattice, force) < ZERO


def test_of_a_fixed_number_it_is_the_standard_deviation_of_their_forces() -> None:
    """The variance of the sum of N independent forces is N times theirs, sum of F^2 - (sum of F)^2/N."""
    force = np.array([0.0, 3.0, 1.0, 0.0, 7.0])
    error = sampling_error(asperities(5), force)
    assert error * force.sum() == pytest.approx(math.sqrt(force @ force - force.sum() ** 2 / 5.0), rel=1e-14)


def test_a_lone_contact_and_contacts_in_one_block_may_as_well_not_be_there() -> None:
    one = np.zeros(50)
    one[3] = 2.0
    for ensemble in (asperities(50, goes_on=1), asperities(50, seed=1)):
        assert sampling_error(ensemble, one) == pytest.approx(1.0, rel=1e-14)
    assert sampling_error(asperities(50), one) == pytest.approx(math.sqrt(1.0 - 1.0 / 50.0), rel=1e-14)
    crowd = asperities(50, seed=1)
    near = {name: 0.6 + 0.01 * values for name, values in crowd.positions.items()}  # in one block, shifted or not
    assert sampling_error(replace(crowd, positions=near), np.ones(50)) == pytest.approx(1.0, rel=1e-14)


def test_nothing_is_known_without_contacts_nor_of_one_asperity_that_is_all_there_is() -> None:
    assert math.isnan(sampling_error(asperities(3), np.zeros(3)))
    assert math.isnan(sampling_error(asperities(0), np.zeros(0)))
    assert math.isnan(sampling_error(asperities(1), np.ones(1)))


def test_on_a_lattice_equal_contacts_do_not_scatter() -> None:
    x, y = (each.ravel() for each in np.meshgrid(*2 * (np.arange(0.5, 8.0) / 8.0,)))
    placed = replace(asperities(64), positions={"x": x, "y": y})
    assert sampling_error(placed, np.ones(64)) < ZERO


@pytest.mark.parametrize("count", [2, 5, 40])
def test_at_the_same_force_equal_loads_tell_the_standard_error_of_the_mean_area(count: int) -> None:
    force, radius = np.full(count, 3.0), np.random.default_rng(count).lognormal(size=count)
    for ensemble in (asperities(count, goes_on=1), asperities(count)):
        error = sample_of(ensemble, force, radius)["area_sampling_error"]
        assert error == pytest.approx(np.std(radius**2, ddof=1) / math.sqrt(count) / np.mean(radius**2), rel=1e-13)
        assert sample_of(ensemble, force, np.full(count, 0.2))["area_sampling_error"] < 1e-14


def test_of_a_lone_contact_or_one_that_pulls_nothing_is_known_of_the_area() -> None:
    ensemble, radius = asperities(3), np.array([1.0, 0.5, 0.0])
    for force in ([1.0, 0.0, 0.0], [1.0, -0.2, 0.0], [0.0, 0.0, 0.0]):
        assert math.isnan(sample_of(ensemble, np.array(force), radius)["area_sampling_error"])


@settings(deadline=None)
@given(SEEDS, st.sampled_from([1e-9, 1e6]), st.sampled_from([1e-290, 1e-9, 1e290]), st.booleans())
def test_units_order_origin_and_signs_change_nothing(seed: int, length: float, unit: float, placed: bool) -> None:
    draws = np.random.default_rng(seed)
    ensemble = asperities(20, seed=seed if placed else None)
    force = draws.lognormal(size=20) * draws.choice([0.0, 1.0, -0.2], 20, p=[0.4, 0.5, 0.1])
    force[0] = 1.0
    error, order = sampling_error(ensemble, force), draws.permutation(20)
    assert 0.0 < error <= 1.04
    other = asperities(20, length)
    at = {name: length * (values[order] - 1.0) for name, values in ensemble.positions.items()}
    assert sampling_error(replace(other, positions=at), -unit * force[order]) == pytest.approx(error, rel=1e-6)
    radius = 0.01 * np.abs(force)
    of_area, of_other = (
        sample_of(each, np.abs(load), a)["area_sampling_error"]
        for each, load, a in (
            (ensemble, force, radius),
            (replace(other, positions=at), unit * force[order], length * radius[order]),
        )
    )
    assert of_other == pytest.approx(of_area, rel=1e-6, nan_ok=True)
    lower = evening(ensemble, radius)
    assert lower >= 1.0
    assert evening(other, length * radius) == pytest.approx(lower, rel=1e-12)


def test_contacts_that_are_few_or_small_do_not_even_out() -> None:
    ensemble = asperities(100, seed=1)
    found = [evening(ensemble, np.full(100, radius)) - 1.0 for radius in (0.0, 1e-6, 2e-6)]
    assert found[0] == 0.0
    assert found[2] == pytest.approx(2.0 * found[1], rel=1e-3)


def pressed(ensemble: xr.Dataset, h: float) -> Floats:
    """Return force, sampling error and effective number of contacts."""
    law = rm.load_separation(ensemble, separation=[h], effective_modulus=1.0)
    return np.array([law.force.values[-1], law.sampling_error, law.effective_contacts])


@pytest.mark.large
def test_of_patches_with_clusters_it_is_the_scatter_which_the_number_of_contacts_misses() -> None:
    found = [pressed(clusters(0.03, seed), 0.0) for seed in range(80)]
    force, error, number = np.transpose(found)
    true = np.std(force, ddof=1) / np.mean(force)  # known to 8 %
    assert np.median(error) == pytest.approx(true, rel=0.25)
    assert np.mean(np.abs(np.log(error / true)) < math.log(1.5)) > 0.8
    assert np.median(number**-0.5) < 0.65 * true


@pytest.mark.large
def test_a_mean_field_evens_out_the_force_of_a_patch() -> None:
    """The mean field is as a spring in series with each asperity: more force moves all away."""
    section = {"source": "random", "shape": "paraboloid", "count": 300, "patch": "1 mm", "radius": "50 um"}
    section["height"] = {"distribution": "normal", "std": "1 um"}
    given = {
        "separation": ["0 um"],
        "effective_modulus": "1 GPa",
        "interaction": {"model": "mean_field", "boundary": "free"},
    }
    laws = [rm.load_separation(rm.generate(section, seed=seed), **given) for seed in range(60)]
    force, error, number = ([float(law[name].values.ravel()[-1]) for law in laws]
                            for name in ("force", "sampling_error", "effective_contacts"))  # fmt: skip
    true = np.std(force, ddof=1) / np.mean(force)
    assert np.median(error) == pytest.approx(true, rel=0.2)
    assert np.median(number) ** -0.5 > 1.5 * true


@pytest.mark.large
def test_at_the_same_force_it_is_the_scatter_of_the_area() -> None:
    """It is far below that of the force at the same separation."""
    section = {
        "source": "random", "shape": "paraboloid", "count": 300, "patch": 1.0, "placement": "random",
        "radius": {"distribution": "lognormal", "mean": 0.03, "std": 0.03},
        "height": {"distribution": "normal", "std": 5e-3},
    }  # fmt: skip
    path, at, areas = np.linspace(0.02, 0.0, 81), 60, []
    ensembles = [rm.generate(section, seed=seed) for seed in range(80)]
    variables = ["force", "contact_area"]
    laws = [rm.load_separation(each, separation=path, effective_modulus=1.0, variables=variables) for each in ensembles]
    target = np.mean([law.force.values[at] for law in laws])
    areas = [np.interp(target, law.force.values, law.contact_area.values) for law in laws]
    true = np.std(areas, ddof=1) / np.mean(areas)  # known to 8 %
    stated = [
        rm.load_separation(each, separation=path[at : at + 1], effective_modulus=1.0)[name].item()
        for each in ensembles
        for name in ("area_sampling_error", "sampling_error")
    ]
    of_area, of_force = np.median(np.reshape(stated, (-1, 2)), axis=0)
    assert of_area == pytest.approx(true, rel=0.25)
    assert of_area < 0.5 * of_force

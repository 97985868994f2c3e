"""The error of independent asperities that their number and distances tell: few of them, and crowds."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from hypothesis import example, given, settings, strategies as st
from scenes import scene

import roughmdr as rm
from roughmdr.elements.path import solve_on_grid
from roughmdr.elements.surface import surface_of_asperities
from roughmdr.ensemble.ensemble import Ensemble
from roughmdr.model_error.interaction import error_by_distances, interaction_error

FREE = {"model": "pairwise", "boundary": "free"}


def placed(x: Any, y: Any, height: Any, patch: float, **shape: Any) -> xr.Dataset:
    """Asperities at positions [m] with heights [m]; the parameters of their shape in SI, one for each or for all."""
    name = shape.pop("shape", "paraboloid")
    columns = {"height": height, "x": x, "y": y, **shape}
    units = {"slope": "1"}
    size = np.size(height)
    return xr.Dataset(
        {
            k: ("asperity", np.broadcast_to(v, size).astype(float), {"units": units.get(k, "m")})
            for k, v in columns.items()
        },
        attrs={"shape": name, "patch": patch},
    )


@pytest.mark.parametrize("patch", ["20 um", "100 um", "1 mm"])
@pytest.mark.parametrize("estimator", ["sampled", "expected"])
def test_a_lone_asperity_feels_nobody_on_any_patch(patch: str, estimator: str) -> None:
    tip = {"source": "random", "shape": "paraboloid", "count": 1, "patch": patch, "radius": "100 um"}
    asperities = {**tip, "height": {"distribution": "normal", "std": "1 nm"}}
    table = scene(
        adhesion=None,
        asperities=asperities,
        path={"separation": ["1 um", "-20 nm", "-50 nm"]},
        output={"variables": ["force", "model_error_curve"]},
        batch={"estimator": estimator, "realizations": 1},
    )
    made = rm.run(table)
    assert float(made.interaction_error.max()) == 0.0
    assert float(made.model_error.max()) == float(made.slope_error.max())
    told = rm.info(made)
    assert "feels no other" in told
    assert "with [interaction]" not in told


def test_a_lone_asperity_of_a_layer_under_a_curved_body_is_one_of_many() -> None:
    """Its patch is a part of the layer, which goes on."""
    asperities = {
        "source": "random", "shape": "paraboloid", "count": 1, "patch": "20 um", "radius": "10 um",
        "height": {"distribution": "normal", "std": "0.1 um"},
    }  # fmt: skip
    nominal = {"shape": "paraboloid", "radius": "50 mm"}
    table = scene(
        adhesion=None, asperities=asperities, nominal=nominal, path={"separation": ["0.1 um", "-0.1 um"]},
        output={"variables": ["force"]}, batch={"estimator": "expected", "realizations": 1},
    )  # fmt: skip
    made = rm.run(table)
    fraction = float(made.largest_contact_fraction[0])
    assert float(made.interaction_error[0]) == pytest.approx(float(interaction_error(np.array(fraction))))


@pytest.mark.large
@settings(deadline=None, max_examples=25)
@given(st.integers(2, 10), st.integers(0, 2**31), st.floats(1.0, 30.0), st.sampled_from(["paraboloid", "cone"]))
@example(2, 106097, 1.0, "paraboloid")  # a larger contact takes all that the smaller one bears
def test_the_error_of_few_is_that_of_their_distances_whatever_the_patch(
    count: int, seed: int, apart: float, shape: str
) -> None:
    """Against the coupled solution on a half-space that is elsewhere at rest; about ``apart`` contact radii between."""
    rng = np.random.default_rng(seed)
    depth, radius = 3e-7, 1e-3 * np.exp(0.3 * rng.standard_normal(count))
    parameters = {"radius": radius} if shape == "paraboloid" else {"slope": radius}
    side = 3.0 * apart * math.sqrt(count) * (math.sqrt(depth * 1e-3) if shape == "paraboloid" else depth / 1e-3)
    height, (x, y) = 0.3 * depth * rng.random(count), rng.random((2, count)) * side
    h = height.max() - depth * np.array([0.1, 0.4, 1.0])
    for patch in (1.01 * side, 30.0 * side):
        asperities = placed(x, y, height, patch, shape=shape, **parameters)
        given = {"separation": h, "effective_modulus": 1e9}
        alone = rm.load_separation(asperities, **given, variables=["force", "model_error_curve"])
        true = (alone.force / rm.load_separation(asperities, **given, interaction=FREE).force - 1.0).values
        stated = (alone.model_error_curve - alone.slope_error).values
        seen, true = true > 1e-6, np.minimum(true, 1.0)  # also of those that overlap
        assert (stated[seen] >= 0.98 * true[seen]).all()
        assert (stated[seen] <= 3.0 * true[seen]).all()


@pytest.mark.large
def test_few_at_random_are_as_far_apart_as_expected() -> None:
    """Without positions the error is about the mean over patches of that with positions."""
    table = {"source": "random", "shape": "paraboloid", "count": 5, "patch": "1 mm", "radius": "100 um"}
    asperities = {**table, "height": {"distribution": "normal", "std": "1 nm"}}
    path = {"separation": ["-1 um"]}
    batch = {"estimator": "expected", "realizations": 1}
    law = rm.run(scene(adhesion=None, asperities=asperities, path=path, batch=batch))
    errors = [
        float(
            rm.load_separation(
                rm.generate(asperities, seed=seed), separation=["-1 um"], effective_modulus="1 GPa"
            ).interaction_error
        )
        for seed in range(200)
    ]
    assert float(law.interaction_error[0]) == pytest.approx(float(np.mean(errors)), rel=0.1)


def crowd(share: float, seed: int) -> xr.Dataset:
    """Forty capped paraboloids of nearly equal height at random on a part of the side of their patch."""
    rng = np.random.default_rng(seed)
    x, y = rng.random((2, 40)) * 1e-3 * share
    radii = {"radius": 1e-3, "cap_radius": 3e-3, "blend_radius": 1e-5}
    return placed(x, y, 2e-9 * rng.standard_normal(40), 1e-3, shape="capped_paraboloid", **radii)


def near_pairs(count: int, seed: int) -> xr.Dataset:
    """A crowd on all of the patch, ``count`` of which stand about half a contact radius from another one."""
    asperities, rng = crowd(1.0, seed), np.random.default_rng(seed)
    for axis in "xy":
        at = asperities[axis].values
        at[:count] = (at[count : 2 * count] + 5e-6 * rng.standard_normal(count)) % 1e-3
    return asperities


@pytest.mark.large
@pytest.mark.parametrize("asperities", [crowd(0.5, 1), crowd(0.6, 3), crowd(0.7, 5), near_pairs(10, 7)])
def test_the_force_of_a_crowd_is_too_high_by_what_is_stated(asperities: xr.Dataset) -> None:
    """Overlapping contacts and crowded ones are counted twice; the bound is that of boundary elements."""
    top = float(asperities.height.max())
    h = top - np.array([2e-8, 1e-7])
    alone = rm.load_separation(
        asperities, separation=h, effective_modulus=1e9, variables=["force", "contact_fraction", "model_error_curve"]
    )
    ensemble = Ensemble.from_dataset(asperities)
    surface = surface_of_asperities(ensemble, float(h.min()), periodic=True)
    exact = np.array([step.force for step in solve_on_grid(surface, h, 1e9, (256, 256), stiffness=False).steps])
    true = alone.force.values / exact - 1.0
    stated = alone.model_error_curve.values
    assert (alone.contact_fraction.values > 2e-3).all()
    assert (true > 0.05).all()
    assert (true <= stated).all()
    assert (stated <= 3.0 * true).all()


@pytest.mark.large
def test_tips_that_a_flat_only_touches_bear_nothing_that_could_be_off() -> None:
    at = np.array([1e-4, 3e-4])
    tips = placed(at, at, np.full(2, 1e-6), 1e-3, shape="truncated_paraboloid", radius=1e-3, flat_radius=1e-5)
    law = rm.load_separation(
        tips, separation=[2e-6, 1e-6, 0.9e-6], effective_modulus=1e9, variables=["force", "model_error_curve"]
    )
    assert (law.force.values > 0.0).tolist() == [False, False, True]
    assert (law.model_error_curve.values > 0.0).tolist() == [False, False, True]


@pytest.mark.large
def test_of_a_crowd_the_sign_and_the_remedy_are_told(tmp_path: Path) -> None:
    """Above 100 % it is taken for no hills; hills have no overlap."""
    for number, (asperities, words) in enumerate(
        [(crowd(0.35, 1), "too high by 100 % or more of the true one"), (near_pairs(10, 7), "too high by up to ")]
    ):
        asperities.to_netcdf(tmp_path / f"{number}.nc")
        table = scene(
            adhesion=None, asperities={"source": "file", "file": str(tmp_path / f"{number}.nc")},
            path={"separation": [float(asperities.height.max()) - 1.1e-7]}, output={"variables": ["force"]},
            batch={"realizations": 1},
        )  # fmt: skip
        made = rm.run(table)
        told = rm.info(made)
        share = f"{100.0 * float(made.overlap_fraction[0]):.2g} % of the contacts overlap"
        assert words in told
        assert ("the force may be off by all of it or more at closest approach" in " ".join(told.split())) == (
            number == 0
        )
        assert share in told
        assert 'model = "pairwise" counts it, beyond = "boundary_elements" where contacts overlap' in told
        warned = float(made.interaction_error[0]) > 0.36
        assert ("the force is too high, by more than 0.36 of the true one" in made.attrs.get("warnings", "")) == warned


@settings(deadline=None, max_examples=30)
@given(st.integers(2, 40), st.integers(0, 2**31), st.floats(1e-9, 1e6))
def test_distances_count_in_any_unit_and_order(count: int, seed: int, unit: float) -> None:
    rng = np.random.default_rng(seed)
    radius, at = rng.uniform(0.01, 0.02, count), rng.random((count, 2))
    load, order = radius**3, rng.permutation(count)
    here = error_by_distances(radius, load, at, np.ones(2))
    there = error_by_distances(
        radius[order] * unit, load[order] * 7.0, (at[order] + 0.3) % 1.0 * unit, np.full(2, unit)
    )
    assert there == pytest.approx(here, rel=1e-9, abs=1e-9)


def test_of_many_that_cover_their_patch_the_mean_is_taken_off() -> None:
    rng = np.random.default_rng(2)
    errors = [
        error_by_distances(np.full(100, 0.01), np.ones(100), rng.random((100, 2)), np.ones(2)) for _ in range(100)
    ]
    free = error_by_distances(np.full(100, 0.01), np.ones(100), rng.random((100, 2)), None)
    assert abs(np.mean(errors)) < 0.02
    assert free == 1.0  # the whole force


def lattice(count: int) -> dict[str, Any]:
    """Equal paraboloids on a square lattice of one pitch, so many on the patch."""
    asperities = {"source": "random", "shape": "paraboloid", "placement": "square", "pitch": "8 um"}
    size = {"patch": f"{8.0 * math.sqrt(count)} um", "radius": "10 um"}
    return {**asperities, **size, "height": {"distribution": "normal", "std": "0.1 nm"}}


def of_fraction(made: xr.Dataset) -> Any:
    """The error that the contact fraction alone tells."""
    return interaction_error(made.largest_contact_fraction.values)


@pytest.mark.parametrize("count", [1, 4, 9, 16])
def test_a_lattice_is_one_surface_however_few_of_its_asperities_are_on_the_patch(count: int) -> None:
    """Its force is too low by a third at 4.9 % contact."""
    for estimator in ("sampled", "expected"):
        batch = {"estimator": estimator, "realizations": 1}
        table = scene(adhesion=None, asperities=lattice(count), path={"separation": ["-0.1 um"]}, batch=batch)
        made = rm.run(table)
        np.testing.assert_allclose(made.interaction_error, of_fraction(made), rtol=1e-12)
        assert "too high" not in rm.info(made)
    given: dict[str, Any] = {"separation": ["-0.1 um"], "effective_modulus": "1 GPa"}
    placed = rm.generate(lattice(count), seed=1)
    alone = rm.load_separation(placed, **given)
    pairs = rm.load_separation(placed, **given, interaction={"model": "pairwise", "order": 2})
    true = 1.0 - float(alone.force[0] / pairs.force[0])
    assert 0.25 < true < float(alone.interaction_error) < 1.5 * true
    np.testing.assert_allclose(alone.interaction_error, of_fraction(alone), rtol=1e-12)


def test_a_density_is_a_sample_of_a_surface_however_few_are_drawn() -> None:
    """About eight, more or fewer than ten by realisation."""
    asperities = {
        "source": "random", "shape": "paraboloid", "density": "2e10 /m^2", "patch": "20 um", "radius": "10 um",
        "height": {"distribution": "normal", "std": "0.1 um"},
    }  # fmt: skip
    assert len({rm.generate(asperities, seed=seed).sizes["asperity"] > 10 for seed in range(8)}) == 2
    for batch in ({"realizations": 8}, {"estimator": "expected", "realizations": 1}):
        made = rm.run(scene(adhesion=None, asperities=asperities, path={"separation": ["0.1 um"]}, batch=batch))
        np.testing.assert_allclose(made.interaction_error, of_fraction(made), rtol=1e-12)
    drawn = rm.generate(asperities, seed=1)
    alone = rm.load_separation(drawn, separation=0.0, effective_modulus=1e9)
    np.testing.assert_allclose(alone.interaction_error, of_fraction(alone), rtol=1e-12)

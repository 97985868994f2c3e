"""The study of independent asperities against boundary elements."""

import math

import numpy as np
import pytest
from carried_out import CarriedOut
from studies.versus_bem import errors, estimates, grid_errors, groups, touch
from studies.versus_bem.ensembles import QUICK, SIZE, Case, contact_radii, distances, height_map, separations

import roughmdr as rm

STUDIED = "versus_bem"


@pytest.mark.large
def test_every_case_is_compared_and_reported(studied: CarriedOut) -> None:
    assert studied.result.sizes["case"] == len(QUICK)
    assert all(f"| {name} |" in studied.text for name in ("random", "square", "map"))


@pytest.mark.large
def test_independent_forces_are_too_low_by_more_than_the_grid_is_off(studied: CarriedOut) -> None:
    error, grid = errors(studied.result), grid_errors(studied.result)
    known = np.isfinite(error)
    assert known.sum() > 8
    assert (error[known] > 0.0).all()
    assert (grid[np.isfinite(grid)] < 0.1 * error[np.isfinite(grid)]).all()


@pytest.mark.large
def test_the_estimate_bounds_most_errors_and_is_within_a_factor_of_3(studied: CarriedOut) -> None:
    error = errors(studied.result)
    known = np.isfinite(error)
    fraction = studied.result["contact_fraction"].sel(model="independent").to_numpy()
    found = estimates(fraction, groups(studied.result))[known]
    error = error[known]
    assert np.mean(error <= found) >= 0.75
    assert np.mean((found <= 3.0 * error) & (error <= 3.0 * found)) >= 0.9
    assert set(groups(studied.result).ravel()) == {"few contacts", "random", "square", "map"}


@pytest.mark.few(1)
@pytest.mark.parametrize("shape", ["paraboloid", "lognormal", "cone", "quartic"])
def test_contact_radii_and_separations_are_those_of_the_law(shape: str) -> None:
    asperities = Case("hard_core 0.5", shape, 30, 0.3, 64, 1).generate()
    along = separations(asperities, np.array([0.01, 0.1]))
    law = rm.load_separation(asperities, separation=along, effective_modulus=1e9, variables="contact_area")
    for h, area in zip(along.tolist(), law["contact_area"].to_numpy().tolist(), strict=True):
        assert math.pi * np.sum(contact_radii(asperities, h) ** 2) == pytest.approx(area, rel=1e-9)
    np.testing.assert_allclose(law["contact_area"] / SIZE**2, [0.01, 0.1], rtol=0.02)
    assert distances(asperities).min() >= 0.5 * SIZE / math.sqrt(30) * (1.0 - 1e-12)


def test_the_map_is_periodic_and_as_high_as_its_asperities() -> None:
    asperities = Case("random", "paraboloid", 5, 0.3, 64, 1).generate()
    found = height_map(asperities, 64)
    moved = asperities.assign(x=(asperities["x"] + 16.0 * SIZE / 64) % SIZE)
    np.testing.assert_allclose(height_map(moved, 64), np.roll(found, 16, axis=0), rtol=0.0, atol=1e-9 * np.ptp(found))
    top = float(asperities["height"].max())
    assert top - (SIZE / 64) ** 2 <= found.max() <= top


def test_contacts_touch_where_their_circles_meet() -> None:
    distance = np.array([[np.inf, 3.0, 1.0], [3.0, np.inf, 2.0], [1.0, 2.0, np.inf]])
    assert touch(np.array([0.6, 0.1, 0.5]), distance)
    assert not touch(np.array([0.5, 0.1, 0.4]), distance)
    assert not touch(np.array([1.5, 0.1, 0.0]), distance)

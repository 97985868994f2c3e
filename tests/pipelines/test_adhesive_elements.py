"""Adhesive boundary elements against JKR, Hertz and their own energy, and the study of adhesive pairs against them."""

import math

import numpy as np
import pytest
from carried_out import CarriedOut
from forms import large
from oracles.adhesive_elements import AdhesiveMap
from oracles.boundary_elements import HeightMap
from studies.versus_adhesive_bem import DETACHED, MODELS, QUICK, WORK, Case, by_elements, judge, law
from studies.versus_bem.ensembles import height_map

import roughmdr as rm

STUDIED = "versus_adhesive_bem"

LONE = Case(1, 8.0, 3.0, 192, step=0.08)


def lone_map(work: float, reach: float) -> AdhesiveMap:
    return AdhesiveMap(height_map(LONE.generate(), LONE.points), LONE.size, work, reach)


def test_the_range_is_that_of_the_tabor_number_and_the_stretch_that_of_jkr() -> None:
    assert LONE.reach == pytest.approx((WORK**2 / 3.0**3) ** (1.0 / 3.0), rel=1e-12)
    tip = rm.Paraboloid(radius=1.0)
    folded = rm.pull_off(tip, effective_modulus=1.0, work=WORK, control="displacement")
    assert float(folded["indentation"]) == pytest.approx(DETACHED, rel=1e-9)


@pytest.mark.large
def test_one_alone_is_nearly_jkr() -> None:
    """At Tabor number 3 its tension is 2.6 % larger, on a finer grid 2.8 %, its area 2 to 3 % smaller: by the range.

    Just before it lets go, where the areas of the two go different ways, it is not compared.
    """
    ensemble = LONE.generate()
    path = LONE.separations(ensemble)
    jkr = law(ensemble, path, MODELS["order 2"])
    found = by_elements(LONE, ensemble, path, LONE.points)
    assert 1.0 < found["force"].min() / jkr["force"].min() < 1.05
    both = (jkr["area"] > 1.5) & (found["count"] == 1)
    assert np.abs(found["area"][both] / jkr["area"][both] - 1.0).max() < 0.04


def test_the_force_is_the_slope_of_the_energy() -> None:
    surface = lone_map(WORK, LONE.reach)
    surface.move(0.0)
    states = [surface.move(h) for h in (-0.02, 0.0, 0.02)]
    slope = (states[2].energy - states[0].energy) / 0.04
    assert -slope == pytest.approx(states[1].force, rel=2e-3)


@pytest.mark.parametrize("separation", [-0.5, large(-0.8)])
def test_without_adhesion_it_is_the_other_boundary_elements(separation: float) -> None:
    """Their forces are alike where next to nothing is attracted: by 2e-5 of the force, and less of less."""
    surface = lone_map(1e-6, LONE.reach)  # pressures are 0.2 to 0.5, the attraction is 1e-5
    other = HeightMap(surface.height, LONE.size)
    exact, found = other.press(separation), surface.move(separation)
    assert found.force == pytest.approx(exact.force, rel=1e-4)
    assert found.closed == pytest.approx(exact.contact_area, rel=5e-3)


def test_far_away_there_is_no_force_and_no_energy() -> None:
    found = lone_map(WORK, LONE.reach).move(50.0)
    assert found == pytest.approx((0.0, 0.0, 0.0, 0.0), abs=1e-12)


def test_no_rest_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("oracles.adhesive_elements._MAX_ITERATIONS", 2)
    with pytest.raises(rm.OutOfRange, match=r"separation is -0\.2: boundary elements do not converge"):
        lone_map(WORK, LONE.reach).move(-0.2)


@pytest.mark.large
def test_every_case_is_compared_drawn_and_reported(studied: CarriedOut) -> None:
    assert studied.result.sizes["case"] == len(QUICK)
    assert all(name in studied.text for name in ("independent", "order 1", "order 2", "coarse grid"))
    assert (studied.folder / "versus_adhesive_bem.png").stat().st_size > 5000


@pytest.mark.large
def test_pairs_are_nearer_than_independent_asperities_and_the_grid_nearer_still(studied: CarriedOut) -> None:
    several = studied.result.isel(case=1)
    independent, pairs, grid = (judge(several, name) for name in ("independent", "order 2", "coarse grid"))
    assert pairs.unloading < 0.5 * independent.unloading
    assert pairs.loading < 0.5 * independent.loading
    assert max(grid.loading, grid.unloading) < 0.1 * pairs.unloading
    assert math.isfinite(pairs.on)

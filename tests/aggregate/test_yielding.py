"""Contacts above the hardness: against closed forms of spheres and exponential heights, quadrature and plain sums."""

import math
from typing import Any

import numpy as np
import pytest
from forms import large
from hypothesis import given, settings, strategies as st
from scipy.integrate import quad
from scipy.optimize import brentq
from scipy.special import gammaincc
from scipy.stats import norm

import roughmdr as rm
from roughmdr.aggregate import Problem
from roughmdr.aggregate.yielding import yielding
from roughmdr.ensemble import Ensemble
from roughmdr.interaction.settings import Interaction
from roughmdr.kernels.adhesion import Adhesion
from roughmdr.model_error.parts import YIELDED_SHARE
from roughmdr.numerics.arguments import Floats
from roughmdr.shapes import Cone, Paraboloid

JKR = Adhesion(0.5)
DUGDALE = Adhesion(0.5, "dugdale", 1e9)
DECADES = st.floats(-9.0, 3.0)


def paraboloids(height: Floats, radius: Floats | float = 50e-6, area: float | None = 1e-6, **more: Any) -> Ensemble:
    parameters = {"radius": np.broadcast_to(radius, height.shape).astype(float)}
    return Ensemble("paraboloid", np.asarray(height, dtype=float), parameters, area, **more).sorted()


def onset(radius: float, modulus: float, hardness: float) -> float:
    """The compression at which the mean pressure 4 E* sqrt(d/R)/(3 pi) of a paraboloid is the hardness [m]."""
    return radius * (3.0 * math.pi * hardness / (4.0 * modulus)) ** 2


@pytest.mark.large
@given(DECADES, DECADES, st.floats(-4.0, 0.0))
@settings(deadline=None)
def test_a_sphere_is_above_the_hardness_from_its_onset_on(length: float, stress: float, relative: float) -> None:
    """In any unit: radius and modulus over twelve decades, hardness over modulus over four."""
    radius, modulus, hardness = 10.0**length, 10.0 ** (stress + 6.0), 10.0 ** (stress + 6.0 + relative)
    deepest = onset(radius, modulus, hardness)
    problem = Problem(paraboloids(np.zeros(1), radius, radius * radius), modulus, Adhesion())
    shares = [yielding(problem, hardness, -deepest * factor)["yielded_load_fraction"] for factor in (0.999, 1.001)]
    assert shares == [0.0, 1.0]
    found = yielding(problem, hardness, -3.0 * deepest)
    assert found["yielded_contact_fraction"] == 1.0
    assert found["plasticity_index"] == 0.0  # heights do not scatter
    assert found["elastic_separation"] == pytest.approx(-deepest, rel=3.0 / 512.0)
    assert found["elastic_separation"] > -deepest
    elastic = 4.0 / 3.0 * modulus * math.sqrt(radius) * (-found["elastic_separation"]) ** 1.5
    assert found["elastic_pressure"] == pytest.approx(elastic / radius**2, rel=1e-12)


@pytest.mark.parametrize("hardness", [2e9, 5e9, 9e9])
def test_exponential_heights_have_the_same_shares_at_every_load(hardness: float) -> None:
    """exp(-x) of the contacts, and Gamma(5/2, x)/Gamma(5/2) of the load, x = d_c/sigma (Greenwood and Williamson)."""
    modulus, sigma, count = 80e9, 1e-6, 200_000
    height = -sigma * np.log((np.arange(count) + 0.5) / count)
    problem, x = Problem(paraboloids(height), modulus, Adhesion()), onset(50e-6, modulus, hardness) / sigma
    for separation in (2.0 * sigma, 4.0 * sigma):
        found = yielding(problem, hardness, separation)
        assert found["yielded_contact_fraction"] == pytest.approx(math.exp(-x), rel=1e-2)
        assert found["yielded_load_fraction"] == pytest.approx(gammaincc(2.5, x), rel=1e-2)
        assert found["plasticity_index"] == pytest.approx(modulus / hardness * math.sqrt(sigma / 50e-6), rel=1e-3)


def test_normal_heights_against_quadrature() -> None:
    """Shares at closest approach, and the load at which contacts above the hardness bear 2 % of it."""
    modulus, sigma, hardness, count = 80e9, 1e-6, 8e9, 200_000
    height, deepest = sigma * norm.isf((np.arange(count) + 0.5) / count), onset(50e-6, 80e9, 8e9)

    def integral(power: float, separation: float, least: float = 0.0) -> float:
        top = 12.0 * sigma
        return quad(lambda d: d**power * norm.pdf(separation + d, scale=sigma), least, top, epsabs=0.0, limit=200)[0]

    def share(power: float, separation: float) -> float:
        return integral(power, separation, deepest) / integral(power, separation)

    found = yielding(Problem(paraboloids(height), modulus, Adhesion()), hardness, -sigma)
    assert found["yielded_contact_fraction"] == pytest.approx(share(0.0, -sigma), rel=5e-3)
    assert found["yielded_load_fraction"] == pytest.approx(share(1.5, -sigma), rel=5e-3)
    limit = brentq(lambda h: share(1.5, h) - YIELDED_SHARE, -sigma, 4.0 * sigma)
    force = count * 4.0 / 3.0 * modulus * math.sqrt(50e-6) * integral(1.5, limit)
    assert found["elastic_separation"] == pytest.approx(limit, abs=6.0 / 512.0 * sigma)
    assert found["elastic_pressure"] == pytest.approx(force / 1e-6, rel=0.03)


@pytest.mark.parametrize("adhesion", [Adhesion(), JKR, large(DUGDALE)])
@pytest.mark.parametrize("seed", [1, large(2), large(3)])
def test_plain_sums_over_single_contacts(adhesion: Adhesion, seed: int) -> None:
    """With adhesion the load is that of contacts that push, and the pressure that of all."""
    draws = np.random.default_rng(seed)
    ensemble = paraboloids(1e-6 * draws.normal(size=80), draws.lognormal(math.log(50e-6), 0.5, 80))
    radius, modulus, hardness = ensemble.parameters["radius"], 80e9, 3e9

    def plain(separation: float) -> tuple[float, float, float]:
        touching = ensemble.height > separation - adhesion.range
        known = {"adhesion": adhesion.model, "strength": adhesion.strength} if adhesion.cohesive else {}
        contacts = [
            rm.indent(
                Paraboloid(radius=r), effective_modulus=modulus, work=adhesion.work, indentation=z - separation, **known
            )
            for r, z in zip(radius[touching], ensemble.height[touching], strict=True)
        ]
        force, a = (np.array([float(each[name]) for each in contacts]) for name in ("force", "contact_radius"))
        above, pushing = (a > 0.0) & (force > hardness * math.pi * a * a), np.maximum(force, 0.0)
        return above.sum() / (a > 0.0).sum(), pushing[above].sum() / pushing.sum(), force.sum()

    found = yielding(Problem(ensemble, modulus, adhesion), hardness, 0.2e-6)
    contacts, load, _ = plain(0.2e-6)
    assert 0.1 < load < 1.0
    assert found["yielded_contact_fraction"] == pytest.approx(contacts, rel=1e-12)
    assert found["yielded_load_fraction"] == pytest.approx(load, rel=1e-9)
    _, at_end, force = plain(found["elastic_separation"])
    assert at_end <= YIELDED_SHARE
    assert found["elastic_pressure"] == pytest.approx(max(force, 0.0) / 1e-6, rel=1e-9)
    below = found["elastic_separation"] - 1.01 * (ensemble.height[0] - 0.2e-6) / 512.0
    assert plain(below)[1] > YIELDED_SHARE


@pytest.mark.parametrize("work", [0.0, large(0.5)])
def test_contacts_in_pairs_far_apart_are_alone(work: float) -> None:
    grid = 1e-3 * np.arange(4.0)
    x, y = (each.ravel() for each in np.meshgrid(grid, grid))
    height = 1e-6 * np.random.default_rng(4).normal(size=16)
    placed = {"x": x, "y": y}
    ensemble = paraboloids(height, area=16e-6, positions=placed, attrs={"patch": 4e-3})
    coupled, alone = (
        yielding(Problem(ensemble, 80e9, Adhesion(work), interaction), 3e9, 0.0)
        for interaction in (Interaction(model="pairwise", boundary="free"), None)
    )
    assert coupled["yielded_contact_fraction"] == alone["yielded_contact_fraction"] > 0.0
    for name, tolerance in (("yielded_load_fraction", 0.05), ("elastic_pressure", 0.05)):
        assert coupled[name] == pytest.approx(alone[name], rel=tolerance)


def test_cones_yield_from_first_touch_or_never() -> None:
    """Their mean pressure, E* slope/2, does not depend on the load."""
    heights = np.linspace(0.0, -1e-6, 9)
    ensemble = Ensemble.alike(Cone(slope=0.1), heights, {}, 1e-3)
    problem = Problem(ensemble, 80e9, Adhesion())
    always, never = (yielding(problem, hardness, -2e-6) for hardness in (3.9e9, 4.1e9))
    assert always["yielded_contact_fraction"] == always["yielded_load_fraction"] == 1.0
    assert always["elastic_separation"] == 0.0
    assert math.isnan(always["plasticity_index"])
    assert never["yielded_load_fraction"] == 0.0
    assert "elastic_separation" not in never


def test_nothing_yields_out_of_contact_and_no_pressure_is_told_without_an_area() -> None:
    problem = Problem(paraboloids(np.array([0.0, -1e-6]), area=None), 80e9, Adhesion())
    assert yielding(problem, 1e6, 1e-6)["yielded_load_fraction"] == 0.0
    assert yielding(problem, 1e6, math.inf)["yielded_contact_fraction"] == 0.0
    found = yielding(problem, 3e9, -2e-6)
    assert found["elastic_separation"] < 0.0
    assert math.isnan(found["elastic_pressure"])


def test_long_contacts_of_hills_have_less_area() -> None:
    """Half the area of circles of the same stiffness: so they reach twice the hardness."""
    height = 1e-6 * np.random.default_rng(5).normal(size=200)
    half, whole = (
        yielding(Problem(paraboloids(height, attrs={"area_share": share}), 80e9, Adhesion()), hardness, 0.0)
        for share, hardness in ((0.5, 8e9), (1.0, 4e9))
    )
    assert half["yielded_load_fraction"] == whole["yielded_load_fraction"] > 0.0
    assert half["elastic_pressure"] == whole["elastic_pressure"]

"""The conductance radius: of one contact, of two, and of many, against the exact modes of coplanar discs."""

import math
from typing import Any

import numpy as np
import pytest
import xarray as xr
from forms import large
from hypothesis import given, settings, strategies as st
from scenes import ensemble
from twins.coplanar_discs import disc_forces

import roughmdr as rm
from roughmdr.interaction.green import Periodic, periodic_load
from roughmdr.numerics.arguments import Floats

DISTANCES = (2.5, 3, 4, 6, 10, 20)
PAIRS = dict(zip(DISTANCES, (0.792425936, 0.821617209, 0.860924434458, 0.903424935, 0.939982879069, 0.969127572),
                 strict=True))  # fmt: skip
"""Conductance of two equal contacts over that of two alone, by their distance over the radius."""
FREE = {"model": "pairwise", "boundary": "free", "error": 1e-9}


def radius_of(made: xr.Dataset, **given: Any) -> float:
    """The conductance radius at a separation of 0, or the last of those given."""
    asked = {"separation": [0.0], "effective_modulus": 1.0, "variables": "conductance_radius"} | given
    return float(rm.load_separation(made, **asked).conductance_radius[-1])


def discs(x: Any, y: Any, radius: Any, patch: float | None = None) -> xr.Dataset:
    """Flat punches in contact at a separation of 0: level discs."""
    height = np.full(np.shape(x), 1e-6)
    made = ensemble(height, None if patch is None else patch**2, "flat_punch", radius=radius, x=x, y=y)
    return made if patch is None else made.assign_attrs(patch=patch)


@given(st.floats(1e-12, 1e12), st.floats(1e-9, 1e3), st.floats(1e-8, 1e-2))
@settings(deadline=None, max_examples=20)
def test_one_contact_conducts_by_its_radius(modulus: float, radius: float, depth: float) -> None:
    """R. Holm, Electric Contacts, 1967: the resistance is 1/(4 k a) on each side."""
    made = ensemble([depth * radius], None, radius=radius, x=[0.0], y=[0.0])
    exact = radius * depth**0.5
    for interaction in (None, FREE, FREE | {"order": 1}):
        found = radius_of(made, interaction=interaction, effective_modulus=modulus)
        assert found == pytest.approx(exact, rel=1e-13)


def test_independent_contacts_add_up() -> None:
    made = ensemble(np.linspace(-1e-7, 1e-6, 700), radius=np.linspace(1e-5, 1e-4, 700))
    for adhesion in ({}, {"work": 0.05}, {"work": 0.05, "adhesion": "dugdale", "strength": 1e6}):
        names = ["conductance_radius", "contact_radius_sum"]
        law = rm.load_separation(made, separation=[1e-7, 0.0], effective_modulus=1e9, variables=names, **adhesion)
        np.testing.assert_allclose(law.conductance_radius, law.contact_radius_sum, rtol=1e-12)
        assert float(law.conductance_radius[1]) > 0.0


@pytest.mark.few(2)
@pytest.mark.parametrize("distance", DISTANCES)
def test_two_contacts_are_off_as_their_order_is(distance: float) -> None:
    exact = disc_forces(np.array([0.0, distance + 0.0j]), np.ones(2), degree=14)[0]
    assert exact / 2.0 == pytest.approx(PAIRS[distance], abs=5e-10)
    made = discs([0.0, 0.6e-4 * distance], [0.0, 0.8e-4 * distance], [1e-4, 1e-4])
    first, second = (radius_of(made, interaction=FREE | {"order": order}) / 2e-4 / PAIRS[distance] - 1.0
                     for order in (1, 2))  # fmt: skip
    assert 0.0 < first < 0.21 * distance**-3.0
    assert 0.0 < second < 0.23 * distance**-5.0


def test_the_error_falls_with_the_order() -> None:
    """It falls as the third power of radius over distance, and as the fifth."""
    for order, power, near in ((1, 3, 0.2), (2, 5, 0.3)):
        errors = []
        for distance in (16.0, 32.0):
            made = discs([0.0, distance], [0.0, 0.0], [1.0, 1.0])
            exact = float(disc_forces(np.array([0.0, distance + 0.0j]), np.ones(2)).sum()) / 2.0
            errors.append(radius_of(made, interaction=FREE | {"order": order, "error": 1e-9}) / exact - 1.0)
        assert math.log2(errors[0] / errors[1]) == pytest.approx(power, abs=near)


def placed(count: int, side: float, reach: float, seed: int) -> tuple[Floats, Floats, Floats]:
    """Places and radii of discs of which none is nearer to another than ``reach`` times their radii, also across."""
    draws = np.random.default_rng(seed)
    x, y, radius = np.empty((3, 0))
    while x.size < count:
        at, new = draws.uniform(0.0, side, 2), draws.uniform(0.3, 1.0)
        apart = [np.abs(each - value) for each, value in zip((x, y), at, strict=True)]
        away = np.hypot(*(np.minimum(each, side - each) for each in apart))
        if (away > reach * (radius + new)).all():
            x, y, radius = np.append(x, at[0]), np.append(y, at[1]), np.append(radius, new)
    return x, y, radius


@pytest.mark.parametrize("seed", [1, large(2)])
@pytest.mark.parametrize("boundary", ["free", large("periodic")])
def test_unequal_contacts_against_their_exact_modes(boundary: str, seed: int) -> None:
    side = 16.0
    x, y, radius = placed(8, side, 1.5, seed)
    exact = disc_forces(x + 1j * y, radius, None if boundary == "free" else side, degree=6).sum() / 2.0
    made = discs(x, y, radius, side)
    first, second = (radius_of(made, interaction=FREE | {"boundary": boundary, "order": order}) / exact - 1.0
                     for order in (1, 2))  # fmt: skip
    assert abs(second) < 4e-4
    assert first > 5.0 * abs(second)


def test_a_square_lattice() -> None:
    """Each contact conducts better by 3.9003 2 a/(pi L): by 1.4009 sqrt(pi) a/L, over the radius of a disc of the area
    L^2. In a tube of that radius it is 1.4098; the walls of the square cell are farther off in the corners."""
    at = np.zeros(1)
    for side, error in ((20.0, 1e-6), (10.0, 3e-5), (5.0, 1e-3)):
        exact = disc_forces(at + 0j, np.ones(1), side)[0] / 2.0
        found = radius_of(discs(at, at, np.ones(1), side), interaction=FREE | {"boundary": "periodic"})
        assert found == pytest.approx(exact, rel=error)
    far = radius_of(discs(at, at, np.ones(1), 1e4), interaction=FREE | {"boundary": "periodic"})
    assert (1.0 - 1.0 / far) * 1e4 / math.sqrt(math.pi) == pytest.approx(1.40089, abs=1e-3)


def test_a_cluster_to_the_first_order_of_greenwood() -> None:
    """J. A. Greenwood, Br. J. Appl. Phys. 17 (1966) 1621: equal contacts that carry equal currents; rho is 1."""
    x, y, _ = placed(12, 1.0, 0.0, 5)
    apart = np.hypot(x[:, None] - x, y[:, None] - y)
    inverse = np.sum(1.0 / apart[~np.eye(12, dtype=bool)])
    errors = []
    for a in (1e-4, 1e-5):
        found = 1.0 / (2.0 * radius_of(discs(x, y, np.full(12, a)), interaction=FREE))
        alone, together = 1.0 / (2.0 * 12 * a), inverse / (math.pi * 12**2)
        errors.append(abs(alone + together - found) / together)
    assert errors[1] == pytest.approx(0.1 * errors[0], rel=0.1)  # the next order is left out
    assert errors[1] < 1e-3


def test_many_on_a_mesh_against_a_plain_solution() -> None:
    side, count = 1.0, 220
    x, y, radius = placed(count, 60.0, 1.1, 3)
    x, y, radius = x / 60.0, y / 60.0, radius / 60.0
    green = np.array([[periodic_load(a - b, c - d, Periodic.of(1.0)) for b, d in zip(x, y, strict=True)]
                      for a, c in zip(x, y, strict=True)])  # fmt: skip
    g, gx, gy, laplacian = np.moveaxis(green, 2, 0) / math.pi
    square, tilting = radius**2, 4.0 / 3.0 * radius**3
    matrix = np.diag(0.5 / radius) + g + (square[:, None] + square) * laplacian / 6.0
    matrix -= gx.T @ (tilting[:, None] * gx) + gy.T @ (tilting[:, None] * gy)
    exact = np.linalg.solve(matrix, np.ones(count)).sum() / 2.0
    for error in (1e-4, 1e-6, 1e-9):
        found = radius_of(discs(x, y, radius, side), interaction={"model": "pairwise", "error": error})
        assert found == pytest.approx(exact, rel=error)


def random(count: int, side: float = 1e-3, seed: int = 1) -> xr.Dataset:
    section = {
        "source": "random", "shape": "paraboloid", "count": count, "patch": side,
        "placement": "hard_core", "min_distance": 0.5 * side / count**0.5,
        "height": {"distribution": "normal", "std": 1e-3 * side}, "radius": 0.02 * side,
    }  # fmt: skip
    return rm.generate(section, seed=seed)


@pytest.mark.parametrize("boundary", ["periodic", "free"])
@pytest.mark.parametrize("count", [40, 300])
def test_to_first_order_it_is_the_stiffness(boundary: str, count: int) -> None:
    """J. R. Barber, Proc. R. Soc. Lond. A 459 (2003) 53."""
    asked = {"model": "pairwise", "boundary": boundary, "order": 1}
    names = ["stiffness", "conductance_radius"]
    law = rm.load_separation(random(count), separation=[2.5e-6, 1.5e-6], effective_modulus=3e9, interaction=asked,
                             variables=names)  # fmt: skip
    np.testing.assert_allclose(6e9 * law.conductance_radius, law.stiffness, rtol=5e-6)


def test_to_second_order_it_is_the_stiffness_too() -> None:
    """The contacts slide to the new top, and their pressure has a moment there."""
    asked = {"model": "pairwise"}
    law = rm.load_separation(random(60), separation=[2.5e-6, 1.5e-6], effective_modulus=3e9, interaction=asked,
                             variables=["stiffness", "conductance_radius"])  # fmt: skip
    np.testing.assert_allclose(6e9 * law.conductance_radius, law.stiffness, rtol=5e-6)


def test_the_mean_field_adds_a_compliance() -> None:
    made, names = random(300), ["conductance_radius", "contact_radius_sum", "stiffness"]
    for boundary in ("periodic", "free"):
        law = rm.load_separation(made, separation=[2e-6, 1e-6], effective_modulus=3e9, variables=names,
                                 interaction={"model": "mean_field", "boundary": boundary})  # fmt: skip
        np.testing.assert_allclose(6e9 * law.conductance_radius, law.stiffness, rtol=1e-12)
        compliance = 1.0 / law.conductance_radius - 1.0 / law.contact_radius_sum
        assert float(compliance[0]) == pytest.approx(float(compliance[1]), rel=1e-9)


@pytest.mark.parametrize("interaction", [None, {"model": "pairwise", "order": 1}, {"model": "pairwise"}])
def test_contacts_that_adhesion_softens_conduct_as_well(interaction: Any) -> None:
    """The stiffness of an adhesive branch falls below 0 before it ends; the conductance is that of the contacts."""
    made = ensemble([0.0, -1e-9], radius=5e-5, x=[0.0, 3e-4], y=[0.0, 0.0]).assign_attrs(patch=1e-3)
    detached = rm.pull_off(rm.Paraboloid(5e-5), effective_modulus=4e6, work=0.05, control="displacement")
    separation = np.array([0.1, -0.7, -0.8]) * float(detached.indentation)
    law = rm.load_separation(
        made, separation=separation, effective_modulus=4e6, work=0.05, interaction=interaction,
        variables=["stiffness", "conductance_radius", "contact_radius_sum"],
    )  # fmt: skip
    assert float(law.stiffness[2]) < 0.0
    assert (law.conductance_radius > 0.0).all()
    ratio = law.conductance_radius / law.contact_radius_sum
    if interaction is None:
        np.testing.assert_allclose(ratio, 1.0, rtol=1e-12)
    else:
        a = law.contact_radius_sum / 2.0  # of about equal contacts
        g = periodic_load(0.3, 0.0, Periodic.of(1.0))[0] + periodic_load(0.0, 0.0, Periodic.of(1.0))[0]
        np.testing.assert_allclose(ratio, 1.0 / (1.0 + 2.0 / math.pi * g * a / 1e-3), rtol=2e-4)


@pytest.mark.parametrize("scale", [1e-6, 1e6])
def test_other_units_change_nothing(scale: float) -> None:
    made = random(200)
    same = random(200, scale * 1e-3)
    for interaction in (None, "mean_field", "pairwise"):
        one = radius_of(made, interaction=interaction, separation=[1.5e-6])
        other = radius_of(same, interaction=interaction, separation=[1.5e-6 * scale], effective_modulus=1e9)
        assert other == pytest.approx(scale * one, rel=1e-9)


def test_contacts_that_overlap_conduct_as_less() -> None:
    """Down to two that are one: the expansion goes over to springs that are coupled, which is bounded."""
    ratios = [radius_of(discs([0.0, distance], [0.0, 0.0], [1.0, 1.0]), interaction=FREE) / 2.0
              for distance in (2.2, 2.0, 1.8, 1.6, 1.0, 0.1, 1e-3)]  # fmt: skip
    assert (np.diff(ratios) < 0.0).all()
    assert ratios[-1] == pytest.approx(0.5, rel=0.05)

"""Pairs, tilted planes and periodic patches by boundary integrals, against each other and the terms of the coupling."""

import math

import numpy as np
import pytest
from forms import large
from oracles.boundary_elements import HeightMap, by_perimeter, of_half_ellipsoids
from scipy.integrate import quad
from twins.coplanar_discs import disc_forces
from twins.periodic_contact import periodic
from twins.tilted_contact import press_tilted
from twins.two_contacts import Indenter, equal_pair, pair, press

import roughmdr as rm
from roughmdr.elements.half_space import connected
from roughmdr.errors import OutOfRange

PARABOLOID = Indenter(2.0, 0.5, 1.0)
QUARTIC = Indenter(4.0, 0.375, 1.0)  # contact radius 1 too
PARABOLOIDS = {3: .828444914, 4: .864726367747, 6: .905117769443, 10: .940605090957, 20: .969288185363}  # fmt: skip
PUNCHES = {2.5: .792425936, 3: .821617209, 4: .860924434, 6: .903424935, 10: .939982879, 20: .969127572}  # fmt: skip
"""Distance over the radius of a lone contact -> force over that of a lone contact, from another solution."""
PERIODIC = {12: (1.273263599777, 3.6870864041), 6: (1.814344884220, 4.6216698656)}
"""Side of the patch -> force over 4/3 from a multipole solution, and area."""


@pytest.mark.few(2)
@pytest.mark.parametrize("distance", PARABOLOIDS)
def test_two_paraboloids(distance: float) -> None:
    contact = equal_pair(PARABOLOID, distance, degree=6)
    assert contact.force == pytest.approx(4.0 / 3.0 * PARABOLOIDS[distance], rel=1e-9 if distance < 4 else 1e-11)


@pytest.mark.parametrize("distance", [2.5, 3, 4, large(6), large(10), large(20)])
def test_two_level_punches(distance: float) -> None:
    force = disc_forces(np.array([0.0, distance + 0.0j]), np.ones(2), degree=14)[0]
    assert force == pytest.approx(2.0 * PUNCHES[distance], rel=1e-9)


@pytest.mark.large
@pytest.mark.parametrize("indenter", [PARABOLOID, large(QUARTIC)])
def test_a_pair_converges_exponentially(indenter: Indenter) -> None:
    forces = [equal_pair(indenter, 4.0, degree).force for degree in (4, 6, 8, 10)]
    errors = [abs(force / forces[-1] - 1.0) for force in forces[:-1]]
    assert errors[0] < 1e-7
    assert max(errors[1:]) < 1e-9
    assert errors[2] < 1e-11


@pytest.mark.large
def test_an_unequal_pair_has_the_equal_one_as_its_limit() -> None:
    one, two = pair(PARABOLOID, PARABOLOID._replace(slope=0.5 + 1e-12), 4.0, degree=6)
    alike = equal_pair(PARABOLOID, 4.0, degree=6)
    assert (one.force, two.area) == pytest.approx((alike.force, alike.area), rel=1e-10)


@pytest.mark.large
def test_the_work_of_an_unequal_pair_does_not_depend_on_the_path() -> None:
    """The force on either by the approach of the other is alike: dP1/d(delta2) = dP2/d(delta1)."""
    small, step = Indenter(2.0, 1.3, 0.4), 1e-4

    def forces(one: float, two: float) -> tuple[float, float]:
        moved = PARABOLOID._replace(approach=1.0 + one), small._replace(approach=0.4 + two)
        first, second = pair(*moved, 3.5, degree=6)
        return first.force, second.force

    by_two = forces(0.0, step)[0] - forces(0.0, -step)[0]
    by_one = forces(step, 0.0)[1] - forces(-step, 0.0)[1]
    assert by_two == pytest.approx(by_one, rel=1e-6)
    assert by_two < 0.0


def mdr(exponent: float, power: float) -> float:
    """Return 2 ∫ x^power (delta - g) dx with delta = a = 1."""
    return 2.0 * (1.0 / (power + 1.0) - 1.0 / (power + 1.0 + exponent))


@pytest.mark.large
@pytest.mark.parametrize("exponent", [1.0, 2.0, 3.0, 4.0])
def test_the_second_moment_of_the_pressure(exponent: float) -> None:
    """∫ p r² dA = 4 E* ∫ x² (delta - g) dx."""
    slope = 1.0 / Indenter(exponent, 1.0, 1.0).lone_radius ** -exponent
    shape = rm.PowerLaw(exponent=exponent, width=1.0, rise=slope)

    def integrand(angle: float) -> float:
        r = math.sin(angle)
        p = rm.pressure(shape, r=r, contact_radius=1.0, effective_modulus=1.0)
        return 2.0 * math.pi * r**3 * float(p) * math.cos(angle)

    found = quad(integrand, 0.0, 0.5 * math.pi, epsrel=1e-9, limit=60)[0]
    assert found == pytest.approx(2.0 * mdr(exponent, 2.0), rel=1e-7)


@pytest.mark.parametrize(("indenter", "degree"), [(PARABOLOID, 2), (QUARTIC, 4)])
def test_the_second_moment_by_boundary_integrals(indenter: Indenter, degree: int) -> None:
    contact = press(indenter, degree=degree)
    assert contact.force == pytest.approx(mdr(indenter.exponent, 0.0), rel=1e-12)
    assert contact.second_moment == pytest.approx(2.0 * mdr(indenter.exponent, 2.0), rel=1e-12)


@pytest.mark.parametrize("exponent", [1.0, 1.5, 2.0, 3.0, 4.0])
def test_a_tilt_acts_to_its_order_as_the_coupling_says(exponent: float) -> None:
    """The dipole is -K tilt, K = 4 E* a³/3, and the approach gains s tilt², s = a/g'(a): P grows by 2 E* a s tilt²."""
    slope = Indenter(exponent, 1.0, 1.0).lone_radius ** exponent
    indenter = Indenter(exponent, slope, 1.0)  # a = delta = 1, so s = 1/n
    lone = press_tilted(indenter, 0.0).force
    assert lone == pytest.approx(mdr(exponent, 0.0), rel=1e-10)
    dipole, gain = [], []
    for tilt in (0.1, 0.05, 0.025):
        tilted = press_tilted(indenter, tilt)
        dipole.append(-tilted.moment / tilt / (4.0 / 3.0) - 1.0)
        gain.append((tilted.force - lone) / (2.0 / exponent * tilt**2) - 1.0)
    for errors in (dipole, gain):
        assert abs(errors[-1]) < 4e-3
        assert abs(errors[0]) < 0.06
        extrapolated = (4.0 * errors[2] - errors[1]) / 3.0  # what is left of the second order
        assert abs(extrapolated) < 1e-4


@pytest.mark.few(1)
@pytest.mark.parametrize(("indenter", "rtol"), [(PARABOLOID, 1e-12), (QUARTIC, 2e-7)])
def test_the_tilted_plane_by_boundary_integrals(indenter: Indenter, rtol: float) -> None:
    """Another way to the solution: r^4 leaves the disc in the second order of the tilt, its load in the fourth."""
    tilted = press_tilted(indenter, 0.05)
    exact = press(indenter, lambda z: 0.05 * z.real)
    assert (tilted.force, tilted.moment) == pytest.approx((exact.force, exact.moment), rel=rtol)


@pytest.mark.large
@pytest.mark.parametrize("side", [large(12), 6])
def test_a_paraboloid_in_a_periodic_patch(side: int) -> None:
    share, area = PERIODIC[side]
    contact = periodic(PARABOLOID, side, degree=4)
    assert contact.force == pytest.approx(4.0 / 3.0 * share, rel=1e-9)
    assert contact.area == pytest.approx(area, rel=1e-7)


@pytest.mark.few(1)
@pytest.mark.parametrize("side", PERIODIC)
@pytest.mark.parametrize("shift", [0, 100])
def test_areas_on_a_grid(side: int, shift: int) -> None:
    """Errors at these grids: counted cells 0.5 to 1.1 %, less their part at the edge 0.3 %, half ellipsoids 0.04 %."""
    along = (np.arange(256) + 0.5) * side / 256 - 0.5 * side
    height = np.roll(-0.5 * (along[:, None] ** 2 + along**2), shift, axis=(0, 1))  # across the rim
    surface = HeightMap(height, side)
    pressed = surface.press(-1.0)
    exact = PERIODIC[side][1] / side**2
    assert float(surface.pressure.mean()) * side**2 == pytest.approx(pressed.force, rel=1e-12)
    assert connected(surface.pressure > 0.0, across=True)[1] == 1
    assert by_perimeter(surface.pressure) == pytest.approx(exact, rel=3e-3)
    assert of_half_ellipsoids(surface.pressure) == pytest.approx(exact, rel=5e-4)
    assert pressed.contact_area / side**2 > 1.003 * exact


def test_an_edge_that_is_not_found_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("twins.two_contacts._MAX_ITERATIONS", 1)
    with pytest.raises(OutOfRange, match="degree is 6: the edge of the contact is not found"):
        equal_pair(PARABOLOID, 4.0, degree=6)

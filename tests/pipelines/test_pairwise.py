"""The oracle of pairwise asperities against exact periodic contacts, pairs, and independent asperities."""

import math

import numpy as np
import pytest
from oracles.boundary_elements import HeightMap
from oracles.pairwise import Paraboloids, periodic_green
from studies.versus_bem.ensembles import SIZE, Case

import roughmdr as rm

ORIGIN = np.zeros(1)


def test_the_greens_function_is_that_of_the_fourier_series() -> None:
    points, size, modulus = 512, 3.0, 7.0
    q = 2.0 * math.pi / size * np.fft.fftfreq(points, 1.0 / points)
    length = np.hypot(q[:, None], q[None, :])
    length[0, 0] = math.inf
    series = np.fft.ifft2(2.0 / (modulus * length)).real * (points / size) ** 2
    at = np.array([0, 128, 256, 77]), np.array([0, 64, 256, 401])
    green = periodic_green(at[0] * size / points, at[1] * size / points, size, modulus)
    np.testing.assert_allclose(green[0, 1:], series[at[0][1:], at[1][1:]], rtol=2e-4)
    np.testing.assert_allclose(green, green.T, rtol=1e-13, atol=0.0)
    assert green[0, 0] * math.pi * modulus * size == pytest.approx(-3.9002649, rel=1e-8)


@pytest.mark.parametrize(("size", "exact"), [(20.0, 1.145247762211), (12.0, 1.273263599777)])
def test_a_paraboloid_and_its_images_to_first_order(size: float, exact: float) -> None:
    """Terms left out are of the order of (a/size)^3."""
    green = periodic_green(ORIGIN, ORIGIN, size, 1.0)
    force = Paraboloids(ORIGIN, np.ones(1), green, 1.0, 0.0).press(-1.0).force
    assert force == pytest.approx(4.0 / 3.0 * exact, rel=3.0 * size**-3)


@pytest.mark.parametrize(("distance", "exact"), [(4.0, -0.507723241), (10.0, -0.486019386)])
def test_a_pair_detaches_where_it_does(distance: float, exact: float) -> None:
    """At fixed approach on a free half-space, w = 1/(2 pi), E* = R = 1."""
    green = (1.0 - np.eye(2)) / (math.pi * distance)
    pair = Paraboloids(np.zeros(2), np.ones(2), green, 1.0, 0.5 / math.pi)
    pair.press(-0.01)
    assert pair.press(-(exact + 1e-3)).contact_count == 2
    assert pair.press(-(exact - 1e-3)).contact_count == 0


@pytest.mark.parametrize("work", [0.0, 0.05])
def test_without_coupling_they_are_the_sum_of_independent_ones(work: float) -> None:
    made = rm.generate(
        {"source": "random", "shape": "paraboloid", "count": 60, "patch": 1e-3, "radius": 50e-6,
         "height": {"distribution": "normal", "std": 1e-6}}, seed=2,
    )  # fmt: skip
    down = np.linspace(3e-6, -0.5e-6, 15)
    law = rm.load_separation(made, separation=down, effective_modulus=4e6, work=work, unload=True)
    alone = Paraboloids(made["height"].to_numpy(), made["radius"].to_numpy(), np.zeros((60, 60)), 4e6, work)
    states = [alone.press(h) for h in (*down, *down[::-1])]
    for name in ("force", "contact_area", "contact_count"):
        found, expected = np.array([getattr(state, name) for state in states]), law[name].to_numpy()
        np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-9 * np.abs(expected).max())


def test_they_agree_with_boundary_elements_far_better_than_independent_ones() -> None:
    asperities, fine, _ = Case("hard_core 0.7", "paraboloid", 36, 0.2, 256, 1).build()
    height, radius, x, y = (asperities[name].to_numpy() for name in ("height", "radius", "x", "y"))
    separation = float(height[0] - 1.3 * height.std())
    exact = HeightMap(fine, SIZE, 1e9).press(separation).force
    alone, coupled = (
        Paraboloids(height, radius, green, 1e9, 0.0).press(separation).force
        for green in (np.zeros((36, 36)), periodic_green(x, y, SIZE, 1e9))
    )
    assert abs(coupled / exact - 1.0) < 0.01
    assert 1.0 - alone / exact > 0.07


def test_contacts_that_are_nearer_than_their_radii_are_refused() -> None:
    near = periodic_green(np.array([0.0, 0.01]), np.zeros(2), 4.0, 1.0)
    with pytest.raises(rm.OutOfRange, match=r"grows without end|do not come to rest"):
        Paraboloids(np.zeros(2), np.ones(2), near, 1.0, 0.0).press(-1.0)

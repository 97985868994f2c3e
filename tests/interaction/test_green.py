"""The Green's function of a patch that repeats, against constants from elsewhere, other splits and its derivatives."""

import math

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from roughmdr.interaction.green import Periodic, near_part, periodic_load, point_load

SQUARE = Periodic.of(1.0)
PLACES = [(0.5, 0.5), (0.1, 0.0), (-0.37, 0.21), (1e-3, -2e-3), (0.49, -0.02)]
near = st.floats(-0.5, 0.5)


def test_a_load_is_displaced_by_its_images() -> None:
    g, gx, gy, laplacian = periodic_load(0.0, 0.0, SQUARE)
    assert g == pytest.approx(-3.9002649200, abs=1e-9)
    assert laplacian == pytest.approx(9.0336217, abs=1e-7)
    assert (gx, gy) == pytest.approx((0.0, 0.0), abs=1e-15)


def test_the_image_sums_are_the_lattice_sums_by_zeta_functions() -> None:
    """Σ' r^-2s of a square lattice is 4 ζ(s) β(s), continued to s = 1/2 and in the Laplacian at s = 3/2."""
    from mpmath import mp

    def sum_over_lattice(s: float) -> float:
        quarter = mp.mpf(1) / 4
        beta = mp.power(4, -s) * (mp.zeta(s, quarter) - mp.zeta(s, 3 * quarter))
        return float(4 * mp.zeta(s) * beta)

    g, _, _, laplacian = periodic_load(0.0, 0.0, SQUARE)
    assert g == pytest.approx(sum_over_lattice(0.5), rel=1e-12)
    assert laplacian == pytest.approx(sum_over_lattice(1.5), rel=1e-12)


@pytest.mark.parametrize("side_y", [1.0, 0.3, 2.7])
@pytest.mark.parametrize("place", [(0.0, 0.0), *PLACES])
def test_the_split_does_not_matter(place: tuple[float, float], side_y: float) -> None:
    patch = Periodic.of(side_y)
    at = place[0], place[1] * side_y
    exact = np.array(periodic_load(*at, patch))
    r = max(math.hypot(*at), 0.3 if place == (0.0, 0.0) else 0.0)
    for factor in (0.6, 1.7):
        other = np.array(periodic_load(*at, Periodic(side_y, factor * patch.split)))
        scale = np.array([1.0 / r, 1.0 / r**2, 1.0 / r**2, 1.0 / r**3]) + np.abs(exact).max()
        assert np.abs(other - exact).max() <= 1e-12 * scale.max()


@pytest.mark.parametrize("side_y", [1.0, 0.4])
@pytest.mark.parametrize("place", PLACES)
def test_slopes_and_laplacian_are_derivatives(place: tuple[float, float], side_y: float) -> None:
    patch, (x, y) = Periodic.of(side_y), (place[0], place[1] * side_y)
    step = 1e-3 * min(math.hypot(x, y), 0.1)

    def g(i: float, j: float) -> float:
        return periodic_load(x + i * step, y + j * step, patch)[0]

    def first(dx: int, dy: int) -> float:  # of eighth order, as the next
        weights = 4 / 5, -1 / 5, 4 / 105, -1 / 280
        return sum(
            w * (g(n * dx, n * dy) - g(-n * dx, -n * dy)) for n, w in enumerate(weights, 1)
        ) / step  # fmt: skip

    _, gx, gy, laplacian = periodic_load(x, y, patch)
    size = 1.0 / math.hypot(x, y) ** 2
    assert first(1, 0) == pytest.approx(gx, abs=1e-9 * size)
    assert first(0, 1) == pytest.approx(gy, abs=1e-9 * size)
    # Off the load 1/r has a Laplacian of 1/r^3, so that of the slopes is found by differences of these.
    slopes = [periodic_load(x + n * step, y, patch)[1] for n in (-2, -1, 1, 2)]
    cross = [periodic_load(x, y + n * step, patch)[2] for n in (-2, -1, 1, 2)]
    second = sum((a[0] - 8 * a[1] + 8 * a[2] - a[3]) / (12 * step) for a in (slopes, cross))
    assert second == pytest.approx(laplacian, rel=1e-8, abs=1e-8 * size)


@settings(deadline=None, max_examples=40)
@given(near, near, st.floats(0.2, 5.0), st.integers(-3, 3), st.integers(-3, 3))
def test_it_repeats_and_mirrors(x: float, y: float, side_y: float, m: int, n: int) -> None:
    patch, y = Periodic.of(side_y), y * side_y
    if math.hypot(x, y) < 1e-3:
        return
    field = np.array(periodic_load(x, y, patch))
    tolerance = 1e-11 * np.abs(field).max() / min(1.0, math.hypot(x, y))
    for other, signs in (
        (periodic_load(x + m, y + n * side_y, patch), (1, 1, 1, 1)),
        (periodic_load(-x, y, patch), (1, -1, 1, 1)),
        (periodic_load(x, -y, patch), (1, 1, -1, 1)),
        (periodic_load(y / side_y, x / side_y, Periodic.of(1.0 / side_y)), None),
    ):
        if signs is None:  # turned by a right angle and measured by the other side
            scaled = np.array(other) / np.array([side_y, side_y**2, side_y**2, side_y**3])
            np.testing.assert_allclose(scaled[[0, 2, 1, 3]], field, rtol=0.0, atol=tolerance)
        else:
            np.testing.assert_allclose(np.array(other) * signs, field, rtol=0.0, atol=tolerance)


@pytest.mark.parametrize("side_y", [1.0, 0.5])
def test_its_mean_is_zero(side_y: float) -> None:
    """By Gauss's rule in each quarter in polar coordinates, where 1/r is no pole."""
    nodes, weights = np.polynomial.legendre.leggauss(24)
    nodes, weights, patch = 0.5 * (nodes + 1.0), 0.5 * weights, Periodic.of(side_y)
    corner, total = math.atan2(side_y, 1.0), 0.0
    for low, high in ((0.0, corner), (corner, 0.5 * math.pi)):
        for u, wu in zip(nodes, weights, strict=True):
            angle = low + (high - low) * u
            edge = min(0.5 / math.cos(angle), 0.5 * side_y / math.sin(angle))
            for v, wv in zip(nodes, weights, strict=True):
                r = v * edge
                g = periodic_load(r * math.cos(angle), r * math.sin(angle), patch)[0]
                total += 4.0 * wu * wv * (high - low) * edge * r * g
    assert total == pytest.approx(0.0, abs=1e-10)


def test_without_images_it_is_1_over_r() -> None:
    """The smaller the distance to the patch, the less the images: G - 1/r goes to their sum at the load."""
    own = periodic_load(0.0, 0.0, SQUARE)
    for r in (1e-3, 1e-6):
        field, alone = periodic_load(0.6 * r, 0.8 * r, SQUARE), point_load(0.6 * r, 0.8 * r)
        np.testing.assert_allclose(field, alone, rtol=5.0 * r)
        assert field[0] - alone[0] == pytest.approx(own[0], abs=10.0 * r * r + 1e-15 / r)
    assert near_part(0.6, 0.8, 1e-9)[0] == pytest.approx(1.0, rel=1e-8)


def test_the_conductance_of_a_spot_in_a_square_tube() -> None:
    """A spot of radius a on the end of a square tube conducts 2 κ a/ψ, ψ = 1 - 1.4009 ε, π a² = ε² L².

    The displacement by the pressure of a flat punch is the temperature by its flux: 1/(2 E* a) and G_ii in the plane
    are 1/(4 κ a) and its images of the same mirrored tube, so ψ = 1 + 2 a G_ii/(π L) = 1 - 3.9002649 (2/π) ε/√π.
    """
    images = periodic_load(0.0, 0.0, SQUARE)[0]
    assert -images * 2.0 / math.pi / math.sqrt(math.pi) == pytest.approx(1.4009, abs=5e-5)

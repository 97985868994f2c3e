"""The oracle of boundary elements against exact solutions of periodic contacts."""

import math

import numpy as np
import pytest
from oracles.boundary_elements import HeightMap

import roughmdr as rm
from roughmdr.numerics.arguments import Floats

PATCHES = {20: 1.145247762211, 12: 1.273263599777, 8: 1.489602436784, 6: 1.814344884220, 5: 2.2277808930}
"""Side of the patch -> force over 4/3 E* of a paraboloid with R = delta = 1, from a multipole solution."""


def paraboloid(points: int, size: float) -> Floats:
    along = (np.arange(points) + 0.5) * size / points - 0.5 * size
    return -0.5 * (along[:, None] ** 2 + along[None, :] ** 2)


@pytest.mark.large
@pytest.mark.few(2)
@pytest.mark.parametrize("size", PATCHES)
def test_a_paraboloid_in_a_periodic_patch(size: int) -> None:
    exact = 4.0 / 3.0 * PATCHES[size]
    errors = [abs(HeightMap(paraboloid(n, size), size).press(-1.0).force / exact - 1.0) for n in (64, 128, 256)]
    assert errors[0] < 0.02
    assert max(errors[1:]) < 1e-3
    assert errors[2] < 5e-4


@pytest.mark.large
def test_other_units_and_a_path_give_the_forces_of_single_steps() -> None:
    unit, rise, modulus = 1e-6, 3e-10, 2e9
    surface = HeightMap(rise * paraboloid(128, 8), 8 * unit, modulus)
    for depth in (0.1, 1.0, 0.4):
        alone = HeightMap(paraboloid(128, 8), 8).press(-depth)
        pressed = surface.press(-depth * rise)
        assert pressed.force == pytest.approx(modulus * unit * rise * alone.force, rel=1e-5)
        assert pressed.contact_area == pytest.approx(unit**2 * alone.contact_area, rel=0.02)


@pytest.mark.few(1)
@pytest.mark.parametrize("height", [0.9, 0.5, 0.2])
def test_a_sinusoid_is_westergaards(height: float) -> None:
    """H. M. Westergaard, J. Appl. Mech. 6 (1939) A49: with s = p/p*, p* = pi E* A/wavelength, h/A = 1 - s + s ln s."""
    along = (np.arange(256) + 0.5) / 256
    pressed = HeightMap(np.cos(2.0 * np.pi * along)[:, None] * np.ones(256), 1.0).press(height)
    share = pressed.force / math.pi
    assert 1.0 - share + share * math.log(share) == pytest.approx(height, abs=2e-4)
    assert math.sin(0.5 * math.pi * pressed.contact_area) ** 2 == pytest.approx(share, abs=0.02)


def test_no_contact_and_full_contact() -> None:
    surface = HeightMap(paraboloid(32, 1.0), 1.0)
    assert surface.press(1.0) == (0.0, 0.0)
    assert surface.press(float(surface.height.mean())).force == math.inf


def test_what_does_not_converge_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("oracles.boundary_elements._MAX_ITERATIONS", 2)
    with pytest.raises(rm.OutOfRange, match="separation is -1 m: boundary elements do not converge"):
        HeightMap(paraboloid(64, 8), 8).press(-1.0)
